#pragma once

#include <torch/torch.h>

#include <optional>
#include <vector>

#include "core/skin/skin.h"

namespace mocurate {

/// Forward kinematics of N poses of a tree as one differentiable function of float32 numbers on the CPU, with its own
/// backward pass. `parents` (J), -1 for the root, each below its child; `rotation` (N,J,3,3) parent_from_joint;
/// `offsets` (J,3) or (N,J,3) in the parent's frame. Returns world_from_joint (N,J,3,3) and joints (N,J,3), the root
/// at the origin.
torch::autograd::variable_list TreeKinematics(const std::vector<int>& parents, const torch::Tensor& rotation,
                                              const torch::Tensor& offsets);

/// The same in plain tensor operations: the reference of TreeKinematics, and what other devices run.
torch::autograd::variable_list PlainTreeKinematics(const std::vector<int>& parents, const torch::Tensor& rotation,
                                                   const torch::Tensor& offsets);

/// Forward kinematics on a tree (core/motion/kinematics.h), differentiable, float32.
class BodyTree {
 public:
  BodyTree() = default;
  /// `parents` (J), -1 for the root; `rest_offset` (J) metres.
  BodyTree(std::vector<int> parents, const std::vector<Vector3d>& rest_offset);

  struct Posed {
    torch::Tensor rotation;  ///< (N,J,3,3) world_from_joint
    torch::Tensor joints;    ///< (N,J,3) root at the origin
  };
  /// `rotation` (N,J,3,3) parent_from_joint. `offsets` (N,J,3) in the place of the rest offsets; or undefined.
  Posed Pose(const torch::Tensor& rotation, const torch::Tensor& offsets = {}) const;

  /// Joints (T,B,3J) with bones of given lengths along the rest offsets: `rotation` (T,B,J,3,3), `place` (T,B,3) of the
  /// root or undefined, `bone_length` (B,J) metres.
  torch::Tensor JointsOfBones(const torch::Tensor& rotation, const torch::Tensor& place,
                              const torch::Tensor& bone_length) const;

  std::int64_t joint_count() const { return static_cast<std::int64_t>(parents_.size()); }

 private:
  std::vector<int> parents_;
  torch::Tensor rest_offset_;
};

/// A skinned body: v' = sum of w_j (G_j (v - J_j) + p_j), v with its pose-dependent offsets where the body has them.
class SkinnedBody {
 public:
  SkinnedBody() = default;
  SkinnedBody(const Skin& skin, const std::vector<int>& parents);

  const BodyTree& tree() const { return tree_; }
  std::int64_t vertex_count() const { return vertex_count_; }

  /// (N,V,3), root at its rest place.
  torch::Tensor Vertices(const torch::Tensor& rotation) const;

  /// Sum over frames of the squared distances of all vertices between two poses (N,J,3,3), moved by `translation`
  /// (N,3), their difference of root places; or undefined. Without pose-dependent offsets vertices are linear in the
  /// joints' transforms, and the sum is a quadratic form of 4J numbers, exactly.
  torch::Tensor SquaredDistance(const torch::Tensor& rotation, const torch::Tensor& other,
                                const torch::Tensor& translation) const;

 private:
  torch::Tensor ByVertices(const torch::Tensor& rotation, const torch::Tensor& other,
                           const torch::Tensor& translation) const;

  BodyTree tree_;
  std::int64_t vertex_count_ = 0;
  torch::Tensor root_, vertices_, joints_, weights_, blending_;  ///< (3), (V,3), (J,3), (V,J), (3V, 9(J-1))
  torch::Tensor gram_;                                           ///< (4J,4J)
};

}  // namespace mocurate
