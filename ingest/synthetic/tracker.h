#pragma once

#include <string>
#include <vector>

#include "core/motion/motion.h"
#include "ingest/options.h"

namespace mocurate {

/// The order in which the tracker lists joints: its own names, each a name or synonym of skeleton kinect20.
const std::vector<std::string>& TrackedJoints();

/// What the studio's tracker writes of a take: per frame one row "x y z confidence" per joint, millimetres, sensor axes
/// (x to the right of the image, y up, z away from the sensor: left-handed). Each seen joint is off by white noise of
/// `noise` metres root mean square; joints are lost for a few frames on end (row "0 0 0 0"); some are grossly wrong,
/// and now and then left and right limbs are exchanged for two frames. `item` keys the randomness.
std::string TrackText(const Motion& truth, const SyntheticOptions& options, const std::string& item);

}  // namespace mocurate
