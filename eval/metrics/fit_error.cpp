#include "eval/metrics/fit_error.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

constexpr double kRadToDeg = 180.0 / 3.14159265358979323846;
constexpr double kShortestBone = 0.06;  // metres; shorter ones are not averaged

/// Pairs (joint of a, joint of b) with one name.
std::vector<std::pair<int, int>> SharedJoints(const Skeleton& a, const Skeleton& b) {
  std::vector<std::pair<int, int>> shared;
  for (int j = 0; j < a.joint_count(); ++j) {
    if (const auto other = b.FindJoint(a.joints[j].name)) shared.emplace_back(j, *other);
  }
  return shared;
}

std::vector<Quaterniond> GlobalRotations(const Motion& motion, int frame) {
  std::vector<Vector3d> joints(motion.joint_count());
  std::vector<Quaterniond> global(motion.joint_count());
  ForwardKinematics(*motion.skeleton, motion.root_translation[frame], &motion.rotation_at(frame, 0), motion.bone_length,
                    joints.data(), global.data());
  return global;
}

/// Whether joint positions determine a joint's full rotation: two or more children in non-collinear directions.
bool RotationIsVisible(const Skeleton& skeleton, const std::vector<int>& children) {
  for (std::size_t a = 0; a < children.size(); ++a) {
    for (std::size_t b = a + 1; b < children.size(); ++b) {
      const Vector3d u = skeleton.joints[children[a]].rest_offset.normalized();
      const Vector3d v = skeleton.joints[children[b]].rest_offset.normalized();
      if (u.cross(v).norm() > 0.1) return true;
    }
  }
  return false;
}

void AddRotationErrors(const Motion& fitted, const Motion& truth, const std::vector<std::pair<int, int>>& shared,
                       FitError& error) {
  const auto children = truth.skeleton->Children();
  std::vector<std::pair<int, int>> visible;
  for (const auto& [a, b] : shared) {
    if (RotationIsVisible(*truth.skeleton, children[b])) visible.emplace_back(a, b);
  }
  if (visible.empty()) return;
  double sum = 0.0;
  for (int f = 0; f < truth.frame_count(); ++f) {
    const auto of_fit = GlobalRotations(fitted, f);
    const auto of_truth = GlobalRotations(truth, f);
    for (const auto& [a, b] : visible) sum += AngleBetween(of_fit[a], of_truth[b]) * kRadToDeg;
  }
  error.rotation_deg = sum / (static_cast<double>(visible.size()) * truth.frame_count());
}

void AddBoneErrors(const Motion& fitted, const Motion& truth, const std::vector<std::pair<int, int>>& shared,
                   FitError& error) {
  double sum = 0.0;
  int count = 0;
  for (const auto& [a, b] : shared) {
    const int parent = truth.skeleton->joints[b].parent;
    if (parent < 0) continue;
    for (const auto& [pa, pb] : shared) {
      if (pb != parent) continue;
      for (int f = 0; f < truth.frame_count(); ++f) {
        const Vector3d of_truth = truth.joints.at(f, b) - truth.joints.at(f, parent);
        const Vector3d of_fit = fitted.joints.at(f, a) - fitted.joints.at(f, pa);
        if (of_truth.norm() < kShortestBone || of_fit.norm() < 1e-9) continue;
        sum += std::atan2(of_fit.cross(of_truth).norm(), of_fit.dot(of_truth)) * kRadToDeg;
        ++count;
      }
    }
  }
  error.bone_direction_deg = count == 0 ? 0.0 : sum / count;
}

void AddEvidenceError(const JointTracks& tracks, const Motion& truth, FitError& error) {
  double sum = 0.0;
  int count = 0;
  const int points = static_cast<int>(tracks.names.size());
  for (int k = 0; k < points; ++k) {
    const auto joint = truth.skeleton->FindJoint(tracks.names[k]);
    if (!joint) continue;
    for (int f = 0; f < truth.frame_count() && f < tracks.positions.frames; ++f) {
      if (!(tracks.confidence[static_cast<std::size_t>(f) * points + k] > 0.0)) continue;
      sum += 1000.0 * (tracks.positions.at(f, k) - truth.joints.at(f, *joint)).norm();
      ++count;
    }
  }
  error.evidence_mm = count == 0 ? 0.0 : sum / count;
}

Matrix3d PositionCovariance(const Motion& motion, int frame, int joint) {
  return FromSixNumbers(motion.position_cov.data() +
                        6 * (static_cast<std::size_t>(frame) * motion.joint_count() + joint));
}

void AddCoverage(const Motion& fitted, const Motion& truth, const std::vector<std::pair<int, int>>& shared,
                 FitError& error) {
  if (fitted.position_cov.empty()) return;
  std::array<std::int64_t, 12> within{};
  std::int64_t count = 0;
  for (int f = 0; f < truth.frame_count(); ++f) {
    for (const auto& [a, b] : shared) {
      const Eigen::LLT<Matrix3d> root(PositionCovariance(fitted, f, a));
      if (root.info() != Eigen::Success) continue;
      const Vector3d white = root.matrixL().solve(Vector3d(fitted.joints.at(f, a) - truth.joints.at(f, b)));
      for (std::size_t i = 0; i < within.size(); ++i)
        within[i] += (white.array().abs() < 0.25 * static_cast<double>(i + 1)).count();
      count += 3;
    }
  }
  if (count == 0) return;
  Coverage& coverage = error.coverage;
  for (std::size_t i = 0; i < within.size(); ++i)
    coverage.within[i] = static_cast<double>(within[i]) / static_cast<double>(count);
  coverage.components = count;
}

}  // namespace

Expected<FitError> CompareWithTruth(const Clip& fitted, const Evidence& evidence, const Motion& truth) {
  if (!fitted.motion || fitted.motion->frame_count() != truth.frame_count()) {
    return Fail(ErrorCode::kInconsistent,
                "the fit has " + std::to_string(fitted.motion ? fitted.motion->frame_count() : 0) +
                    " frames, the truth " + std::to_string(truth.frame_count()),
                fitted.id());
  }
  const Motion& motion = *fitted.motion;
  const auto shared = SharedJoints(*motion.skeleton, *truth.skeleton);
  if (shared.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "skeletons '" + motion.skeleton->name + "' and '" + truth.skeleton->name + "' share no joint name",
                fitted.id());
  }
  FitError error;
  error.frames = truth.frame_count();
  double sum = 0.0;
  for (int f = 0; f < truth.frame_count(); ++f) {
    for (const auto& [a, b] : shared) sum += 1000.0 * (motion.joints.at(f, a) - truth.joints.at(f, b)).norm();
  }
  error.joint_mm = sum / (static_cast<double>(shared.size()) * truth.frame_count());
  if (!motion.joints_only() && !truth.joints_only()) AddRotationErrors(motion, truth, shared, error);
  AddBoneErrors(motion, truth, shared, error);
  AddCoverage(motion, truth, shared, error);
  if (evidence.tracks) AddEvidenceError(*evidence.tracks, truth, error);
  return error;
}

}  // namespace mocurate
