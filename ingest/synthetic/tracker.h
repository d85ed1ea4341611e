#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/motion/motion.h"
#include "ingest/options.h"

namespace mocurate {

/// What a tracker says of some points.
struct TrackedTake {
  JointPositions positions;          ///< (F,K,3), metres; of what was not seen: not to be read
  std::vector<std::uint8_t> seen;    ///< (F*K)
  std::vector<std::uint8_t> frozen;  ///< (F*K) repeats an earlier value
};

/// Adds a tracker's errors to true positions (F,K,3). `names` (K) tell left from right. Each seen point is off by white
/// noise and its bias; points are lost or frozen for some frames on end; some are grossly wrong, and now and then left
/// and right limbs are exchanged. `item` keys the randomness; a bias is the same for every item.
TrackedTake Track(const JointPositions& truth, const std::vector<std::string>& names, const TrackerOptions& options,
                  std::int64_t seed, const std::string& item);

/// What a tracker says of the points that it does not see: they go with those that it sees, by the mean of their steps,
/// and tremble as all do. What is not seen from the first frame on keeps its error.
void GuessUnseen(const TrackerOptions& options, std::int64_t seed, const std::string& item, TrackedTake& tracked);

/// Positions of named joints or synonyms (K) of a motion's skeleton, (F,K,3).
JointPositions PointsOf(const Motion& motion, const std::vector<std::string>& names);

/// The order in which the tracker lists joints: its own names, each a name or synonym of skeleton kinect20.
const std::vector<std::string>& TrackedJoints();

/// What the studio's tracker writes of a take: per frame one row "x y z confidence" per joint, millimetres, sensor axes
/// (x to the right of the image, y up, z away from the sensor: left-handed), "0 0 0 0" for what was not seen.
std::string TrackText(const Motion& truth, const SyntheticOptions& options, const std::string& item);

}  // namespace mocurate
