#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/formats/calibration.h"

namespace mocurate {

/// Calibrations that OpenCV's FileStorage wrote as YAML or XML; `storages` are names and bytes of files. Rigs as
/// EasyMocap writes them, two files: `names`, K_n and dist_n (k1 k2 p1 p2, perhaps k3), W_n and H_n if there; and
/// Rot_n or R_n (rotation vector), T_n. Views, a file each: intrinsic (3 x 3), R (3 x 3), t (3). What R and T mean and
/// their unit is left unknown. Error kMalformed or kInconsistent with the field ("intri.yml:K_cam02") or the line;
/// kUnsupported: no calibration.
Expected<Calibration> ParseOpenCvCalibration(const std::vector<std::pair<std::string, std::string>>& storages);

}  // namespace mocurate
