#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/motion/limbs.h"
#include "core/motion/skeleton.h"
#include "core/quality/tracked_points.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/joint_orders.h"
#include "ingest/inspect/raw_clip.h"

namespace mocurate {
namespace {

constexpr int kMinGuessedFrames = 8;          // fewer tell no spread of lengths
constexpr double kHeadBelow = -0.2;           // cosine of trunk and head
constexpr double kMuchBetterExchanged = 0.6;  // of the score, with two points exchanged
constexpr double kClearlyBetter =
    0.06;  // that it falls by; of recorded clips (KARD, Florence3D, MSR, UTKinect) by 0.055 at most, to 0.7

/// Median cosine between the directions from hips to shoulders and from shoulders to head; nothing where the points are
/// not there or seen together in too few frames.
std::optional<double> HeadOverShoulders(const RawClip& clip) {
  const BodyLandmarks& p = clip.points;
  const int wanted[] = {p.head, p.hip[0], p.hip[1], p.shoulder[0], p.shoulder[1]};
  if (std::any_of(std::begin(wanted), std::end(wanted), [](int point) { return point < 0; })) return std::nullopt;
  std::vector<double> cosines;
  for (int f = 0; f < clip.positions.frames; ++f) {
    const auto seen = [&](int point) {
      const std::size_t at = static_cast<std::size_t>(f) * static_cast<std::size_t>(clip.positions.joints) +
                             static_cast<std::size_t>(point);
      return clip.confidence.empty() || clip.confidence[at] > 0.0;
    };
    if (!std::all_of(std::begin(wanted), std::end(wanted), seen)) continue;
    const auto at = [&](int point) { return Vector3d(clip.positions.at(f, point)); };
    const Vector3d shoulders = 0.5 * (at(p.shoulder[0]) + at(p.shoulder[1]));
    const Vector3d trunk = shoulders - 0.5 * (at(p.hip[0]) + at(p.hip[1])), head = at(p.head) - shoulders;
    if (trunk.norm() > 0.0 && head.norm() > 0.0) cosines.push_back(trunk.dot(head) / (trunk.norm() * head.norm()));
  }
  if (static_cast<int>(cosines.size()) < kMinGuessedFrames) return std::nullopt;
  return Median(cosines);
}

std::string TenthsOfPercent(double share) { return FormatDouble(std::round(1000.0 * share) / 10.0) + " %"; }

/// What a clip shows against the names of its points, with `score` of `bones` in that order: the head lies on the hips'
/// side of the shoulders, or two points that change their names make a much better body. Nothing of fewer than 8
/// frames.
std::optional<std::string> CheckJointOrder(const RawClip& clip, const BodyScore& score,
                                           const std::vector<RawBone>& bones) {
  if (clip.frames < kMinGuessedFrames) return std::nullopt;
  if (const auto head = HeadOverShoulders(clip); head && *head < kHeadBelow) {
    return "the head would lie below the shoulders, on the side of the hips (cosine " + Digits(*head) +
           " in the median frame)";
  }
  const std::optional<PointExchange> exchange = BestExchange(clip.positions, clip.confidence, bones);
  if (!exchange) return std::nullopt;
  const double total = exchange->score.total();
  if (total > kMuchBetterExchanged * score.total() || total > score.total() - kClearlyBetter) return std::nullopt;
  const auto name = [&](int point) { return "'" + clip.names[static_cast<std::size_t>(point)] + "'"; };
  return "with " + name(exchange->first) + " and " + name(exchange->second) +
         " exchanged bones change their length by " + TenthsOfPercent(exchange->score.spread) +
         " and proportions are off by " + TenthsOfPercent(exchange->score.proportion) + ", as they are named by " +
         TenthsOfPercent(score.spread) + " and " + TenthsOfPercent(score.proportion);
}

constexpr int kFewestNamedFrames = 8;  // fewer tell no spread of lengths

/// Points by the names of a skeleton.
BodyLandmarks PointsByName(const std::vector<std::string>& names, const Skeleton& skeleton) {
  return FindHandednessPoints([&](std::string_view name) -> std::optional<int> {
    const auto joint = skeleton.FindJoint(name);
    for (std::size_t k = 0; joint && k < names.size(); ++k) {
      if (skeleton.FindJoint(names[k]) == joint) return static_cast<int>(k);
    }
    return std::nullopt;
  });
}

std::string ThreeDecimals(double value) { return FormatDouble(std::round(value * 1000.0) / 1000.0); }

std::string Words(const OrderScore& score) {
  return "order '" + score.order->name + "': bones change their length by " +
         ThreeDecimals(100.0 * score.score.spread) + " %, proportions are off by " +
         ThreeDecimals(100.0 * score.score.proportion) + " %";
}

/// Names the points in that order; says what they contradict.
std::optional<std::string> NameInOrder(const OrderScore& order, RawClip& clip) {
  const Skeleton& skeleton = **KnownSkeleton(order.order->skeleton);
  clip.names = order.order->joints;
  clip.points = PointsByName(clip.names, skeleton);
  return CheckJointOrder(clip, order.score, BonesOf(clip.names, skeleton));
}

/// The points of a tree with undeclared names: knees, elbows and head by name, their neighbours by the tree,
/// as exporters agree on the former only. Sides by "left" and "right" or a lone L and R ("LeftLeg", "lShin", "Hand_R").
BodyLandmarks PointsOfTree(const std::vector<std::string>& whole_names, const std::vector<int>& parents) {
  const std::vector<std::string> names = WithoutNamespace(whole_names);
  Skeleton tree;
  BodyLandmarks points;
  for (std::size_t j = 0; j < names.size(); ++j) {
    Joint joint;
    joint.name = names[j];
    joint.parent = parents[j];
    tree.joints.push_back(joint);
    const bool head = names[j].find("head") != std::string::npos || names[j].find("Head") != std::string::npos;
    if (points.head < 0 && head) points.head = static_cast<int>(j);
  }
  const Limbs limbs = LimbsOf(tree);
  for (std::size_t side = 0; side < 2; ++side) {
    const Limb& leg = limbs.leg[side];
    points.knee[side] = leg.middle;
    points.hip[side] = leg.root;
    points.ankle[side] = leg.end;
    points.toe[side] = leg.tip;
    points.shoulder[side] = limbs.arm[side].root;
    points.wrist[side] = limbs.arm[side].end;
  }
  return points;
}

}  // namespace

void RawClip::TakePoints(int count, const std::vector<double>& xyz) {
  frames = count;
  positions = JointPositions(frames, joints);
  confidence.assign(xyz.size() / 3, 0.0);
  zeros.assign(confidence.size(), 0);
  for (std::size_t at = 0; at < confidence.size(); ++at) {
    const Eigen::Map<const Vector3d> point(&xyz[3 * at]);
    zeros[at] = point.isZero(0.0) ? 1 : 0;
    if (!point.allFinite() || point.isZero(0.0)) continue;
    std::copy_n(point.data(), 3, &positions.xyz[3 * at]);
    confidence[at] = 1.0;
  }
}

void RawClip::CutDamagedEnds() {
  std::vector<char> damaged(static_cast<std::size_t>(frames), 0);
  for (const Finding& remark : remarks) {
    const auto end = damaged.begin() + std::clamp(remark.frame_end, 0, frames);
    if (remark.severity != Severity::kInfo && remark.action == FindingAction::kDropped)
      std::fill(damaged.begin() + std::clamp(remark.frame_begin, 0, frames), end, 1);
  }
  const auto first = std::find(damaged.begin(), damaged.end(), 0),
             last = std::find(damaged.rbegin(), damaged.rend(), 0).base();
  if (first == damaged.end() || last - first == frames) return;
  const auto begin = first - damaged.begin(), end = last - damaged.begin();
  const auto keep = [&](auto& values) {
    const auto each = static_cast<std::ptrdiff_t>(values.size()) / frames;
    if (!values.empty()) values = {values.begin() + each * begin, values.begin() + each * end};
  };
  keep(positions.xyz);
  keep(confidence);
  keep(zeros);
  for (Finding& remark : remarks) {
    remark.frame_begin = std::max(0, remark.frame_begin - static_cast<int>(begin));
    remark.frame_end = std::max(remark.frame_begin, remark.frame_end - static_cast<int>(begin));
  }
  frames = static_cast<int>(end - begin);
  if (!positions.empty()) positions.frames = frames;
}

bool RecogniseOrder(RawClip& clip) {
  if (clip.frames < 2) {
    clip.skeleton.evidence =
        Counted(clip.frames, "frame") + " tells no order of joints: whether bones keep their length shows in two";
    return false;
  }
  const auto zero = [](double value) { return value == 0.0; };
  if (std::all_of(clip.positions.xyz.begin(), clip.positions.xyz.end(), zero)) {
    clip.skeleton.evidence = "every number is zero";
    return false;
  }
  const std::vector<OrderScore> scores = ScoreOrders(clip.positions, clip.confidence);
  if (scores.empty() || !scores[0].score.IsBody()) {
    clip.skeleton.evidence = scores.empty() ? "no known order has " + std::to_string(clip.joints) + " joints"
                                            : "the best of the known orders does not fit; " + Words(scores[0]);
    return false;
  }
  std::size_t chosen = 0;
  std::string doubt;
  for (; chosen < scores.size() && scores[chosen].score.IsBody(); ++chosen) {
    const std::optional<std::string> contradicted = NameInOrder(scores[chosen], clip);
    if (!contradicted) break;
    if (doubt.empty()) doubt = *contradicted;
  }
  if (chosen == scores.size() || !scores[chosen].score.IsBody()) {
    clip.skeleton.evidence = "the best of the known orders does not fit: " + doubt + "; " + Words(scores[0]);
    clip.names.clear();
    clip.points = {};
    return false;
  }
  const OrderScore& best = scores[chosen];
  clip.set_rate_hz = best.order->set_rate_hz;
  clip.set_evidence = best.order->set_evidence;
  clip.skeleton.value = best.order->label.empty() ? best.order->skeleton : best.order->label;
  clip.skeleton.from = Provenance::kMeasured;
  clip.skeleton.evidence = Words(best);
  clip.skeleton.confidence = 1.0 - best.score.total() / BodyScore::kBodyLike;
  if (chosen + 1 < scores.size()) {
    const OrderScore& next = scores[chosen + 1];
    const double margin = 1.0 - best.score.total() / std::max(1e-9, next.score.total());
    clip.skeleton.confidence = std::min(1.0, std::max(clip.skeleton.confidence, 0.0) * 0.5 + margin * 0.5);
    clip.skeleton.evidence += "; next is " + Words(next);
  }
  for (int side = 0; side < 2; ++side) {
    const auto toe = std::find(clip.names.begin(), clip.names.end(), side == 0 ? "left_big_toe" : "right_big_toe");
    if (toe != clip.names.end()) clip.points.toe[side] = static_cast<int>(toe - clip.names.begin());
  }
  return true;
}

void CheckPositions(RawClip& clip) {
  const auto zero = [](double value) { return value == 0.0; };
  const bool nothing = std::all_of(clip.positions.xyz.begin(), clip.positions.xyz.end(), zero);
  if (clip.frames < 2 || nothing) return;  // they show no bones, right or wrong
  const double rigidity = Rigidity(clip.positions, clip.confidence);
  const std::vector<OrderScore> scores = ScoreOrders(clip.positions, clip.confidence);
  if (rigidity > kRigid) {
    clip.remarks.push_back(MakeFinding("not_joint_positions", Severity::kError, rigidity,
                                       "no two points keep their distance (it changes by " +
                                           ThreeDecimals(100.0 * rigidity) +
                                           " % for the most rigid pairs): these numbers are no joint positions"));
  } else if (!scores.empty()) {
    clip.remarks.push_back(MakeFinding("not_joint_positions", Severity::kError, scores[0].score.proportion,
                                       "in no known order do the points make a body (" + Words(scores[0]) +
                                           "): rotations, or an order that is not known"));
  }
}

void CompareOrder(const SourceOptions& source, RawClip& clip) {
  clip.skeleton = AsDeclared(source.skeleton, "");
  const auto skeleton = KnownSkeleton(source.skeleton);
  if (!skeleton) return;
  const BodyScore score = ScoreBody(clip.positions, clip.confidence, BonesOf(clip.names, **skeleton));
  clip.skeleton.evidence = clip.frames < 2
                               ? "1 frame does not tell whether bones keep their length"
                               : "bones change their length by " + ThreeDecimals(100.0 * score.spread) +
                                     " %, proportions are off by " + ThreeDecimals(100.0 * score.proportion) + " %";
  const std::vector<OrderScore> scores = ScoreOrders(clip.positions, clip.confidence);
  const bool better = !scores.empty() && scores[0].score.IsBody() && scores[0].score.total() < 0.6 * score.total();
  std::string why = better && score.total() >= kPlausibleOrder ? Words(scores[0]) : "";
  if (const auto doubt = why.empty() ? CheckJointOrder(clip, score, BonesOf(clip.names, **skeleton)) : std::nullopt)
    why = *doubt;
  if (clip.frames < kFewestNamedFrames || why.empty()) return;
  clip.remarks.push_back(MakeFinding("joint_order_contradiction", Severity::kError, score.total(),
                                     "read in the declared order, " + clip.skeleton.evidence + " (" +
                                         RoundedText(score.total()) + ", the spread and half of that); " + why));
}

void FollowFormat(const std::string& skeleton, const std::vector<std::string>& joints, const std::string& evidence,
                  RawClip& clip) {
  clip.skeleton = AsDeclared(skeleton, evidence);
  clip.names = joints;
  if (const auto known = KnownSkeleton(skeleton)) clip.points = PointsByName(joints, **known);
}

BodyLandmarks PointsOfBody(const Skeleton& skeleton) {
  const BodyLandmarks known = FindHandednessPoints([&](std::string_view name) { return skeleton.FindJoint(name); });
  if (known.knee[0] >= 0 && known.knee[1] >= 0) return known;
  std::vector<std::string> names;
  std::vector<int> parents;
  for (const Joint& joint : skeleton.joints) {
    names.push_back(joint.name);
    parents.push_back(joint.parent);
  }
  return PointsOfTree(names, parents);
}

BodyLandmarks PointsOfBody(const std::vector<std::string>& names, const Skeleton* skeleton) {
  const auto find = [&](std::string_view name) -> std::optional<int> {
    const std::optional<int> joint = skeleton != nullptr ? skeleton->FindJoint(name) : std::nullopt;
    for (std::size_t k = 0; k < names.size(); ++k) {
      if (names[k] == name) return static_cast<int>(k);
      if (joint && skeleton->FindJoint(names[k]) == joint) return static_cast<int>(k);
    }
    return std::nullopt;
  };
  return FindHandednessPoints([&](std::string_view name) {
    const std::optional<int> point = find(name);
    return point || name != "head" ? point : find("nose");
  });
}

/// Whether every joint hangs from the same joint as its namesake.
bool HangsAlike(const std::vector<std::string>& names, const std::vector<int>& parents, const Skeleton& skeleton) {
  for (std::size_t j = 0; j < names.size(); ++j) {
    const int above = skeleton.joints[static_cast<std::size_t>(*skeleton.FindJoint(names[j]))].parent;
    const int expected = parents[j] < 0 ? -1 : *skeleton.FindJoint(names[static_cast<std::size_t>(parents[j])]);
    if (above != expected) return false;
  }
  return true;
}

void FollowTree(const std::vector<int>& parents, const std::string& evidence, RawClip& clip) {
  clip.parents = parents;
  clip.points = PointsOfTree(clip.names, parents);
  clip.skeleton = AsDeclared("own tree of " + std::to_string(clip.joints) + " joints", evidence);
  for (const char* known : {"bandai22", "cmu31", "smpl24"}) {
    const auto skeleton = KnownSkeleton(known);
    if (!skeleton || (*skeleton)->joint_count() != clip.joints) continue;
    const std::vector<std::string> names = NamesIn(**skeleton, clip.names);
    const bool same = std::all_of(names.begin(), names.end(),
                                  [&](const std::string& joint) { return (*skeleton)->FindJoint(joint).has_value(); });
    if (!same) continue;
    if (HangsAlike(names, parents, **skeleton)) {
      clip.skeleton.value = known;
    } else {
      clip.skeleton.evidence = evidence + ": joints named as in '" + known + "', some hang from others than there";
    }
    if (clip.points.knee[0] < 0) FollowFormat(known, names, evidence, clip);
  }
}

}  // namespace mocurate
