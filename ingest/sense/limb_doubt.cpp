#include "ingest/sense/limb_doubt.h"

#include <algorithm>
#include <cmath>

#include "core/quality/tracked_points.h"
#include "ingest/sense/point_exchange.h"

namespace mocurate {
namespace {

// Log ratios of lengths of both sides, the worst of bones that end in the two points. Of 19,896 limbs in the 1,549
// recorded clips none is as far off as named and as near once exchanged, nor with 0.3 and 0.15 or 0.35 and 0.25.
constexpr double kFarOff = 0.35;
constexpr double kNearly = 0.15;

// Mean log ratio of the lengths of upper arms, forearms, thighs and shanks of both sides, where proportions are off by
// more than the other. Of the 1,217 recorded tables in a known order none has both (proportions off by 0.26 at 0.17, by
// 0.19 at 0.33); of 600 shuffled ones 97 pass for a known order by proportions and spread, 3 of them with less.
constexpr double kUnlikeSides = 0.2;
constexpr double kOffProportion = 0.24;

/// A bone of one side beside that of the other.
struct BonePair {
  ObservedBone own, other;
};

std::string OtherSide(const std::string& name) {
  for (const auto& [side, other] : {std::pair<std::string, std::string>{"left_", "right_"}, {"right_", "left_"}}) {
    if (name.rfind(side, 0) == 0) return other + name.substr(side.size());
  }
  return name;
}

int IndexOfName(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

/// What two points of a limb are like once they change their names.
struct Limb {
  const ObservedClip& clip;
  std::vector<BonePair> bones;  ///< that end in one of the two

  PointDistance Length(int a, int b) const { return DistanceBetween(clip.positions, clip.confidence, a, b); }

  struct Fit {
    double worst = 0.0;   ///< log ratio to the other side
    double spread = 0.0;  ///< mean
    double shape = 0.0;   ///< between the bones' log ratios to a rest pose: 0 of its proportions
  };
  Fit FitOf(int first, int second) const {
    const auto point = [&](int k) { return k == first ? second : k == second ? first : k; };
    Fit fit;
    std::vector<double> to_rest;
    for (const BonePair& bone : bones) {
      const PointDistance own = Length(point(bone.own.from), point(bone.own.to));
      const PointDistance other = Length(bone.other.from, bone.other.to);
      if (!(own.median > 0.0) || !(other.median > 0.0)) return {1e9, 1.0, 1e9};
      fit.worst = std::max(fit.worst, std::abs(std::log(own.median / other.median)));
      fit.spread += own.spread / static_cast<double>(bones.size());
      if (bone.own.rest_length > 0.0) to_rest.push_back(std::log(own.median / bone.own.rest_length));
    }
    if (to_rest.empty()) return fit;
    const auto [least, most] = std::minmax_element(to_rest.begin(), to_rest.end());
    fit.shape = *most - *least;
    return fit;
  }
};

/// Bones with an end in either point, of which both sides are there.
std::vector<BonePair> BonesAt(const ObservedClip& clip, const std::vector<ObservedBone>& bones, int first, int second) {
  std::vector<BonePair> pairs;
  for (const ObservedBone& bone : bones) {
    const auto ends = [&](int point) { return bone.from == point || bone.to == point; };
    if (!ends(first) && !ends(second)) continue;
    const auto other = [&](int point) {
      return IndexOfName(clip.names, OtherSide(clip.names[static_cast<std::size_t>(point)]));
    };
    const int from = other(bone.from), to = other(bone.to);
    if (from >= 0 && to >= 0) pairs.push_back({bone, {from, to, bone.rest_length}});
  }
  return pairs;
}

bool HasSide(const ObservedClip& clip, int point) {
  const std::string& name = clip.names[static_cast<std::size_t>(point)];
  return OtherSide(name) != name;
}

/// Points of one limb that hang on each other, or with one between them; the nearer to the trunk first.
std::vector<std::pair<int, int>> LimbPoints(const ObservedClip& clip, const std::vector<ObservedBone>& bones) {
  std::vector<std::pair<int, int>> points;
  for (const ObservedBone& bone : bones) {
    if (!HasSide(clip, bone.from) || !HasSide(clip, bone.to)) continue;
    points.emplace_back(bone.from, bone.to);
    for (const ObservedBone& next : bones) {
      if (next.from == bone.to) points.emplace_back(bone.from, next.to);
    }
  }
  return points;
}

std::string Percent(double log_ratio) { return Digits(100.0 * std::expm1(log_ratio)) + " %"; }

}  // namespace

std::optional<std::string> DoubtLimbs(const ObservedClip& clip, const std::vector<ObservedBone>& bones) {
  std::optional<std::string> told;
  double best = 0.0;
  for (const auto& [near, far] : LimbPoints(clip, bones)) {
    const Limb limb{clip, BonesAt(clip, bones, near, far)};
    if (limb.bones.size() < 2) continue;
    const Limb::Fit named = limb.FitOf(-1, -1), exchanged = limb.FitOf(near, far);
    if (named.worst < kFarOff || exchanged.worst > kNearly || exchanged.spread > named.spread) continue;
    // Two sides that differ are alike with either exchanged: the one that gains more of a body's proportions is wrong.
    const double gained = named.shape - exchanged.shape;
    if (told && gained <= best) continue;
    best = gained;
    const auto name = [&](int point) { return "'" + clip.names[static_cast<std::size_t>(point)] + "'"; };
    told = "with " + name(near) + " and " + name(far) +
           " exchanged bones of that limb are as long as the other side's, to " + Percent(exchanged.worst) +
           ", as they are named they differ by " + Percent(named.worst);
  }
  return told;
}

std::optional<std::string> DoubtSides(const ObservedClip& clip, const BodyScore& score) {
  if (score.proportion <= kOffProportion) return std::nullopt;
  constexpr std::pair<const char*, const char*> kLimbs[] = {
      {"shoulder", "elbow"}, {"elbow", "wrist"}, {"hip", "knee"}, {"knee", "ankle"}};
  double sum = 0.0;
  int limbs = 0;
  for (const auto& [upper, lower] : kLimbs) {
    const auto length = [&](const std::string& side) {
      const int from = IndexOfName(clip.names, side + upper), to = IndexOfName(clip.names, side + lower);
      return from < 0 || to < 0 ? 0.0 : DistanceBetween(clip.positions, clip.confidence, from, to).median;
    };
    const double left = length("left_"), right = length("right_");
    if (!(left > 0.0) || !(right > 0.0)) continue;
    sum += std::min(1.0, std::abs(std::log(left / right)));
    ++limbs;
  }
  if (limbs == 0 || sum <= kUnlikeSides * limbs) return std::nullopt;
  return "arms and legs would be longer on one side than on the other, by " + Percent(sum / limbs) + " on average";
}

}  // namespace mocurate
