#pragma once

#include <optional>
#include <vector>

#include "core/motion/clip.h"
#include "fitting/clouds/cloud_match.h"
#include "fitting/costs/pose_state.h"

namespace mocurate {

/// Agreement of one camera's keypoints with a motion that was fitted without them.
struct RayAgreement {
  std::vector<int> image;            ///< (F) of the view, nearest in time within half a step; -1: none
  std::vector<int> person;           ///< (F) the detection nearest to the motion; -1: none near it
  double median_px = 0.0;            ///< of all its detected keypoints from the projected joints
  double median_exchanged_px = 0.0;  ///< the same with left and right exchanged
  int seen = 0;                      ///< number of keypoints
  double share = 0.0;                ///< of the frames with an image, in which a detection is near
};

/// The joint of `skeleton` (with the detector's points) that each keypoint is; -1: none.
std::vector<int> BodyJointsOfKeypoints(const Skeleton& skeleton, const std::vector<std::string>& keypoint_names);

/// Compares a view with joints (F,J,3) at a rate.
RayAgreement CompareRays(const KeypointView& view, const std::vector<int>& joint_of, const Motion& motion);

/// A frame's keypoints as rays through the camera: positions known across the ray, not along it. `noise_px` of a
/// keypoint of confidence 1 per axis. The frame of the state must be up to date.
std::vector<JointObservation> RaysOf(const KeypointView& view, const std::vector<int>& joint_of, int image, int person,
                                     double noise_px, double min_confidence, const PoseState& state, int frame);

}  // namespace mocurate
