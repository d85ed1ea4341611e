#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/error.h"
#include "core/geometry/rigid.h"

namespace mocurate {

/// How two cameras' points should move against each other.
struct PoseEdge {
  std::size_t moved = 0;  ///< node
  std::size_t still = 0;
  RigidTransform still_from_moved;  ///< applied to the points of `moved`, where those of `still` stay
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();  ///< rotation, then translation
};

/// Moves of all nodes that agree best with the edges (Open3D's pose graph, Levenberg and Marquardt); node 0 stays.
/// Error kInconsistent where no edge ties a node to it.
Expected<std::vector<RigidTransform>> SolvePoseGraph(std::size_t nodes, const std::vector<PoseEdge>& edges);

}  // namespace mocurate
