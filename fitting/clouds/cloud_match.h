#pragma once

#include <vector>

#include "fitting/clouds/cloud_body.h"
#include "fitting/clouds/depth_fusion.h"
#include "fitting/costs/pose_gaussian.h"

namespace mocurate {

/// A point and its matched capsule.
struct CloudMatch {
  int point = 0;
  int capsule = 0;
  double distance = 0.0;  ///< m, signed
};

/// Nearest capsule of every point within `max_distance`, in the order of the points. A capsule whose surface normal
/// differs from the point's counts as farther. Needs PoseState::Update of the frame.
std::vector<CloudMatch> MatchPoints(const CapsuleBody& body, const PoseState& state, int frame, const FusedCloud& cloud,
                                    double max_distance);

/// Robust standard deviation of distances about zero, at least 3 mm.
double RobustSigma(std::vector<double> distances);

/// Estimates radii: for each capsule the median distance of its points to its axis, left and right together. Shrinks to
/// the previous radius when points are few. Uses frames [begin, end) of the state.
void CalibrateRadii(const std::vector<FusedCloud>& clouds, const PoseState& state, int begin, int end,
                    double max_distance, CapsuleBody& body);

/// A fixed neighbouring frame, coupled by the process noise of the options.
struct FixedNeighbourFrame {
  int step = -1;         ///< -1: the frame before, 1: the frame after
  double seconds = 0.0;  ///< between them
};

/// Joint position from another modality. Huber loss like points: linear beyond huber_sigmas.
struct JointObservation {
  int joint = 0;
  Vector3d position = Vector3d::Zero();   ///< world, metres
  Matrix3d whitening = Matrix3d::Zero();  ///< W, 1/m: W'W is the information; zero along a ray
};

/// Terms of one frame beside its priors.
struct FrameTerms {
  int frame = 0;
  const FusedCloud& cloud;
  const std::vector<CloudMatch>& matches;
  double weight = 0.0;  ///< of a point's distance, 1/m (inverse sigma)
  double huber = 0.0;   ///< whitened distance beyond which the loss of a point is linear
  std::vector<FixedNeighbourFrame> held = {};
  std::vector<JointObservation> joints = {};
  const PoseGaussian* pose = nullptr;  ///< of other evidence; replaces the rest pose and the limits of its joints
};

}  // namespace mocurate
