#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/motion/motion.h"
#include "ingest/synthetic/studio_options.h"

namespace mocurate {

/// A tracker's output for some points.
struct TrackedTake {
  JointPositions positions;          ///< (F,K,3), metres; undefined for points that are not seen
  std::vector<std::uint8_t> seen;    ///< (F*K)
  std::vector<std::uint8_t> frozen;  ///< (F*K) repeats an earlier value
};

/// Adds a tracker's errors to true positions (F,K,3). `names` (K) determine left and right. Each observed point has
/// white noise and its bias. Points are lost or frozen for several frames in a row; some are outliers, and sometimes
/// left and right limbs are exchanged. `item` keys the randomness; a bias is the same for every item.
TrackedTake Track(const JointPositions& truth, const std::vector<std::string>& names, const TrackerOptions& options,
                  std::int64_t seed, const std::string& item);

/// A tracker's output for points that it does not observe: they follow the mean step of the observed ones, with the
/// same noise. A point missing from the first frame on keeps its error.
void ExtrapolateMissing(const TrackerOptions& options, std::int64_t seed, const std::string& item,
                        TrackedTake& tracked);

/// Positions of named joints or synonyms (K) of a motion's skeleton, (F,K,3).
JointPositions PointsOf(const Motion& motion, const std::vector<std::string>& names);

/// The tracker's joints in its order, each a name or synonym of skeleton kinect20.
const std::vector<std::string>& TrackedJoints();

/// A table with one row "x y z confidence" per joint and frame, "0 0 0 0" for a missing joint; values are rounded to
/// 1 / `steps` of the unit.
std::string TrackText(const TrackedTake& tracked, const Vector3d& units_per_metre, double steps);

}  // namespace mocurate
