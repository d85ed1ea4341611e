#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "core/formats/amass.h"
#include "core/formats/array_fields.h"
#include "core/formats/npz.h"

namespace mocurate {

/// EncodeAmass with the markers, which no export writes, and dmpls beside them.
inline Npz AmassWithMarkers(const Amass& amass) {
  Npz npz = ParseNpz(EncodeAmass(amass, "m.npz").value(), "m.npz").value();
  if (amass.markers == 0) return npz;
  std::vector<double> data = amass.marker_data_m;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (amass.marker_observed[i / 3] == 0) data[i] = std::numeric_limits<double>::quiet_NaN();
  }
  NpyArray labels;
  std::size_t longest = 1;
  for (const std::string& label : amass.marker_labels) longest = std::max(longest, label.size());
  labels.dtype = "|S" + std::to_string(longest);
  labels.shape = {amass.marker_labels.size()};
  labels.texts = amass.marker_labels;
  npz.members.push_back({"dmpls", MakeArray({amass.frames, 8}, std::vector<double>(8 * amass.frames, 0.25)), ""});
  npz.members.push_back({"marker_data", MakeArray({amass.frames, amass.markers, 3}, std::move(data)), ""});
  npz.members.push_back({"marker_labels", std::move(labels), ""});
  return npz;
}

}  // namespace mocurate
