#pragma once

#include <map>
#include <string>

#include "core/formats/amass.h"
#include "core/formats/npz.h"

namespace mocurate {

/// Numbers of a motion that are not finite or implausibly large, by frame.
struct DamagedPoses {
  std::map<int, long long> in_frame;  ///< how many
  std::map<int, std::string> first;   ///< the first of a frame: "poses[12, 3] is NaN"
};

/// Sets frames that hold one of these numbers to 0, in all arrays of the motion.
DamagedPoses ClearDamaged(Npz& npz);

/// Fills `damaged` and `findings`.
void ReportDamaged(const DamagedPoses& damaged, const std::string& name, Amass& amass);

}  // namespace mocurate
