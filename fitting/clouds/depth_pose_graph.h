#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rigid.h"

namespace mocurate {

/// Relative motion of two cameras' points.
struct PoseEdge {
  std::size_t moved = 0;  ///< node
  std::size_t still = 0;
  RigidTransform still_from_moved;  ///< maps points of `moved` to those of `still`
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();  ///< rotation, then translation
};

/// Moves of all nodes that best satisfy the edges (Open3D's pose graph, Levenberg-Marquardt); node 0 is fixed. Error
/// kInconsistent when a node is not connected to it.
Expected<std::vector<RigidTransform>> SolvePoseGraph(std::size_t nodes, const std::vector<PoseEdge>& edges);

}  // namespace mocurate
