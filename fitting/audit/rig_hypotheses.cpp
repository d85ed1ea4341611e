#include "fitting/audit/rig_hypotheses.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/motion/clip.h"
#include "fitting/association/body_shape.h"
#include "fitting/association/propose.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/audit/view_sides.h"

namespace mocurate {
namespace {

constexpr std::size_t kMomentsCompared = 24;  ///< moments, evenly spread over the take (numerical)
constexpr double kFarOff = 0.1;  ///< of a person's extent: distance from the rays at which an entry has the full cost

/// A view's frames nearest to the moments.
KeypointView FramesAt(const KeypointView& view, const std::vector<double>& moments, int keypoints) {
  KeypointView some;
  some.camera = view.camera;
  some.people = view.people;
  const std::size_t numbers = static_cast<std::size_t>(view.people) * static_cast<std::size_t>(keypoints) * 3;
  for (const double moment : moments) {
    const auto next = std::lower_bound(view.time_s.begin(), view.time_s.end(), moment);
    auto at = static_cast<std::size_t>(next - view.time_s.begin());
    if (at == view.time_s.size() || (at > 0 && moment - view.time_s[at - 1] < view.time_s[at] - moment)) --at;
    some.time_s.push_back(view.time_s[at]);
    const auto first = view.values.begin() + static_cast<std::ptrdiff_t>(at * numbers);
    some.values.insert(some.values.end(), first, first + static_cast<std::ptrdiff_t>(numbers));
  }
  return some;
}

/// Each view's frames nearest to at most 24 moments, evenly spaced over the first view's. Empty when a view has no
/// frames.
std::vector<KeypointView> AtSomeMoments(const std::vector<KeypointView>& views, int keypoints) {
  const std::vector<double>& time = views[0].time_s;
  const std::size_t count = std::min(kMomentsCompared, time.size());
  std::vector<double> moments;
  for (std::size_t i = 0; i < count; ++i) moments.push_back(time[i * time.size() / count]);
  std::vector<KeypointView> some;
  for (const KeypointView& view : views) {
    if (view.time_s.empty()) return {};
    some.push_back(FramesAt(view, moments, keypoints));
  }
  return some;
}

/// Mean cost of all entries of a frame, each 0 (on the rays of a body that other views propose) to 1 (of no body). Adds
/// to `share` the share of entries that match a body.
double CostOfAgreement(const std::vector<RigView>& rig, int frame, const std::vector<KnownLength>& lengths,
                       double& share) {
  std::vector<Sight> entries;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    for (int p = 0; p < rig[v].people; ++p) {
      if (rig[v].seen[rig[v].Entry(frame, p)] >= kLeastKeypoints) entries.push_back({static_cast<int>(v), frame, p});
    }
  }
  if (entries.empty()) return 0.0;
  double cost = static_cast<double>(entries.size());
  for (const std::vector<Sight>& sights : ProposePeople(rig, entries, lengths, 0.0)) {
    if (sights.size() < 3 && rig.size() > 3) continue;  // two views agree on a person by chance
    const BodyPoints body = NearestBody(rig, sights);
    for (const Sight& sight : sights) {
      const double off =
          EntryDistance(rig[static_cast<std::size_t>(sight.view)], sight.frame, sight.person, body, kLeastKeypoints) /
          body.extent;
      cost -= std::max(0.0, 1.0 - off / kFarOff);
      share += 1.0 / static_cast<double>(entries.size());
    }
  }
  return cost / static_cast<double>(entries.size());
}

/// Cost of an entry up to which no hypothesis is tested. For synthetic people (4 px of noise) it is 0.04 to 0.07 with
/// rings and PHSPD's cameras, 0.11 with Human3.6M's more distant ones. In a ring of four with two opposite cameras
/// exchanged it is 0.11 to 0.13, and 0.06 after correction. Source: synthetic people before rings, PHSPD's and
/// Human3.6M's cameras
constexpr double kAgreeing = 0.04;
constexpr double kBetterHypothesis = 0.7;  ///< of the cost as given, for exchanged files and for images that are all
                                           ///< mirrored
constexpr double kViewsDisagree = 0.08;    ///< cost from which single views and other image sizes are tested
constexpr double kMuchBetterHypothesis = 0.45;  ///< of the cost, for these
/// Share of a view's entries that must match a body when mirrored, where the remaining cost is of people that no other
/// view observes. It is 0.50 to 0.72 for each camera of the Pose2Sim trials, whose bystanders cost 0.36 to 0.43. There
/// no other hypothesis gains a tenth of the cost; none does for the trials as given. Source: Pose2Sim trials
constexpr double kMirrorGain = 0.4;
/// Ratio of two costs that count as equal.
constexpr double kEqualCostRatio = 1.15;
/// Cost; or with this difference.
constexpr double kEqualCostDifference = 1e-3;
/// Factor between the image size of the keypoints and the calibration's, each tested (numerical).
constexpr std::array<double, 8> kUnitFactors = {0.25, 1.0 / 3.0, 0.5, 2.0 / 3.0, 1.5, 2.0, 3.0, 4.0};

/// Adds hypotheses for one view or for all: mirrored, with and without exchanged sides, and other image sizes; for one
/// view also exchanged sides alone.
void AddViewChanges(const std::vector<std::size_t>& views, std::size_t all, std::vector<RigHypothesis>& hypotheses) {
  RigHypothesis hypothesis = RigHypothesis::AsGiven(all);
  hypothesis.views = views;
  for (const auto& [mirrored, sides] : {std::pair(true, false), std::pair(true, true), std::pair(false, true)}) {
    if (!mirrored && views.size() == all) continue;  // sides exchanged in all views have no effect on agreement
    hypotheses.push_back(hypothesis);
    hypotheses.back().mirrored = mirrored;
    hypotheses.back().sides = sides;
  }
  for (const double factor : kUnitFactors) {
    hypotheses.push_back(hypothesis);
    hypotheses.back().factor = factor;
  }
}

std::vector<RigHypothesis> AllHypotheses(std::size_t views) {
  RigHypothesis exchange;
  std::vector<RigHypothesis> hypotheses;
  for (std::vector<std::size_t>& source : FileExchanges(views)) {
    exchange.source = std::move(source);
    hypotheses.push_back(exchange);
  }
  for (std::size_t v = 0; v < views; ++v) AddViewChanges({v}, views, hypotheses);
  AddViewChanges(RigHypothesis::AsGiven(views).source, views, hypotheses);
  return hypotheses;
}

/// A camera's detections under a hypothesis.
KeypointView TransformView(KeypointView view, const std::vector<std::size_t>& other_side,
                           const RigHypothesis& hypothesis) {
  const std::vector<double> given = view.values;
  for (std::size_t i = 0; i < given.size() / 3; ++i) {
    const std::size_t k = i % other_side.size();
    const double* from = given.data() + 3 * (hypothesis.sides ? i - k + other_side[k] : i);
    double* to = view.values.data() + 3 * i;
    std::copy(from, from + 3, to);
    if (to[2] <= 0.0) continue;
    to[0] *= hypothesis.factor;
    to[1] *= hypothesis.factor;
    if (hypothesis.mirrored) to[0] = view.camera.width - to[0];
  }
  return view;
}

KeypointView ViewUnder(const std::vector<KeypointView>& views, std::size_t v,
                       const std::vector<std::size_t>& other_side, const RigHypothesis& hypothesis) {
  KeypointView view = views[hypothesis.source[v]];
  view.camera = views[v].camera;
  if (!hypothesis.ChangesView(v)) return view;
  return TransformView(std::move(view), other_side, hypothesis);
}

struct ScoredHypothesis {
  RigHypothesis hypothesis;
  std::vector<double> costs;  ///< of the moments
  double mean = 0.0;
  double share = 0.0;
};

/// Files exchanged, or all images mirrored: the views agree, but the rig in the world differs.
bool IsOfRig(const RigHypothesis& hypothesis, std::size_t views) {
  return hypothesis.ExchangesFiles() || (hypothesis.mirrored && hypothesis.views.size() == views);
}

bool IsMuchBetter(const ScoredHypothesis& scored, const ScoredHypothesis& given) {
  const RigHypothesis& hypothesis = scored.hypothesis;
  const auto views = static_cast<double>(hypothesis.source.size());
  const bool mirrored = hypothesis.mirrored && hypothesis.views.size() == 1;
  if (mirrored && views * (given.mean - scored.mean) > kMirrorGain) return true;
  return scored.mean <
         (IsOfRig(hypothesis, hypothesis.source.size()) ? kBetterHypothesis : kMuchBetterHypothesis) * given.mean;
}

/// Scores one hypothesis after another. Views that several hypotheses share are computed once.
class HypothesisScorer {
 public:
  HypothesisScorer(const std::vector<KeypointView>& some, const std::vector<std::string>& names,
                   const std::vector<KnownLength>& lengths, double min_confidence)
      : some_(some), other_side_(OtherSides(names)), lengths_(lengths), min_confidence_(min_confidence) {}

  ScoredHypothesis operator()(const RigHypothesis& hypothesis) { return Score(hypothesis, nullptr); }

  /// IsMuchBetter for the whole score. Costs only grow from moment to moment, so most hypotheses stop after one or two.
  bool MuchBetter(const RigHypothesis& hypothesis, const ScoredHypothesis& given) {
    return IsMuchBetter(Score(hypothesis, &given), given);
  }

 private:
  using Key = std::tuple<std::size_t, std::size_t, bool, bool, double>;

  /// Scores all moments, or stops as soon as the score is not much better than `unless_better`, if given.
  ScoredHypothesis Score(const RigHypothesis& hypothesis, const ScoredHypothesis* unless_better) {
    ScoredHypothesis scored{hypothesis, {}, 0.0, 0.0};
    std::vector<RigView> rig;
    for (std::size_t v = 0; v < some_.size(); ++v) rig.push_back(At(v, hypothesis));
    const std::size_t moments = some_[0].time_s.size();
    for (std::size_t m = 0; m < moments; ++m) {
      scored.costs.push_back(CostOfAgreement(rig, static_cast<int>(m), lengths_, scored.share));
      scored.mean += scored.costs.back() / static_cast<double>(moments);
      if (unless_better != nullptr && !IsMuchBetter(scored, *unless_better)) return scored;
    }
    scored.share /= static_cast<double>(moments);
    return scored;
  }

  const RigView& At(std::size_t v, const RigHypothesis& hypothesis) {
    const bool changed = hypothesis.ChangesView(v);
    const Key key(v, hypothesis.source[v], changed && hypothesis.mirrored, changed && hypothesis.sides,
                  changed ? hypothesis.factor : 1.0);
    const auto made = made_.find(key);
    if (made != made_.end()) return made->second;
    const RigView view(ViewUnder(some_, v, other_side_, hypothesis), static_cast<int>(other_side_.size()),
                       min_confidence_);
    return made_.emplace(key, view).first->second;
  }

  const std::vector<KeypointView>& some_;
  std::vector<std::size_t> other_side_;
  const std::vector<KnownLength>& lengths_;
  double min_confidence_;
  std::map<Key, RigView> made_;
};

/// Number of changed views or exchanged files; all images mirrored count like two exchanged files.
std::size_t Changes(const RigHypothesis& hypothesis) {
  return hypothesis.ExchangesFiles() ? hypothesis.Displaced() : std::min<std::size_t>(hypothesis.views.size(), 2);
}

/// Sides of a mirrored image are decided later, limb by limb (FindSideExchanges).
bool AreSame(const RigHypothesis& a, const RigHypothesis& b) {
  return !a.ExchangesFiles() && a.views == b.views && a.mirrored && b.mirrored;
}

const ScoredHypothesis* BestOf(const std::vector<ScoredHypothesis>& all, const ScoredHypothesis& given, double least) {
  const ScoredHypothesis* best = nullptr;
  for (const ScoredHypothesis& scored : all) {
    if (scored.mean > kEqualCostRatio * least + kEqualCostDifference || !IsMuchBetter(scored, given)) continue;
    const auto [changes, others] = std::pair(Changes(scored.hypothesis), best ? Changes(best->hypothesis) : 0);
    if (best == nullptr || changes < others || (changes == others && scored.mean < best->mean)) best = &scored;
  }
  return best;
}

}  // namespace

std::string CamerasOf(const RigHypothesis& hypothesis, const std::vector<KeypointView>& views) {
  std::string names;
  for (std::size_t v = 0; v < views.size(); ++v) {
    if (hypothesis.Concerns(v)) names += (names.empty() ? "" : ", ") + views[v].camera.name;
  }
  return names;
}

std::string WordsOf(const RigHypothesis& hypothesis, const std::vector<KeypointView>& views) {
  const std::string cameras = CamerasOf(hypothesis, views);
  if (hypothesis.ExchangesFiles()) {
    std::string pairs;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (hypothesis.source[v] == v) continue;
      pairs += (pairs.empty() ? "" : ", ") + views[v].camera.name + " in those of " +
               views[hypothesis.source[v]].camera.name;
    }
    return "the files of cameras are exchanged: keypoints of " + pairs;
  }
  if (hypothesis.mirrored) {
    return "keypoints of camera " + cameras + " are of a mirrored image (x counts from the right)" +
           (hypothesis.sides ? ", with left and right exchanged" : "");
  }
  if (hypothesis.sides) return "camera " + cameras + " exchanges left and right in all frames";
  return "keypoints of camera " + cameras +
         " are of images of another size than the calibration: multiply their pixels by " +
         RoundedText(hypothesis.factor, 3);
}

RigHypothesis RigHypothesis::AsGiven(std::size_t views) {
  RigHypothesis given;
  given.source.resize(views);
  std::iota(given.source.begin(), given.source.end(), std::size_t{0});
  return given;
}

bool RigHypothesis::ChangesView(std::size_t v) const { return std::find(views.begin(), views.end(), v) != views.end(); }

std::size_t RigHypothesis::Displaced() const {
  std::size_t displaced = 0;
  for (std::size_t v = 0; v < source.size(); ++v) displaced += source[v] != v ? 1 : 0;
  return displaced;
}

RigHypotheses FindRigHypotheses(const std::vector<KeypointView>& views, const std::vector<std::string>& names,
                                const std::vector<KnownLength>& lengths, double min_confidence, double sure) {
  if (views.size() < kLeastViewsAudited || views.size() > kMostViewsAudited) return {};
  const std::vector<KeypointView> some = AtSomeMoments(views, static_cast<int>(names.size()));
  if (some.empty()) return {};
  HypothesisScorer scorer(some, names, lengths, min_confidence);
  const ScoredHypothesis given = scorer(RigHypothesis::AsGiven(views.size()));
  if (given.mean <= kAgreeing) return {};
  std::vector<RigHypothesis> tested = AllHypotheses(views.size());
  const auto skipped = [&](const RigHypothesis& hypothesis) {
    return given.mean <= kViewsDisagree && !IsOfRig(hypothesis, views.size());
  };
  tested.erase(std::remove_if(tested.begin(), tested.end(), skipped), tested.end());
  const auto better = [&](const RigHypothesis& hypothesis) { return scorer.MuchBetter(hypothesis, given); };
  if (std::none_of(tested.begin(), tested.end(), better)) return {};
  std::vector<ScoredHypothesis> all;
  for (const RigHypothesis& hypothesis : tested) all.push_back(scorer(hypothesis));
  double least = given.mean;
  for (const ScoredHypothesis& scored : all) least = std::min(least, scored.mean);
  const ScoredHypothesis* best = BestOf(all, given, least);
  if (best == nullptr) return {};
  std::vector<std::vector<double>> costs{given.costs};
  for (const ScoredHypothesis& scored : all) costs.push_back(scored.costs);
  const std::vector<double> held_out = HeldOutCosts(costs, FirstAndSecondHalf(given.costs.size()));
  RigHypotheses found{{best->hypothesis}, given.share, best->share,
                      given.mean,         best->mean,  Confidence(given.costs, held_out),
                      some[0].time_s,     given.costs, held_out};
  const std::size_t changes = Changes(best->hypothesis);
  for (const ScoredHypothesis& scored : all) {
    if (&scored == best || AreSame(scored.hypothesis, best->hypothesis)) continue;
    const bool alike = scored.mean <= kEqualCostRatio * least + kEqualCostDifference;
    // With more exchanged files and the same agreement it is the same rig viewed from another side.
    if (alike && changes > 1 && Changes(scored.hypothesis) > changes) continue;
    const double confidence = Confidence(scored.costs, held_out);
    if (!alike || confidence >= sure) {
      found.confidence = std::min(found.confidence, confidence);
      continue;
    }
    const auto same = [&](const RigHypothesis& hypothesis) { return AreSame(hypothesis, scored.hypothesis); };
    if (std::none_of(found.alike.begin(), found.alike.end(), same)) found.alike.push_back(scored.hypothesis);
  }
  return found;
}

std::vector<RigHypothesis> FindMirroredHypotheses(const std::vector<KeypointView>& views,
                                                  const std::vector<std::string>& names,
                                                  const std::vector<KnownLength>& lengths, double min_confidence,
                                                  double sure) {
  if (views.size() > kMostViewsAudited) return {};
  const std::vector<KeypointView> some = AtSomeMoments(views, static_cast<int>(names.size()));
  if (some.empty()) return {};
  HypothesisScorer scorer(some, names, lengths, min_confidence);
  const ScoredHypothesis given = scorer(RigHypothesis::AsGiven(views.size()));
  std::vector<RigHypothesis> found;
  for (const RigHypothesis& hypothesis : AllHypotheses(views.size())) {
    const bool exchanged = hypothesis.ExchangesFiles() && hypothesis.Displaced() == 2;
    const bool mirrored = hypothesis.mirrored && !hypothesis.sides && hypothesis.views.size() == views.size();
    if (!exchanged && !mirrored) continue;
    const ScoredHypothesis scored = scorer(hypothesis);
    const bool worse = scored.mean > kEqualCostRatio * given.mean + kEqualCostDifference;
    if (worse || Confidence(scored.costs, given.costs) >= sure) continue;
    found.push_back(hypothesis);
  }
  return found;
}

std::vector<KeypointView> WithHypothesis(const std::vector<KeypointView>& views, const std::vector<std::string>& names,
                                         const RigHypothesis& hypothesis) {
  const std::vector<std::size_t> other_side = OtherSides(names);
  std::vector<KeypointView> read;
  for (std::size_t v = 0; v < views.size(); ++v) read.push_back(ViewUnder(views, v, other_side, hypothesis));
  return read;
}

}  // namespace mocurate
