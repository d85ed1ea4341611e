#include "eval/metrics/fit_error.h"

#include <cmath>

#include "core/motion/kinematics.h"

namespace mocurate {
namespace {

constexpr double kRadToDeg = 180.0 / 3.14159265358979323846;
constexpr double kShortestBone = 0.06;  // metres; shorter ones are not averaged
constexpr float kObservedAxis = 0.1F;   // least share of the prior's variance that the evidence removes

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

/// Whether rotations of both are relative to one rest pose, joint by joint.
bool SameRestPose(const Motion& fitted, const Motion& truth) {
  const Skeleton &a = *fitted.rest_pose(), &b = *truth.rest_pose();
  return SameTree(a, b) && RestPosesApart(a, b) < kSameRestPose;
}

std::optional<NotMeasured> WhyNoRotations(const Motion& fitted, const Motion& truth) {
  if (fitted.joints_only() || fitted.rotation_sigma.empty() || fitted.rotation_observed.empty())
    return NotMeasured::kNoRotationSigma;
  if (truth.joints_only()) return NotMeasured::kNoTrueRotations;
  if (!SameRestPose(fitted, truth)) return NotMeasured::kOtherRestPose;
  return std::nullopt;
}

/// Components of the rotation between fit and truth about the axes of the joint.
void AddAxes(const Motion& fitted, const Motion& truth, int frame, int joint, SigmaSamples& axes) {
  const Vector3d error = LogQuaternion(truth.rotation_at(frame, joint).conjugate() * fitted.rotation_at(frame, joint));
  const std::size_t at = 3 * (static_cast<std::size_t>(frame) * fitted.joint_count() + joint);
  for (int i = 0; i < 3; ++i) {
    if (fitted.rotation_observed[at + i] > kObservedAxis)
      axes.AddAxis(error[i], static_cast<double>(fitted.rotation_sigma[at + i]));
  }
}

void AddSigma(const Motion& fitted, const Motion& truth, const std::vector<std::pair<int, int>>& shared,
              FitError& error) {
  if (fitted.position_cov.empty()) error.no_positions = NotMeasured::kNoPositionCov;
  error.no_rotations = WhyNoRotations(fitted, truth);
  const std::vector<BodyPart> parts = BodyPartsOf(*fitted.skeleton);
  for (int f = 0; f < truth.frame_count(); ++f) {
    for (const auto& [a, b] : shared) {
      const std::size_t at = static_cast<std::size_t>(f) * fitted.joint_count() + a;
      const bool observed = fitted.state.empty() || fitted.state[at] == JointState::kObserved ||
                            fitted.state[at] == JointState::kRepaired;
      FitSamples& samples = error.sigma.At(parts[a], observed);
      if (!error.no_positions) {
        samples.positions.AddPosition(fitted.joints.at(f, a) - truth.joints.at(f, b),
                                      FromSixNumbers(fitted.position_cov.data() + 6 * at));
      }
      if (!error.no_rotations) AddAxes(fitted, truth, f, a, samples.rotations);
    }
  }
}

}  // namespace

Expected<FitError> CompareWithTruth(const Clip& fitted, const Evidence& evidence, const Motion& truth) {
  if (!fitted.motion || fitted.motion->frame_count() != truth.frame_count()) {
    return Fail(ErrorCode::kInconsistent,
                "the fit has " + std::to_string(fitted.motion ? fitted.motion->frame_count() : 0) +
                    " frames, the truth " + std::to_string(truth.frame_count()),
                fitted.id(), "use the truth of this recording, with all of its frames");
  }
  const Motion& motion = *fitted.motion;
  const auto shared = SharedJoints(*motion.skeleton, *truth.skeleton);
  if (shared.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "skeletons '" + motion.skeleton->name + "' and '" + truth.skeleton->name + "' share no joint name",
                fitted.id(), "give the joints of one of them the other's names as synonyms");
  }
  FitError error;
  error.frames = truth.frame_count();
  double sum = 0.0;
  for (int f = 0; f < truth.frame_count(); ++f) {
    for (const auto& [a, b] : shared) {
      const double mm = 1000.0 * (motion.joints.at(f, a) - truth.joints.at(f, b)).norm();
      error.joints_mm[motion.skeleton->joints[static_cast<std::size_t>(a)].name] += mm / truth.frame_count();
      sum += mm;
    }
  }
  error.joint_mm = sum / (static_cast<double>(shared.size()) * truth.frame_count());
  if (!motion.joints_only() && !truth.joints_only()) AddRotationErrors(motion, truth, shared, error);
  AddBoneErrors(motion, truth, shared, error);
  AddSigma(motion, truth, shared, error);
  if (evidence.tracks) AddEvidenceError(*evidence.tracks, truth, error);
  return error;
}

}  // namespace mocurate
