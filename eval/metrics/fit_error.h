#pragma once

#include <map>
#include <optional>
#include <string>

#include "core/motion/clip.h"
#include "eval/metrics/sigma_quality.h"

namespace mocurate {

/// Why the stated uncertainty of a clip is not compared with its errors.
enum class NotMeasured { kNoPositionCov, kNoRotationSigma, kNoTrueRotations, kOtherRestPose };

/// Error of a fit, and of the evidence it was fitted to. World frame, all frames, hidden ones too.
struct FitError {
  double joint_mm = 0.0;            ///< mean over frames and joints present in both
  double evidence_mm = 0.0;         ///< the same for the tracks, observed samples only; 0 without tracks
  double rotation_deg = 0.0;        ///< mean over joints with two or more non-collinear children, global rotations
  double bone_direction_deg = 0.0;  ///< mean angle between bones of at least 6 cm
  int frames = 0;
  std::map<std::string, double> joints_mm;  ///< mean error of each shared joint, by the fit's name
  SigmaByPart sigma;  ///< positions of shared joints; rotations about the axes that the fit marks as observed
  std::optional<NotMeasured> no_positions, no_rotations;  ///< why `sigma` has none
};

/// Joints are matched by name and synonym; local rotations only between skeletons of one tree and rest pose. Error
/// kInconsistent if frames differ or no joint is shared.
Expected<FitError> CompareWithTruth(const Clip& fitted, const Evidence& evidence, const Motion& truth);

}  // namespace mocurate
