#pragma once

#include <optional>
#include <vector>

#include "fitting/costs/hinge_cost.h"
#include "fitting/solver/block_tridiagonal.h"
#include "fitting/solver/body_information.h"
#include "fitting/solver/track_window.h"

namespace mocurate {

/// Cost and normal equations of a window at the present parameters of its state. Unknowns of a frame: translation (3),
/// then the rotation vector of each active joint (3), root first. The costs are those of fitting/costs/, summed here
/// without forming their Jacobians.
class TrackEquations {
 public:
  explicit TrackEquations(const TrackWindow& window);

  int size() const { return size_; }

  /// 1/2 sum of rho(|r|^2). The state's kinematics must be up to date.
  double Cost() const;
  /// Gauss-Newton, robust costs reweighted. The state's kinematics must be up to date, derivatives included.
  void Linearise(BlockTridiagonal& equations);

  /// First unknown of a joint's rotation in its frame; -1: it has none.
  int column(int joint) const { return column_[joint]; }
  /// Information of an observed joint's sample (1 / m^2), robust loss included, at the present parameters.
  Matrix3d DataInformation(int frame, int joint) const;

  /// Unknowns of the window ((end - begin) * size).
  Eigen::VectorXd Parameters() const;
  /// Writes them and updates the kinematics with derivatives.
  void SetParameters(const Eigen::VectorXd& parameters);

 private:
  using Twist = Eigen::Matrix<double, 6, 3>;
  /// Sums over all points below a joint and its recorded rotation (moved by its rotation), and over those and the joint
  /// itself.
  struct Subtree {
    BodyInformation below;
    BodyInformation at;
  };
  /// The same across a step.
  struct CrossSubtree {
    Matrix6d below;
    Matrix6d at;
  };

  bool joined(int frame) const {
    return velocity_weight_[window_.Index(frame, 0)] > 0.0;
  }  ///< frame and the next, both of the window
  Vector3d Relative(int frame, int joint) const {
    return window_.state.position(frame, joint) - window_.state.position(frame, 0);
  }
  /// Log(target^T G): rotation of a joint from its recorded rotation, which it must have.
  Vector3d RecordedRotation(int frame, int joint) const;
  /// Adds the information of a joint's recorded rotation, if there is one, to the twist of the joint's descendants.
  void AddRecordedRotation(int frame, int joint, BodyInformation& moved) const;
  void UpdateTwists(int frame, std::vector<Twist>& twists) const;
  void SumFrame(int frame);
  void SumStep(int frame, std::vector<CrossSubtree>& sums) const;
  void AddFrame(int frame, BlockTridiagonal& equations) const;
  void AddStep(int frame, BlockTridiagonal& equations) const;
  void AddPriors(int frame, BlockTridiagonal& equations) const;
  void AddRotationStep(int frame, BlockTridiagonal& equations) const;

  const TrackWindow window_;
  int size_;
  std::vector<std::optional<Hinge>> hinges_;  ///< (J)
  std::vector<int> column_;                   ///< first unknown of a joint's rotation in its frame; -1: not active
  std::vector<double> velocity_weight_;       ///< squared, of a frame's step to the next; 0 where not joined. (F*J)
  std::vector<double> rotation_weight_;       ///< squared, likewise
  std::vector<Subtree> subtree_;              ///< of the frame that is being added
  std::vector<CrossSubtree> step_after_;
  std::vector<Twist> twist_;  ///< dp = X(p) twist dw for a joint's rotation vector, of this frame
  std::vector<Twist> twist_next_;
};

}  // namespace mocurate
