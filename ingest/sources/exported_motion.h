#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/formats/npz.h"

namespace mocurate {

/// The joints of a motion written by `mocurate export` (docs/exports.md): metres, right-handed, y up, facing +z.
struct ExportedMotion {
  const NpyArray* joints = nullptr;  ///< (F,J,3), of the archive
  std::vector<std::string> names;    ///< (J)
  std::vector<int> parents;          ///< (J), -1 for the root
  std::string skeleton;
  double rate_hz = 0.0;
  const NpyArray* state = nullptr;  ///< (F,J) JointState, of the archive; null where it has none
};

/// Nothing where `mocurate export` did not write the archive. `npz` has to outlive it.
std::optional<ExportedMotion> ExportedMotionIn(const Npz& npz);

}  // namespace mocurate
