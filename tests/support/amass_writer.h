#pragma once

#include <vector>

#include "core/formats/amass.h"
#include "core/formats/array_fields.h"
#include "core/formats/npz.h"

namespace mocurate {

/// EncodeAmass with markers, which no export writes, and dmpls beside them.
inline Npz AmassWithMarkers(const Amass& amass) {
  Npz npz = ParseNpz(EncodeAmass(amass, "m.npz").value(), "m.npz").value();
  if (amass.markers == 0) return npz;
  const std::size_t numbers = amass.frames * amass.markers * 3;
  npz.members.push_back({"dmpls", MakeArray({amass.frames, 8}, std::vector<double>(8 * amass.frames, 0.25)), ""});
  npz.members.push_back(
      {"marker_data", MakeArray({amass.frames, amass.markers, 3}, std::vector<double>(numbers, 1.0)), ""});
  return npz;
}

}  // namespace mocurate
