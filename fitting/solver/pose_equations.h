#pragma once

#include <Eigen/Core>
#include <vector>

#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/body_information.h"
#include "fitting/terms/terms.h"

namespace mocurate {

/// Derivative of a body's twist in the rotation vector of a joint at or above its carrier: 6 x 3. The state's
/// kinematics must be up to date, derivatives included.
using Twist = Eigen::Matrix<double, 6, 3>;
Twist TwistOf(const PoseState& state, int frame, int joint);

/// Unknowns of a frame: translation (3), then the rotation vector of each active joint (3), root first.
class PoseColumns {
 public:
  explicit PoseColumns(const PoseState& state);

  int size() const { return size_; }
  /// First unknown of a joint's rotation in its frame; -1: it has none.
  int of(int joint) const { return column_[static_cast<std::size_t>(joint)]; }

  /// Unknowns of all frames of the terms, one after the other.
  Eigen::VectorXd Read(const PoseTerms& terms, const PoseState& state) const;
  /// Writes them and updates the kinematics with derivatives.
  void Write(const PoseTerms& terms, const Eigen::VectorXd& unknowns, PoseState& state) const;

 private:
  int size_ = 3;
  std::vector<int> column_;  ///< (J)
};

/// Normal equations of terms by subtree sums, without their Jacobians: the rows of a body are summed over everything
/// that moves with it, and a joint's rotation needs only the sum below it (BodyInformation).
class PoseEquations {
 public:
  explicit PoseEquations(const PoseState& state);

  const PoseColumns& columns() const { return columns_; }

  /// Gauss-Newton, robust rows reweighted, at the pose of the state. `equations` must have a block of columns().size()
  /// for each frame of the terms. The state's kinematics must be up to date, derivatives included.
  void Linearise(const PoseTerms& terms, const PoseState& state, BlockTridiagonal& equations);

 private:
  struct Rows;

  void AddFrame(const PoseState& state, BlockTridiagonal::Block diagonal, BlockTridiagonal::Column gradient);
  void AddNext(const PoseState& state, BlockTridiagonal::Block next);

  PoseColumns columns_;
  std::vector<BodyInformation> here_, next_;  ///< (J) of the frame that is being added, and of the next
  std::vector<Matrix6d> across_;              ///< (J) between both
  std::vector<Twist> twist_, twist_next_;     ///< (J)
};

}  // namespace mocurate
