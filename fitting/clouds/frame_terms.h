#pragma once

#include <vector>

#include "fitting/clouds/cloud_match.h"

namespace mocurate {

/// A frame beside the one that is fitted. It is held, and joins through the walks of the options.
struct FixedNeighbourFrame {
  int step = -1;         ///< -1: the frame before, 1: the frame after
  double seconds = 0.0;  ///< between them
};

/// Where other evidence says that a joint lies. Robust as points are: beyond huber_sigmas it pulls linearly.
struct JointObservation {
  int joint = 0;
  Vector3d position = Vector3d::Zero();   ///< world, metres
  Matrix3d whitening = Matrix3d::Zero();  ///< W, 1/m: W'W is the information; of a ray nothing is known along it
};

/// What holds one frame of a state beside its priors.
struct FrameTerms {
  int frame = 0;
  const FusedCloud& cloud;
  const std::vector<CloudMatch>& matches;
  double weight = 0.0;  ///< of a point's distance, 1/m
  double huber = 0.0;   ///< whitened distance beyond which a point counts linearly
  std::vector<FixedNeighbourFrame> held = {};
  std::vector<JointObservation> joints = {};
};

}  // namespace mocurate
