#include "fitting/evidence/implausible_body.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/median.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/geometry/rotation.h"
#include "core/quality/tracked_points.h"
#include "fitting/association/body_shape.h"
#include "fitting/proportions.h"
#include "fitting/terms/huber.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestBodyFrames = 20;  ///< frames that observe a bone, at least

// Limits exceed what the recorded sets show; their largest value is in brackets. Source: 1,213 recorded clips
// (docs/fitting.md)
constexpr double kExchanged = 0.1;        ///< m by which the upper bone of a limb differs, median (0.08)
constexpr double kExchangeRatio = 3.0;    ///< ratio to the difference with the lower joint in the upper's place (2.5)
constexpr double kOffProportion = 0.47;   ///< log ratio, absolute, of upper to lower bone against rest (0.3)
constexpr double kMisplaced = 0.15;       ///< m by which a bone differs from the other side's (0.12)
constexpr double kMisplacedOfBone = 0.5;  ///< share of the bone, likewise
constexpr double kGrowth = 0.05;       ///< of the size, from the first fifth to the last (0.25 for a person who bends)
constexpr double kGrowingBones = 0.9;  ///< share of the bones that grow or shrink alike in every fifth (0.86)
constexpr double kGrowthDeviation = 0.35;  ///< ratio of the deviation of the bones' growth to the growth (0.43)

constexpr int kParts = 5;                       ///< parts of a clip whose sizes are compared (numerical)
constexpr std::size_t kFewestUnexplained = 10;  ///< frames that observe a joint, at least
/// m from the fit to the track, median of a joint. Source: 1,213 recorded clips (docs/fitting.md)
constexpr double kUnexplained = 0.2;
constexpr double kFarBeyondLimits = 0.35;  ///< rad, about 20 degrees. Source: 1,213 recorded clips (docs/fitting.md)
constexpr double kTallestBody = 2.1;       ///< metres from ankle or toes to the head's joint
constexpr double kSmallestBody = 0.4;      ///< m, likewise: newborn
constexpr double kChild = 0.8;             ///< of the rest skeleton: sizes below are no adult's

bool IsOfPeople(double stature) { return stature <= kTallestBody && stature >= kSmallestBody; }

std::string WordsOfSize(double stature, double scale) {
  return RoundedText(stature, 3) + " m tall from lowest to highest joint, " + RoundedText(scale, 3) +
         " times the skeleton's: people have " + RoundedText(kSmallestBody, 2) + " to " + RoundedText(kTallestBody, 2) +
         " m";
}

struct Bone {
  int joint = 0;
  int parent = 0;              ///< nearest observed joint above
  double rest = 0.0;           ///< metres, of the skeleton
  std::vector<double> length;  ///< of the frames that show both ends
  std::vector<double> time_s;
  double median = 0.0;
};

double RobustDeviation(std::vector<double> values) {
  const double centre = MeanMedian(values);
  for (double& value : values) value = std::abs(value - centre);
  return kMadToSigma * MeanMedian(values);
}

/// Median absolute difference of lengths from one.
double DepartureFrom(double length, const std::vector<double>& lengths) {
  std::vector<double> departures;
  for (const double seen : lengths) departures.push_back(std::abs(seen - length));
  return MeanMedian(std::move(departures));
}

/// Bone between two joints.
Bone BoneBetween(const SkeletonTracks& tracks, int joint, int parent) {
  Bone bone;
  bone.joint = joint;
  bone.parent = parent;
  for (int f = 0; f < tracks.frames(); ++f) {
    if (!tracks.seen(f, joint) || !tracks.seen(f, parent)) continue;
    bone.length.push_back((tracks.positions.at(f, joint) - tracks.positions.at(f, parent)).norm());
    bone.time_s.push_back(tracks.time_s[static_cast<std::size_t>(f)]);
  }
  bone.median = MeanMedian(bone.length);
  return bone;
}

class BodyJudge {
 public:
  explicit BodyJudge(const SkeletonTracks& tracks) : tracks_(tracks), shown_(tracks.JointObservations()) {
    const Skeleton& skeleton = *tracks.skeleton;
    std::vector<Vector3d> rest(skeleton.joints.size(), Vector3d::Zero());
    for (int j = 1; j < skeleton.joint_count(); ++j) {
      rest[j] = rest[skeleton.joints[j].parent] + skeleton.joints[j].rest_offset;
      int above = skeleton.joints[j].parent;
      while (above >= 0 && !shown_[above]) above = skeleton.joints[above].parent;
      if (above < 0 || !shown_[j]) continue;
      Bone bone = BoneBetween(tracks, j, above);
      bone.rest = (rest[j] - rest[above]).norm();
      if (bone.length.size() >= kFewestBodyFrames && bone.median > 0.0) bones_.push_back(std::move(bone));
    }
    rest_stature_ = Stature(skeleton, skeleton.RestBoneLengths());
    std::vector<double> ratios;
    for (const Bone& bone : bones_) {
      if (bone.rest >= kShortestKnownBone) ratios.push_back(bone.median / bone.rest);
    }
    scale_ = ratios.size() >= 3 ? MeanMedian(ratios) : 0.0;
  }

  std::vector<Finding> Findings() {
    JudgeExchanges();
    JudgeOrder();
    if (findings_.empty()) JudgePlaces();
    JudgeGrowth();
    JudgeSize();
    return std::move(findings_);
  }

 private:
  std::string Name(int joint) const { return tracks_.skeleton->joints[static_cast<std::size_t>(joint)].name; }

  void Report(const char* code, Severity severity, int joint, double value, std::string message) {
    findings_.push_back(MakeFinding(code, severity, value, std::move(message)));
    if (joint >= 0) findings_.back().joint = Name(joint);
  }

  /// For a limb whose bones have implausible proportions as named, and plausible ones with its two joints exchanged:
  /// length of the upper bone as named and exchanged, metres. An upper bone to the lower joint changes length as the
  /// limb bends.
  std::optional<std::pair<double, double>> OutOfOrder(const Bone& upper, const Bone& lower) const {
    const Bone across = BoneBetween(tracks_, lower.joint, upper.parent);
    if (across.length.size() < kFewestBodyFrames || !(lower.median > 0.0) || !(across.median > 0.0))
      return std::nullopt;
    const double named = std::log(upper.median / lower.median * lower.rest / upper.rest);
    const double exchanged = std::log(across.median / lower.median * lower.rest / upper.rest);
    if (named < kOffProportion || std::abs(exchanged) > 0.5 * named) return std::nullopt;
    if (RobustDeviation(across.length) >= RobustDeviation(upper.length)) return std::nullopt;
    return std::make_pair(upper.median, across.median);
  }

  /// The bone above a limb's lower bone; null where one of the two is short.
  const Bone* UpperOf(const Bone& lower) const {
    const auto upper =
        std::find_if(bones_.begin(), bones_.end(), [&](const Bone& bone) { return bone.joint == lower.parent; });
    return upper == bones_.end() || lower.rest < kShortestKnownBone || upper->rest < kShortestKnownBone ? nullptr
                                                                                                        : &*upper;
  }

  /// Exchange on both sides alike, as from a list of joints in the wrong order.
  void JudgeOrder() {
    for (const Bone& lower : bones_) {
      const Bone* upper = UpperOf(lower);
      if (upper == nullptr) continue;
      const Bone* other_upper = Mirrored(*upper);
      const Bone* other_lower = Mirrored(lower);
      if (other_upper == nullptr || other_lower == nullptr || other_lower->joint < lower.joint) continue;
      const auto here = OutOfOrder(*upper, lower);
      if (!here || !OutOfOrder(*other_upper, *other_lower)) continue;
      Report("joints_exchanged", Severity::kError, upper->joint, here->first,
             Name(upper->joint) + " and " + Name(lower.joint) + " are exchanged on both sides: the upper bone from " +
                 Name(upper->parent) + " is " + RoundedText(here->first, 3) + " m and the lower one " +
                 RoundedText(lower.median, 3) + " m; with the two joints exchanged the upper bone is " +
                 RoundedText(here->second, 3) + " m; correct the order of the joints in the source");
    }
  }

  void JudgeExchanges() {
    for (const Bone& lower : bones_) {
      const Bone* upper = UpperOf(lower);
      if (upper == nullptr) continue;
      const Bone* other = Mirrored(*upper);
      const Bone across = BoneBetween(tracks_, lower.joint, upper->parent);
      if (other == nullptr || across.length.size() < kFewestBodyFrames) continue;
      const double named = DepartureFrom(other->median, upper->length);
      const double exchanged = DepartureFrom(other->median, across.length);
      if (named < kExchanged || named < kExchangeRatio * exchanged) continue;
      if (RobustDeviation(across.length) >= RobustDeviation(upper->length)) continue;  // the other side is exchanged
      Report("joints_exchanged", Severity::kError, upper->joint, named,
             Name(upper->joint) + " and " + Name(lower.joint) + " are exchanged: the bone from " + Name(upper->parent) +
                 " differs from the other side's by " + RoundedText(named, 3) +
                 " m in the median; with the two joints exchanged it differs by " + RoundedText(exchanged, 2) +
                 " m; correct the order of the joints in the source");
    }
  }

  const Bone* Mirrored(const Bone& bone) const {
    const auto& joints = tracks_.skeleton->joints;
    const int joint = joints[bone.joint].mirror, parent = joints[bone.parent].mirror;
    if (joint == bone.joint) return nullptr;
    const auto found = std::find_if(bones_.begin(), bones_.end(),
                                    [&](const Bone& other) { return other.joint == joint && other.parent == parent; });
    return found == bones_.end() ? nullptr : &*found;
  }

  /// Difference of a bone from its expected length, metres; 0: plausible. Of two sides that differ, the side further
  /// from the body's size is wrong; a bone on the midline is wrong where it is too long.
  double Departure(const Bone& bone) const {
    const double of_size = scale_ * bone.rest;
    const Bone* other = Mirrored(bone);
    if (other == nullptr) {
      const double longer = bone.median - of_size;
      return longer > std::max(kMisplaced, 2.0 * kMisplacedOfBone * of_size) ? longer : 0.0;
    }
    const double apart = std::abs(bone.median - other->median);
    if (apart <= std::max(kMisplaced, kMisplacedOfBone * std::min(bone.median, other->median))) return 0.0;
    return std::abs(bone.median - of_size) > std::abs(other->median - of_size) ? apart : 0.0;
  }

  /// Repeatedly, the joint with most implausible bones and no plausible one.
  void JudgePlaces() {
    if (scale_ <= 0.0) return;
    std::vector<double> off;
    for (const Bone& bone : bones_) off.push_back(Departure(bone));
    for (;;) {
      int worst = -1, most = 0;
      double far = 0.0;
      for (int j = 0; j < tracks_.joints(); ++j) {
        int wrong = 0, right = 0;
        double away = 0.0;
        for (std::size_t b = 0; b < bones_.size(); ++b) {
          if (bones_[b].joint != j && bones_[b].parent != j) continue;
          (off[b] > 0.0 ? wrong : right) += 1;
          away = std::max(away, off[b]);
        }
        if (right > 0 || wrong < most || (wrong == most && away <= far)) continue;
        worst = j;
        most = wrong;
        far = away;
      }
      if (most == 0) return;
      for (std::size_t b = 0; b < bones_.size(); ++b) {
        if (bones_[b].joint == worst || bones_[b].parent == worst) off[b] = 0.0;
      }
      Report("joint_misplaced", Severity::kError, worst, far,
             Name(worst) + " is misplaced throughout the clip: " +
                 (most > 1 ? "its bones differ" : "its bone differs") + " by up to " + RoundedText(far, 3) +
                 " m from the bone of the other side, or from the length that fits the body's size; check the joint's "
                 "name and offset in the source");
    }
  }

  void JudgeGrowth() {
    const double begin = tracks_.time_s.front(), length = tracks_.time_s.back() - begin;
    if (length <= 0.0) return;
    std::vector<std::vector<double>> part_sizes(kParts);
    int grow = 0, all = 0;
    for (const Bone& bone : bones_) {
      if (bone.rest < kShortestKnownBone) continue;
      std::vector<std::vector<double>> parts(kParts);
      for (std::size_t i = 0; i < bone.length.size(); ++i) {
        const auto part = static_cast<int>(kParts * (bone.time_s[i] - begin) / length);
        parts[static_cast<std::size_t>(std::min(part, kParts - 1))].push_back(bone.length[i] / bone.median);
      }
      if (std::any_of(parts.begin(), parts.end(),
                      [](const auto& part) { return part.size() < kFewestBodyFrames / kParts; }))
        continue;
      for (std::size_t p = 0; p < parts.size(); ++p) part_sizes[p].push_back(std::log(MeanMedian(parts[p])));
      grow += part_sizes.back().back() > part_sizes.front().back() ? 1 : 0;
      ++all;
    }
    if (all < 5) return;
    std::vector<double> size, growths;
    for (std::size_t b = 0; b < part_sizes.front().size(); ++b)
      growths.push_back(part_sizes.back()[b] - part_sizes.front()[b]);
    for (auto& part : part_sizes) size.push_back(MeanMedian(part));
    const double growth = size.back() - size.front();
    const double share = static_cast<double>(growth > 0.0 ? grow : all - grow) / all;
    bool steady = true;
    for (int p = 1; p < kParts; ++p) steady = steady && (size[p] - size[p - 1]) * growth > 0.0;
    const bool alike = RobustDeviation(growths) <= kGrowthDeviation * std::abs(growth);
    if (std::abs(growth) < kGrowth || share < kGrowingBones || !steady || !alike) return;
    const double percent = 100.0 * (std::exp(growth) - 1.0);
    Report("body_grows", Severity::kWarning, -1, percent,
           std::to_string(growth > 0.0 ? grow : all - grow) + " of " + Counted(all, "bone") +
               (growth > 0.0 ? " grow" : " shrink") + " steadily, by " + RoundedText(std::abs(percent), 3) +
               " % from the clip's first fifth to its last: the scale drifts; the fit uses one body with constant bone "
               "lengths");
  }

  void JudgeSize() {
    const double stature = scale_ * rest_stature_;
    if (scale_ <= 0.0 || IsOfPeople(stature)) return;
    Report("size_suspect", Severity::kWarning, -1, stature,
           "the body would be " + WordsOfSize(stature, scale_) + "; check the scale of the source");
  }

  const SkeletonTracks& tracks_;
  std::vector<bool> shown_;
  std::vector<Bone> bones_;
  double rest_stature_ = 0.0;
  double scale_ = 0.0;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> FindImplausibleBody(const SkeletonTracks& tracks) { return BodyJudge(tracks).Findings(); }

std::optional<Finding> CheckStature(double stature, double scale) {
  const bool of_people = IsOfPeople(stature);
  if (of_people && scale >= kChild) return {};
  return MakeFinding(
      "size_suspect", of_people ? Severity::kWarning : Severity::kError, stature,
      "the body fitted to the depth views is " + WordsOfSize(stature, scale) +
          (of_people
               ? ". If the person is an adult, a part of the body is probably never visible (behind a desk, outside "
                 "the images), and all joints are wrong: set fitting.point_clouds.height to the person's height"
               : ". Check for two people close together, for an object that hides or touches the person, and for a "
                 "wrong unit of depths or calibration. ingest.source.mask_files excludes other people"));
}

std::vector<Finding> FindUnexplainedJoints(const SkeletonTracks& tracks, const JointPositions& joints) {
  std::vector<Finding> findings;
  for (int j = 0; j < tracks.joints(); ++j) {
    std::vector<double> away;
    for (int f = 0; f < tracks.frames(); ++f) {
      if (!tracks.seen(f, j)) continue;
      const Vector3d off = joints.at(f, j) - tracks.positions.at(f, j);
      away.push_back(tracks.precision.empty() ? off.norm() : std::sqrt(off.dot(tracks.precision_at(f, j) * off)));
    }
    const std::size_t frames = away.size();
    const double median = MeanMedian(away);
    if (frames < kFewestUnexplained || median <= kUnexplained) continue;
    const std::string& name = tracks.skeleton->joints[static_cast<std::size_t>(j)].name;
    Finding finding =
        FrameFinding("joint_unexplained", 0, 0, name, median,
                     "'" + name + "' lies " + RoundedText(median, 3) + " m from its tracked position (median of " +
                         Counted(static_cast<long long>(frames), "frame") +
                         "): no pose of the body explains this joint together with the others. Set skeleton to the "
                         "tracker's own one in configs/skeletons");
    finding.severity = Severity::kError;
    findings.push_back(std::move(finding));
  }
  return findings;
}

std::vector<Finding> FindJointsBeyondLimits(const Motion& motion) {
  std::vector<Finding> findings;
  const int joints = motion.joint_count();
  for (int j = 0; j < joints; ++j) {
    const Joint& joint = motion.skeleton->joints[static_cast<std::size_t>(j)];
    if (!joint.limits) continue;
    std::vector<double> beyond;
    for (int f = 0; f < motion.frame_count(); ++f) {
      const std::size_t at =
          static_cast<std::size_t>(f) * static_cast<std::size_t>(joints) + static_cast<std::size_t>(j);
      if (!motion.state.empty() && motion.state[at] != JointState::kObserved) continue;
      const Vector3d turned = LogQuaternion(motion.rotation[at]);
      Vector3d excess;
      for (int i = 0; i < 3; ++i) excess[i] = BeyondLimit(turned[i], joint.limits->min[i], joint.limits->max[i]);
      beyond.push_back(excess.norm());
    }
    const std::size_t frames = beyond.size();
    const double median = MeanMedian(beyond);
    if (frames < kFewestUnexplained || median <= kFarBeyondLimits) continue;
    const double degrees = std::round(10.0 * kDegrees * median) / 10.0;
    findings.push_back(FrameFinding("joint_beyond_limits", 0, 0, joint.name, degrees,
                                    "'" + joint.name + "' is rotated " + RoundedText(degrees, 3) +
                                        " degrees beyond its limits (median of " +
                                        Counted(static_cast<long long>(frames), "frame") +
                                        "): its rotation and those of its neighbours are suspect. Check that the "
                                        "tracked points near it are joints of the skeleton"));
  }
  return findings;
}

}  // namespace mocurate
