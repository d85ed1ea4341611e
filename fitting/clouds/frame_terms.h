#pragma once

#include <vector>

#include "fitting/clouds/cloud_match.h"
#include "fitting/costs/pose_gaussian.h"

namespace mocurate {

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
