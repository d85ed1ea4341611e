#include "ingest/checks/posed_joint_checks.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "ingest/checks/angle_checks.h"
#include "ingest/checks/pose_checks.h"
#include "ingest/sources/smpl_motion.h"

namespace mocurate {
namespace {

// Joints and rotations of one fit agree to 1e-5 rad. Places of another fit of the same frame are some cm off: 5 cm at
// the end of a bone of 0.25 m are 11 degrees.
constexpr double kMostOffOwn = 20.0;
// Limbs of SMPL's bodies hang and spread at rest by some 10 degrees either way of the skeleton's.
constexpr double kMostOffRest = 45.0;
constexpr double kFewestOff = 0.1;  // of the frames
constexpr double kLongBone = 0.5;   // of the longest: thighs, shins, both bones of the arms; short ones turn by a cm
constexpr std::size_t kFewestTurned = 5;  // fewer have no direction of their own

double Degrees(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / kPi; }

struct BoneOff {
  double most = 0.0;  ///< degrees
  std::size_t frames = 0, first = 0, last = 0;
  bool of_rest = false;
};

/// `bone` (F): turned back by the rotations of the joint that it hangs at.
BoneOff Off(const std::vector<Vector3d>& bone, const Vector3d& rest) {
  Vector3d own = Vector3d::Zero();
  for (const Vector3d& way : bone) own += way.normalized();
  BoneOff off;
  off.of_rest = Degrees(own, rest) > kMostOffRest;
  const double limit = off.of_rest ? kMostOffRest : kMostOffOwn;
  for (std::size_t f = 0; f < bone.size(); ++f) {
    const double angle = Degrees(bone[f], off.of_rest ? rest : own);
    if (angle <= limit) continue;
    if (off.frames++ == 0) off.first = f;
    off.last = f;
    off.most = std::max(off.most, angle);
  }
  return off;
}

/// (J, F): each joint's bone in the frame of its parent joint, as the rotations turn it.
std::vector<std::vector<Vector3d>> BonesTurnedBack(const HumanAct12Clip& clip, const Skeleton& skeleton,
                                                   const std::vector<int>& columns,
                                                   const std::vector<Quaterniond>& local) {
  const std::size_t joints = skeleton.joints.size();
  std::vector<std::vector<Vector3d>> bones(joints);
  std::vector<Quaterniond> global(joints);
  for (std::size_t f = 0; f < clip.frames; ++f) {
    const auto place = [&](std::size_t joint) {
      const double* at = &clip.joints[f * 3 * kSmplJoints + static_cast<std::size_t>(columns[joint])];
      return Vector3d(at[0], at[1], at[2]);
    };
    for (std::size_t j = 0; j < joints; ++j) {
      const int parent = skeleton.joints[j].parent;
      global[j] = parent < 0 ? local[f * joints + j] : global[static_cast<std::size_t>(parent)] * local[f * joints + j];
      if (parent < 0) continue;
      const auto p = static_cast<std::size_t>(parent);
      bones[j].push_back(global[p].conjugate() * (place(j) - place(p)));
    }
  }
  return bones;
}

double MeanLength(const std::vector<Vector3d>& bone) {
  double sum = 0.0;
  for (const Vector3d& way : bone) sum += way.norm();
  return bone.empty() ? 0.0 : sum / static_cast<double>(bone.size());
}

Finding PoseContradiction(const std::string& joint, const BoneOff& off, std::size_t frames) {
  Finding finding = FrameFinding(
      "pose_contradiction", static_cast<int>(off.first), static_cast<int>(off.last + 1), joint, off.most,
      "'poses' and 'joints3D' are not of one motion: in " + std::to_string(off.frames) + " of " +
          Counted(static_cast<long long>(frames), "frame") + " the bone that ends at '" + joint + "' is up to " +
          Digits(off.most) + " degrees off where the rotations turn it (" +
          (off.of_rest ? "from its rest, limit " + Digits(kMostOffRest) : "limit " + Digits(kMostOffOwn)) +
          "): rotations of another clip, of other frames or of the other side, or joints that are mirrored; copy the "
          "file again, or read its joints alone");
  finding.severity = Severity::kWarning;  // a set may publish joints and rotations of two fits
  return finding;
}

}  // namespace

std::optional<Finding> CheckPosedJoints(const HumanAct12Clip& clip) {
  const Expected<SkeletonPtr> skeleton = LoadSkeleton("smpl24");
  if (!skeleton || clip.frames < kFewestTurned) return std::nullopt;
  const auto columns = SmplColumns(**skeleton, kSmplJoints);
  const auto local = SmplLocalRotations(**skeleton, {clip.poses, clip.frames}, Quaterniond::Identity());
  if (!columns || !local) return std::nullopt;
  const auto bones = BonesTurnedBack(clip, **skeleton, *columns, *local);
  double longest = 0.0;
  for (const auto& bone : bones) longest = std::max(longest, MeanLength(bone));
  BoneOff worst;
  std::string joint;
  for (std::size_t j = 0; j < bones.size(); ++j) {
    if (bones[j].empty() || MeanLength(bones[j]) < kLongBone * longest) continue;
    const BoneOff off = Off(bones[j], (*skeleton)->joints[j].rest_offset);
    if (static_cast<double>(off.frames) < kFewestOff * static_cast<double>(clip.frames) || off.most <= worst.most)
      continue;
    worst = off;
    joint = (*skeleton)->joints[j].name;
  }
  if (worst.frames == 0) return std::nullopt;
  return PoseContradiction(joint, worst, clip.frames);
}

std::optional<Finding> CheckGivenRotations(const HumanAct12Clip& clip) {
  std::optional<Finding> doubt = CheckAngleUnits(clip);
  if (!doubt) doubt = CheckFrozenPoses(clip);
  return doubt ? doubt : CheckPosedJoints(clip);
}

}  // namespace mocurate
