#pragma once

#include <optional>

#include "core/motion/motion.h"

namespace mocurate {

/// How much a motion moves, and its most sudden moment.
struct Activity {
  double movement = 0.0;   ///< m/s, mean over joints and frames of a joint's speed
  double peak_jerk = 0.0;  ///< m/s^3, the largest of a joint in any frame
  double jerk_area = 0.0;  ///< m/s^2, the integral over time of the largest jerk of a joint [after FlowMDM, 2024]
};

/// Nothing for fewer than two frames; jerks are 0 for fewer than four.
std::optional<Activity> ActivityOf(const Motion& motion);

/// Five measures of MBench, with Motius's thresholds and floor: the lowest foot of the motion. Per frame, so only
/// motions of one rate compare. [ViMoGen's mbench, motion_quality; Motius, metrics/physical]
struct MBenchMeasures {
  double slide = 0.0;     ///< mm a frame, horizontal step of the feet in contact, mean of both feet
  double floating = 0.0;  ///< share of the frames in which a foot moves with the root
  double jitter = 0.0;    ///< mm a frame^2, mean second difference of the joints, in the world and about the root
  double dynamic = 0.0;   ///< mm a frame, the same of the first difference: near that of real motions is best
  double penetration =
      0.0;  ///< mm, mean depth of feet more than 5 mm below height 0, MBench's floor; Motius's makes it 0
};

/// Feet are the joints named foot, else ankle, of both sides. Nothing without them, or for fewer than four frames.
std::optional<MBenchMeasures> MBenchOf(const Motion& motion);

}  // namespace mocurate
