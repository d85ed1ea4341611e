#include "fitting/uncertainty/frame_orientation.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>

#include "fitting/costs/hinge_cost.h"
#include "fitting/costs/huber.h"
#include "fitting/uncertainty/body_sigma.h"

namespace mocurate {
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

std::vector<Matrix3d> FrameOrientationCovariance(const TrackWindow& whole) {
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
