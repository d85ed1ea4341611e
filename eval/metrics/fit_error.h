#pragma once

#include <array>
#include <cstdint>

#include "core/motion/clip.h"

namespace mocurate {

/// Calibration of the covariance of joint positions: the share of error components whitened by it (three per joint and
/// frame) that lie within a number of standard deviations; 68.3 and 95.4 % within one and two if calibrated.
struct Coverage {
  std::int64_t components = 0;      ///< 0: the fit has no covariance
  std::array<double, 12> within{};  ///< share in [0, 1] within 0.25, 0.5, ..., 3 standard deviations

  double within_one_sigma() const { return within[3]; }
  double within_two_sigma() const { return within[7]; }
};

/// Error of a fit, and of the evidence it was fitted to. World frame, all frames, hidden ones too.
struct FitError {
  double joint_mm = 0.0;            ///< mean over frames and joints present in both
  double evidence_mm = 0.0;         ///< the same for the tracks, observed samples only; 0 without tracks
  double rotation_deg = 0.0;        ///< mean over joints with two or more non-collinear children, global rotations
  double bone_direction_deg = 0.0;  ///< mean angle between bones of at least 6 cm
  int frames = 0;
  Coverage coverage;
};

/// Joints are matched by name and synonym. Error kInconsistent if frames differ or no joint is shared.
Expected<FitError> CompareWithTruth(const Clip& fitted, const Evidence& evidence, const Motion& truth);

}  // namespace mocurate
