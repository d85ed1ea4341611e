#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "core/motion/motion.h"

namespace mocurate {

/// Quality measures of a motion or of tracks, over present samples only. Smoothness does not imply accuracy: read it
/// together with a residual.
struct MotionMeasures {
  int frames = 0;
  double bone_spread_mm = 0.0;          ///< mean of bone_spreads_mm over bones present in two or more frames
  std::vector<double> bone_spreads_mm;  ///< (J) standard deviation over frames of each bone's length; root 0
  double jerk = 0.0;                    ///< m/s^3, root mean square of the third derivative of joint positions
  double missing_share = 0.0;           ///< of the samples of joints that are present in any frame
  int frozen_frames = 0;                ///< frames in which every joint repeats its last position exactly
  double foot_skate = 0.0;              ///< m/s, mean horizontal speed of the feet while they are on the floor
};

/// Measures joint positions (F,J,3) in metres, y up. `confidence` (F*J): present where above 0; empty: all present.
/// `time_s` (F) increasing seconds. Feet are the joints named ankle or foot; the floor is read from their lowest 5 %.
MotionMeasures MeasureJoints(const Skeleton& skeleton, const JointPositions& joints,
                             const std::vector<double>& confidence, const std::vector<double>& time_s);

/// The same for a motion, whose joints are all present.
MotionMeasures MeasureMotion(const Motion& motion);

/// {"frames", "bone_spread_mm", "bone_spreads_mm": {joint: mm}, "jerk", "missing_share", "frozen_frames",
/// "foot_skate"}; numbers rounded to 6 significant digits.
nlohmann::json MeasuresJson(const MotionMeasures& measures, const Skeleton& skeleton);

}  // namespace mocurate
