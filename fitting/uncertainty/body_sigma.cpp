#include "fitting/uncertainty/body_sigma.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/geometry/rotation.h"
#include "fitting/terms/hinge.h"
#include "fitting/terms/huber.h"

namespace mocurate {
namespace {

constexpr double kStep_s = 0.2;  ///< people rotate little in this time (numerical)
constexpr double kBend =
    0.3;  ///< rad, rotation of joints that compensates for a wrong body; first order is valid up to it
constexpr double kUnknownRotation = 1.81;  ///< rad, of a uniform angle (numerical)
constexpr double kLimbBone_m = 0.2;        ///< bone length from which a joint carries a limb
constexpr double kUnknownPlace = 1.0;      ///< m^2; variance of the prior on the root, weak (numerical)

/// Bones with an end that no frame shows. (J)
std::vector<bool> UnmeasuredBones(const SkeletonTracks& tracks, const PoseState& state) {
  const std::vector<bool> shown = tracks.JointObservations();
  std::vector<bool> unmeasured(shown.size(), false);
  for (std::size_t j = 1; j < shown.size(); ++j) {
    const auto joint = static_cast<int>(j);
    const bool both = shown[j] && shown[static_cast<std::size_t>(state.parent(joint))];
    unmeasured[j] = !both && *state.bone(joint) > kShortestBone_m;
  }
  return unmeasured;
}

/// Standard deviation of a joint that no evidence rotates and that is fixed in the rest pose, radians.
double FixedRotation(const PoseState& state, const std::vector<int>& children) {
  for (const int child : children) {
    if (*state.bone(child) > kLimbBone_m) return kLimbRotation;
  }
  return kEndRotation;
}

/// Unknowns: the root's position, rotations that the evidence determines, then ends of unmeasured bones, rotations of
/// fixed joints and offsets of tracked points on the person; three columns each, along the world's axes.
class BodyEquations {
 public:
  BodyEquations(const TrackProblem& whole, std::vector<bool> unmeasured)
      : whole_(whole),
        unmeasured_(std::move(unmeasured)),
        shown_(whole.tracks.JointObservations()),
        children_(whole.tracks.skeleton->Children()),
        rotation_(shown_.size(), -1),
        bone_(shown_.size(), -1),
        place_(shown_.size(), -1) {
    for (int j = 0; j < whole.state.joints(); ++j) {
      if (!whole.state.active(j)) continue;
      rotation_[static_cast<std::size_t>(j)] = pose_;
      pose_ += 3;
    }
    all_ = pose_;
    for (std::size_t j = 0; j < bone_.size(); ++j) {
      if (unmeasured_[j]) {
        bone_[j] = all_;
        all_ += 3;
      }
      if (rotation_[j] < 0 && !children_[j].empty()) {
        rotation_[j] = all_;
        all_ += 3;
      }
      if (shown_[j] && PlaceSigma(j) > 0.0) {
        place_[j] = all_;
        all_ += 3;
      }
    }
  }

  /// Covariance that the body adds to each joint. (J)
  std::vector<Matrix3d> At(int frame) const {
    const PoseState& state = whole_.state;
    const Eigen::MatrixXd moves = Moves(frame);
    Eigen::MatrixXd information = Priors();
    const double sigma = whole_.sigma;
    for (int j = 0; j < state.joints(); ++j) {
      if (!shown_[static_cast<std::size_t>(j)]) continue;
      Eigen::MatrixXd of_joint = moves.middleRows<3>(Eigen::Index{3} * j);
      if (const int place = place_[static_cast<std::size_t>(j)]; place >= 0)
        of_joint.middleCols<3>(place).setIdentity();
      information.selfadjointView<Eigen::Lower>().rankUpdate(of_joint.transpose(), 1.0 / (sigma * sigma));
    }
    // L L' = information, the pose first. The last rows of L^-1 J' are the body's uncertainty, carried to the joints
    // with the pose that follows it; the rows above are the pose's, given the body.
    const Eigen::LLT<Eigen::MatrixXd> factor(information);
    const Eigen::MatrixXd open = factor.matrixL().solve(moves.transpose()).bottomRows(all_ - pose_);
    std::vector<Matrix3d> added;
    for (int j = 0; j < state.joints(); ++j) {
      const auto of_joint = open.middleCols<3>(Eigen::Index{3} * j);
      added.emplace_back(of_joint.transpose() * of_joint);
    }
    return added;
  }

 private:
  double PlaceSigma(std::size_t j) const {
    return whole_.tracks.place_sigma.empty() ? 0.0 : whole_.tracks.place_sigma[j];
  }

  /// Derivatives of all positions by all unknowns, 3J x unknowns.
  Eigen::MatrixXd Moves(int frame) const {
    const PoseState& state = whole_.state;
    Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(Eigen::Index{3} * state.joints(), all_);
    for (int j = 0; j < state.joints(); ++j) {
      auto of_joint = moves.middleRows<3>(Eigen::Index{3} * j);
      of_joint.leftCols<3>().setIdentity();
      for (int a = state.parent(j); a >= 0; a = state.parent(a)) {
        const Vector3d arm = state.position(frame, j) - state.position(frame, a);
        of_joint.middleCols<3>(rotation_[static_cast<std::size_t>(a)]) = -Hat(arm);
      }
      for (const int b : state.bones(j)) {
        if (unmeasured_[static_cast<std::size_t>(b)])
          of_joint.middleCols<3>(bone_[static_cast<std::size_t>(b)]).setIdentity();
      }
    }
    return moves;
  }

  Eigen::MatrixXd Priors() const {
    const PoseState& state = whole_.state;
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(all_, all_);
    information.diagonal().head<3>().setConstant(1.0 / kUnknownPlace);
    for (int j = 0; j < state.joints(); ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (rotation_[at] >= 0) {
        const double rotation_sigma = j == 0            ? kUnknownRotation
                                      : state.active(j) ? kBend
                                                        : FixedRotation(state, children_[at]);
        information.diagonal().segment<3>(rotation_[at]).setConstant(1.0 / (rotation_sigma * rotation_sigma));
      }
      if (place_[at] >= 0)
        information.diagonal().segment<3>(place_[at]).setConstant(1.0 / (PlaceSigma(at) * PlaceSigma(at)));
      if (bone_[at] < 0) continue;
      const double bone_sigma = SpreadOfBone(*whole_.tracks.skeleton, j);
      information.diagonal().segment<3>(bone_[at]).setConstant(1.0 / (bone_sigma * bone_sigma));
    }
    return information;
  }

  const TrackProblem& whole_;
  std::vector<bool> unmeasured_;
  std::vector<bool> shown_;
  std::vector<std::vector<int>> children_;
  std::vector<int> rotation_;  ///< first column of a joint's rotation; -1: none
  std::vector<int> bone_;      ///< first column of the end of a bone; -1: measured
  std::vector<int> place_;     ///< first column of a tracked point's offset from its place; -1: a joint
  int pose_ = 3;               ///< columns of the pose
  int all_ = 0;
};

}  // namespace

double SpreadOfBone(const Skeleton& skeleton, int bone) {
  const int start = skeleton.joints[bone].parent;
  return skeleton.joints[start].mirror == start ? kTrunkSigma : kLimbSigma;
}

std::vector<float> CovarianceOfBody(const TrackProblem& whole) {
  std::vector<bool> unmeasured = UnmeasuredBones(whole.tracks, whole.state);
  const bool measured = std::find(unmeasured.begin(), unmeasured.end(), true) == unmeasured.end();
  if (measured && whole.tracks.place_sigma.empty()) return {};
  const BodyEquations equations(whole, std::move(unmeasured));
  const auto joints = static_cast<std::size_t>(whole.state.joints());
  const std::vector<double>& time_s = whole.tracks.time_s;
  std::vector<float> covariance(6 * joints * static_cast<std::size_t>(whole.frames()), 0.0F);
  int begin = 0;
  std::vector<Matrix3d> before = equations.At(0);
  std::vector<Matrix3d> after = before;
  for (int f = 0; f < whole.frames(); ++f) {
    if (f > 0 && f < whole.frames() - 1 && time_s[f] - time_s[begin] < kStep_s) continue;
    if (f > 0) after = equations.At(f);
    for (int g = begin; g <= f; ++g) {
      const double share = f > begin ? (time_s[g] - time_s[begin]) / (time_s[f] - time_s[begin]) : 0.0;
      for (std::size_t j = 0; j < joints; ++j) {
        ToSixNumbers((1.0 - share) * before[j] + share * after[j],
                     covariance.data() + 6 * (static_cast<std::size_t>(g) * joints + j));
      }
    }
    before = after;
    begin = f;
  }
  return covariance;
}

namespace {

/// Share of the squared length of a bone: mean square of its shortening for a uniform direction (numerical).
constexpr double kEveryDirection = 4.0 / 3.0;

/// Covariance along a bone whose end has `more` covariance than its start (m^2).
Matrix3d AlongBone(const Vector3d& bone, const Matrix3d& more) {
  const double square = bone.squaredNorm();
  if (square < kShortestBone_m * kShortestBone_m) return Matrix3d::Zero();
  const Vector3d along = bone / std::sqrt(square);
  const double across = std::max(more.trace() - along.dot(more * along), 0.0) / square;  // rad^2
  const double nearer = kEveryDirection * (1.0 - std::exp(-0.5 * across * across / kEveryDirection));
  return nearer * square * along * along.transpose();
}

}  // namespace

void AddSecondOrderCovariance(const TrackProblem& whole, std::vector<float>& position_cov) {
  const PoseState& state = whole.state;
  std::vector<Matrix3d> own(static_cast<std::size_t>(state.joints()));
  std::vector<Matrix3d> added(own.size());
  for (int f = 0; f < whole.frames(); ++f) {
    for (int j = 0; j < state.joints(); ++j) {
      float* stated = position_cov.data() + 6 * whole.Index(f, j);
      own[j] = FromSixNumbers(stated);
      added[j].setZero();
      if (j == 0 || whole.tracks.seen(f, j)) continue;
      const int start = state.parent(j);
      added[j] = added[start] + AlongBone(state.position(f, j) - state.position(f, start), own[j] - own[start]);
      ToSixNumbers(own[j] + added[j], stated);
    }
  }
}

namespace {

/// Of the longest lever, squared: below, the axis is that of the only bone (numerical).
constexpr double kNoLever = 1e-9;
constexpr double kCarryingAngleSigma = 0.1;  ///< radians, standard deviation of carrying angles between people

}  // namespace

std::vector<Matrix3d> FrameOrientationByBones(const Skeleton& skeleton, const std::vector<double>& bone_length,
                                              const std::vector<double>& variance) {
  std::vector<Matrix3d> information(skeleton.joints.size(), Matrix3d::Zero());
  for (std::size_t j = 1; j < skeleton.joints.size(); ++j) {
    if (!(variance[j] > 0.0)) continue;
    const Vector3d bone = bone_length[j] * skeleton.joints[j].rest_offset.stableNormalized();
    information[skeleton.joints[j].parent] +=
        (bone.squaredNorm() * Matrix3d::Identity() - bone * bone.transpose()) / variance[j];
  }
  std::vector<Matrix3d> covariance;
  for (const Matrix3d& of_joint : information) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(of_joint);
    Vector3d variance_about = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      if (eigen.eigenvalues()[i] <= kNoLever * eigen.eigenvalues()[2]) continue;
      variance_about[i] = std::min(1.0 / eigen.eigenvalues()[i], kUnknownAngle);
    }
    covariance.emplace_back(eigen.eigenvectors() * variance_about.asDiagonal() * eigen.eigenvectors().transpose());
  }
  const std::vector<std::optional<Hinge>> hinges = HingesOf(skeleton);
  for (std::size_t j = 1; j < hinges.size(); ++j) {
    if (!hinges[j]) continue;
    const Vector3d bone = skeleton.joints[j].rest_offset.stableNormalized();
    covariance[skeleton.joints[j].parent] += Square(kCarryingAngleSigma) * bone * bone.transpose();
  }
  return covariance;
}

std::vector<Matrix3d> FrameOrientationCovariance(const TrackProblem& whole) {
  const std::vector<bool> shown = whole.tracks.JointObservations();
  const Skeleton& skeleton = *whole.tracks.skeleton;
  std::vector<double> length(shown.size(), 0.0), variance(shown.size(), 0.0);
  for (int j = 1; j < whole.state.joints(); ++j) {
    const int start = skeleton.joints[j].parent;
    length[j] = *whole.state.bone(j);
    if (!shown[j] || !shown[start]) continue;
    variance[j] = Square(SpreadOfBone(skeleton, j));
    if (!whole.tracks.place_sigma.empty())
      variance[j] += Square(whole.tracks.place_sigma[j]) + Square(whole.tracks.place_sigma[start]);
  }
  return FrameOrientationByBones(skeleton, length, variance);
}

}  // namespace mocurate
