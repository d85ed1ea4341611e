#pragma once

#include <string>
#include <vector>

#include "core/motion/motion.h"

namespace mocurate {

/// A point of the body that a sensor or detector reports: fixed in the frame of a joint of skeleton smpl24.
struct BodyPlace {
  std::string name;
  std::string joint;
  Vector3d offset;  ///< rest pose, metres, of a body of the skeleton's own size
};

/// The 25 joints of Kinect v2 in the order of NTU's files; names of skeleton ntu25.
const std::vector<BodyPlace>& Kinect25Places();
/// The 15 joints of the OpenNI tracker in KARD's order; KARD's names.
const std::vector<BodyPlace>& KardPlaces();
/// The 20 joints of Action2Motion's CMU in its order; names of skeleton cmu20.
const std::vector<BodyPlace>& Cmu20Places();
/// The 49 points of SPIN and VIBE (Kolotouros et al. 2019): BODY_25 of OpenPose, then 24 of other sets.
const std::vector<BodyPlace>& Vibe49Places();
/// BODY_25 of OpenPose.
const std::vector<BodyPlace>& Body25Places();

std::vector<std::string> NamesOf(const std::vector<BodyPlace>& places);

/// Positions of the points, (F,K,3). Offsets scale with the body. The motion's skeleton has smpl24's joints.
JointPositions PlacesOf(const Motion& motion, const std::vector<BodyPlace>& places);

}  // namespace mocurate
