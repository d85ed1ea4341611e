#include "fitting/clouds/depth_pose_graph.h"

#include <open3d/pipelines/registration/GlobalOptimization.h>
#include <open3d/pipelines/registration/GlobalOptimizationConvergenceCriteria.h>
#include <open3d/pipelines/registration/GlobalOptimizationMethod.h>
#include <open3d/pipelines/registration/PoseGraph.h>
#include <open3d/utility/Logging.h>

#include <exception>
#include <string>

namespace mocurate {
namespace {

namespace o3d = open3d::pipelines::registration;

Eigen::Matrix4d MatrixOf(const RigidTransform& transform) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = transform.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = transform.translation;
  return matrix;
}

RigidTransform TransformOf(const Eigen::Matrix4d& matrix) {
  return {Quaterniond(Matrix3d(matrix.topLeftCorner<3, 3>())).normalized(), matrix.topRightCorner<3, 1>()};
}

}  // namespace

Expected<std::vector<RigidTransform>> SolvePoseGraph(std::size_t nodes, const std::vector<PoseEdge>& edges) {
  open3d::utility::SetVerbosityLevel(open3d::utility::VerbosityLevel::Error);
  o3d::PoseGraph graph;
  graph.nodes_.resize(nodes);
  for (const PoseEdge& edge : edges) {
    graph.edges_.emplace_back(static_cast<int>(edge.moved), static_cast<int>(edge.still),
                              MatrixOf(edge.still_from_moved), edge.information, false);
  }
  o3d::GlobalOptimizationOption option;
  option.reference_node_ = 0;
  try {
    o3d::GlobalOptimization(graph, o3d::GlobalOptimizationLevenbergMarquardt(),
                            o3d::GlobalOptimizationConvergenceCriteria(), option);
  } catch (const std::exception& error) {
    return Fail(ErrorCode::kInconsistent, std::string("the pose graph cannot be solved: ") + error.what(),
                "depth views", "set fitting.point_clouds.audit.moved to off");
  }
  std::vector<RigidTransform> moves;
  for (const o3d::PoseGraphNode& node : graph.nodes_) moves.push_back(TransformOf(node.pose_));
  return moves;
}

}  // namespace mocurate
