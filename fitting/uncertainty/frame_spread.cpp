#include "fitting/uncertainty/frame_spread.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>

#include "fitting/costs/hinge_cost.h"
#include "fitting/costs/huber.h"
#include "fitting/uncertainty/body_spread.h"

namespace mocurate {
namespace {

constexpr double kNoLever = 1e-9;        ///< of the longest lever, squared: the axis is the only bone's
constexpr double kCarryingSpread = 0.1;  ///< radians between people's carrying angles, all along the same

}  // namespace

std::vector<Matrix3d> FrameSpreads(const TrackWindow& whole) {
  const std::vector<bool> shown = whole.tracks.SeenJoints();
  const std::vector<Joint>& joints = whole.tracks.skeleton->joints;
  std::vector<Matrix3d> information(joints.size(), Matrix3d::Zero());
  for (int j = 1; j < whole.state.joints(); ++j) {
    const int start = joints[j].parent;
    if (!shown[j] || !shown[start]) continue;
    const Vector3d bone = *whole.state.bone(j) * joints[j].rest_offset.stableNormalized();
    double variance = Square(SpreadOfBone(*whole.tracks.skeleton, j));
    if (!whole.tracks.place_spread.empty())
      variance += Square(whole.tracks.place_spread[j]) + Square(whole.tracks.place_spread[start]);
    information[start] += (bone.squaredNorm() * Matrix3d::Identity() - bone * bone.transpose()) / variance;
  }
  std::vector<Matrix3d> spreads;
  for (const Matrix3d& of_joint : information) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(of_joint);
    Vector3d variance = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      if (eigen.eigenvalues()[i] <= kNoLever * eigen.eigenvalues()[2]) continue;
      variance[i] = std::min(1.0 / eigen.eigenvalues()[i], kUnknownAngle);
    }
    spreads.emplace_back(eigen.eigenvectors() * variance.asDiagonal() * eigen.eigenvectors().transpose());
  }
  const std::vector<std::optional<Hinge>> hinges = HingesOf(*whole.tracks.skeleton);
  for (std::size_t j = 1; j < joints.size(); ++j) {
    if (!hinges[j]) continue;
    const Vector3d bone = joints[j].rest_offset.stableNormalized();
    spreads[joints[j].parent] += Square(kCarryingSpread) * bone * bone.transpose();
  }
  return spreads;
}

}  // namespace mocurate
