#pragma once

#include <vector>

#include "core/motion/kinematics.h"
#include "core/motion/skeleton.h"

namespace mocurate {

/// Action2Motion's forward kinematics (a2m_actor.md B.3) and its derivative for many frames at once, float32 in and
/// out. Bones in the order of the chains; a chain starts from the identity.
class LieLayer {
 public:
  /// The bone that ends at `joint`; bones are in the order of the chains.
  struct Bone {
    int joint = 0;
    int parent = 0;
    bool starts_chain = false;
    double offset[3] = {0, 0, 0};  ///< unit vector
  };

  LieLayer() = default;
  LieLayer(const LieChains& chains, LieExp exp);

  int joint_count() const { return static_cast<int>(parent_.size()); }
  /// Parent along the chains; 0 for the root.
  const std::vector<int>& parents() const { return parent_; }

  const std::vector<Bone>& bones() const { return bones_; }
  /// Smallest squared angle: below it the factors of Rodrigues' formula stay as they are.
  double floor() const { return floor_; }

  /// `parameters` (count, 3J): root translation, then w_1..w_{J-1}. `bone_length` (count, J) metres. -> `joints`
  /// (count, 3J).
  void Forward(const float* parameters, const float* bone_length, int count, float* joints) const;

  /// `joint_gradient` (count, 3J) -> `parameter_gradient` (count, 3J), overwritten.
  void Backward(const float* parameters, const float* bone_length, const float* joint_gradient, int count,
                float* parameter_gradient) const;

 private:
  double floor_ = 0.0;
  std::vector<Bone> bones_;
  std::vector<int> parent_;
};

}  // namespace mocurate
