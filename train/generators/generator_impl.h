#pragma once

#include "train/generators/motion_generator.h"
#include "train/networks/network.h"
#include "train/options.h"

namespace mocurate {

/// Number of motions processed at once: fewer where each needs much memory.
int MotionsAtOnce(const NetworkOptions& options, std::int64_t frames);

struct MotionGenerator::Impl {
  std::shared_ptr<Network> network;
  NetworkOptions options;
  SkeletonPtr skeleton;
  std::vector<std::string> labels;
  FrameRate rate;
  std::vector<double> bone_length;               ///< of the training set
  std::vector<std::vector<double>> first_poses;  ///< of each class, for networks that start from one
  std::vector<Vector3d> rest_offset;             ///< median of the training set; empty: the network outputs joints only
  Matrix3d rest_axes = Matrix3d::Identity();     ///< of the rest pose: left, up, forward

  Status Check(const MotionRequest& request, std::size_t index) const;
  /// Continuations as network input; `network_from_world` receives the pose of each.
  RequestBatch BatchOf(const Continuation* asked, std::size_t count,
                       std::vector<RigidTransform>& network_from_world) const;
  RequestBatch BatchOf(const MotionRequest* requests, std::size_t count) const;
};

}  // namespace mocurate
