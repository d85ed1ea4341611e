#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "ingest/checks/joint_order_checks.h"
#include "ingest/inspect/comparison.h"
#include "ingest/inspect/raw_clip.h"

namespace mocurate {
namespace {

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

}  // namespace

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

}  // namespace mocurate
