#include "ingest/checks/pose_checks.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/quality/tracked_points.h"
#include "ingest/checks/angle_checks.h"
#include "ingest/sources/smpl_motion.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestFrames = 5;
constexpr std::size_t kMostSpans = 20;
constexpr std::size_t kFirstColumn = 3, kColumnsOfBody = 66;  // root, 21 joints of the body

// Joints and rotations of one fit agree to 1e-5 rad. Places of another fit of the same frame are some cm off: 5 cm at
// the end of a bone of 0.25 m are 11 degrees.
constexpr double kMostOffOwn = 20.0;
// Limbs of SMPL's bodies hang and spread at rest by some 10 degrees either way of the skeleton's.
constexpr double kMostOffRest = 45.0;
constexpr double kFewestOff = 0.1;  // of the frames
constexpr double kLongBone = 0.5;   // of the longest: thighs, shins, both bones of the arms; short ones turn by a cm
constexpr std::size_t kFewestTurned = 5;  // fewer have no direction of their own

class FrozenPoses {
 public:
  explicit FrozenPoses(const Amass& amass) : amass_(amass) {}

  bool SamePose(std::size_t f) const {
    const std::size_t last = std::min(kColumnsOfBody, amass_.pose_columns);
    return Same(amass_.poses, amass_.pose_columns, f, kFirstColumn, last);
  }
  bool SamePlace(std::size_t f) const { return Same(amass_.translation_m, 3, f, 0, 3); }
  bool AllZero(std::size_t f) const {
    const auto row = amass_.poses.begin() + static_cast<std::ptrdiff_t>(f * amass_.pose_columns);
    return std::all_of(row + kFirstColumn, row + std::min<std::ptrdiff_t>(kColumnsOfBody, amass_.pose_columns),
                       [](double value) { return value == 0.0; });
  }
  bool Damaged(std::size_t f) const {
    return std::binary_search(amass_.damaged.begin(), amass_.damaged.end(), static_cast<int>(f));
  }

 private:
  /// Columns [first, last) of frame f and of the one before.
  static bool Same(const std::vector<double>& values, std::size_t wide, std::size_t f, std::size_t first,
                   std::size_t last) {
    const auto row = values.begin() + static_cast<std::ptrdiff_t>(f * wide);
    const auto before = row - static_cast<std::ptrdiff_t>(wide);
    return std::equal(row + first, row + last, before + first);
  }

  const Amass& amass_;
};

/// `carried`: while the root goes on.
Finding FrozenPose(bool zero, bool carried, std::size_t begin, std::size_t end, std::size_t frames) {
  Finding finding =
      FrameFinding("frozen_pose", static_cast<int>(begin), static_cast<int>(end), "", static_cast<double>(end - begin),
                   (zero ? "all rotations of the body are 0 in " : "no joint of the body turns in ") +
                       Counted(static_cast<long long>(end - begin), "frame") + " on end (" + std::to_string(begin) +
                       "-" + std::to_string(end) + (carried ? "), while `trans` carries it on: " : "): ") +
                       (zero ? "the poses are not there" : "the poses are repeated or of another file") +
                       "; copy the file again, or leave these frames out");
  if (2 * (end - begin) >= frames) finding.severity = Severity::kError;
  return finding;
}

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

}  // namespace

std::vector<Finding> CheckFrozenPoses(const Amass& amass) {
  std::vector<Finding> findings;
  const FrozenPoses poses(amass);
  if (amass.pose_columns <= kFirstColumn) return findings;
  for (std::size_t begin = 0, f = 1; begin < amass.frames; begin = f, ++f) {
    std::size_t moved = 0;
    for (; f < amass.frames && poses.SamePose(f) && !poses.Damaged(f) && !poses.Damaged(f - 1); ++f)
      moved += poses.SamePlace(f) ? 0 : 1;
    const std::size_t held = f - begin;
    const bool zero = poses.AllZero(begin) && !poses.Damaged(begin), carried = held > 1 && 2 * moved >= held - 1;
    const bool blank = zero && held < amass.frames;
    if ((blank || (held >= kFewestFrames && carried)) && findings.size() < kMostSpans)
      findings.push_back(FrozenPose(zero, carried, begin, f, amass.frames));
  }
  return findings;
}

std::optional<Finding> CheckTranslations(const Amass& amass) {
  const FrozenPoses poses(amass);
  bool turns = false;
  for (std::size_t f = 1; f < amass.frames && !turns; ++f)
    turns = amass.pose_columns > kFirstColumn && !poses.SamePose(f);
  const auto zero = [](double value) { return value == 0.0; };
  if (!turns || amass.frames < kFewestFrames || !amass.damaged.empty() ||
      !std::all_of(amass.translation_m.begin(), amass.translation_m.end(), zero))
    return std::nullopt;
  const int frames = static_cast<int>(amass.frames);
  return FrameFinding("path_missing", 0, frames, "", frames,
                      "`trans` is 0 0 0 in every one of " + Counted(frames, "frame") +
                          ", while the body turns: the file does not say where the body goes; copy the file again, or "
                          "use its rotations alone");
}

std::optional<Finding> CheckMarkers(const Amass& amass, const JointPositions& posed) {
  constexpr int kFrames = 50;  // looked at, all over the clip
  std::vector<double> ratios;
  const int step = std::max(1, posed.frames / kFrames);
  JointPositions markers(static_cast<int>(amass.frames), static_cast<int>(amass.markers));
  markers.xyz = amass.marker_data_m;
  const std::vector<double> seen(amass.marker_observed.begin(), amass.marker_observed.end()), all, times;
  const TrackedPoints of_markers{markers, seen, times}, of_body{posed, all, times};
  for (int f = 0; f < std::min(posed.frames, markers.frames); f += step) {
    const auto extent = of_markers.Extent(f, 3), body = of_body.Extent(f, 3);
    if (extent && body && *extent > 0.0 && *body > 0.0) ratios.push_back(*extent / *body);
  }
  if (ratios.empty()) return std::nullopt;
  const double ratio = Median(std::move(ratios)), factor = std::pow(10.0, std::round(std::log10(ratio)));
  if (factor == 1.0) return std::nullopt;
  const char* unit = factor == 1000.0 ? " (millimetres)" : factor == 100.0 ? " (centimetres)" : "";
  return MakeFinding("units_contradiction", Severity::kError, ratio,
                     "`marker_data` is " + Digits(ratio) +
                         " times as large as the body that `poses` and `trans` give: AMASS has metres, "
                         "these numbers are to be divided by " +
                         FormatDouble(factor) + unit + "; the body is looked at without them");
}

std::optional<Finding> CheckGivenRotations(const HumanAct12Clip& clip) {
  std::optional<Finding> doubt = CheckAngleUnits(clip);
  if (!doubt) doubt = CheckFrozenPoses(clip);
  return doubt ? doubt : CheckPosedJoints(clip);
}

}  // namespace mocurate
