#include "fitting/audit/rig_hypotheses.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/confidence.h"
#include "fitting/audit/view_agreement.h"
#include "fitting/audit/view_sides.h"

namespace mocurate {
namespace {

constexpr std::size_t kLeastViewsRead = 3;
constexpr std::size_t kAllOrders = 5;       ///< views up to which all permutations are tried
constexpr std::size_t kMostViewsRead = 12;  ///< more outvote two
/// Cost of an entry up to which nothing is asked. Of the studio's people (4 px of noise) it is 0.04 to 0.07 before
/// rings and PHSPD's cameras, 0.11 before Human3.6M's, which stand farther away; 0.11 to 0.13 before a ring of four
/// whose facing cameras were exchanged, which is 0.06 once they are exchanged back (twice as much in a sound ring).
constexpr double kAgreeing = 0.04;
constexpr double kBetterHypothesis = 0.7;  ///< of the cost as given, by exchanged files or images that are all mirrored
constexpr double kViewsDisagree = 0.08;    ///< cost from which on single views, and other sizes, are asked about
constexpr double kMuchBetterHypothesis = 0.45;  ///< of the cost, by these
/// Of the entries of a view, that a mirrored image must bring to a body where the rest of the cost is of people whom
/// no other view sees: 0.50 to 0.72 for each camera of the Pose2Sim trials, whose bystanders cost 0.36 to 0.43. No
/// other reading gains a tenth of the cost there, of the trials as they are none does.
constexpr double kBroughtHome = 0.4;
constexpr double kAlikeCosts = 1.15;  ///< costs within this ratio are the same,
constexpr double kAlikeCost = 1e-3;   ///< or this difference
constexpr std::array<double, 8> kUnitFactors = {0.25, 1.0 / 3.0, 0.5, 2.0 / 3.0, 1.5, 2.0, 3.0, 4.0};

std::vector<std::size_t> AsGiven(std::size_t views) {
  std::vector<std::size_t> source(views);
  std::iota(source.begin(), source.end(), std::size_t{0});
  return source;
}

void AddExchanges(std::size_t views, std::vector<RigHypothesis>& readings) {
  RigHypothesis reading;
  reading.source = AsGiven(views);
  if (views <= kAllOrders) {
    while (std::next_permutation(reading.source.begin(), reading.source.end())) readings.push_back(reading);
    return;
  }
  for (std::size_t a = 0; a < views; ++a) {
    for (std::size_t b = a + 1; b < views; ++b) {
      readings.push_back(reading);
      std::swap(readings.back().source[a], readings.back().source[b]);
    }
  }
}

/// Of one view, or of all: mirrored, with sides and without, and of other sizes; of one: sides alone.
void AddMeanings(const std::vector<std::size_t>& views, std::size_t all, std::vector<RigHypothesis>& readings) {
  RigHypothesis reading;
  reading.source = AsGiven(all);
  reading.views = views;
  for (const auto& [mirrored, sides] : {std::pair(true, false), std::pair(true, true), std::pair(false, true)}) {
    if (!mirrored && views.size() == all) continue;  // all views may call left what they want
    readings.push_back(reading);
    readings.back().mirrored = mirrored;
    readings.back().sides = sides;
  }
  for (const double factor : kUnitFactors) {
    readings.push_back(reading);
    readings.back().factor = factor;
  }
}

std::vector<RigHypothesis> Readings(std::size_t views) {
  std::vector<RigHypothesis> readings;
  AddExchanges(views, readings);
  for (std::size_t v = 0; v < views; ++v) AddMeanings({v}, views, readings);
  AddMeanings(AsGiven(views), views, readings);
  return readings;
}

/// Detections of a camera, whatever file they come from, in another meaning.
KeypointView Read(KeypointView view, const std::vector<std::size_t>& other_side, const RigHypothesis& reading) {
  const std::vector<double> given = view.values;
  for (std::size_t i = 0; i < given.size() / 3; ++i) {
    const std::size_t k = i % other_side.size();
    const double* from = given.data() + 3 * (reading.sides ? i - k + other_side[k] : i);
    double* to = view.values.data() + 3 * i;
    std::copy(from, from + 3, to);
    if (to[2] <= 0.0) continue;
    to[0] = reading.factor * (reading.mirrored ? view.camera.width - to[0] : to[0]);
    to[1] *= reading.factor;
  }
  return view;
}

KeypointView ViewAsRead(const std::vector<KeypointView>& views, std::size_t v,
                        const std::vector<std::size_t>& other_side, const RigHypothesis& reading) {
  KeypointView view = views[reading.source[v]];
  view.camera = views[v].camera;
  if (std::find(reading.views.begin(), reading.views.end(), v) == reading.views.end()) return view;
  return Read(std::move(view), other_side, reading);
}

struct Judged {
  RigHypothesis reading;
  std::vector<double> costs;  ///< of the moments
  double mean = 0.0;
  double share = 0.0;
};

/// Files exchanged, or all images mirrored: nothing but how the rig stands in the world.
bool IsOfRig(const RigHypothesis& reading, std::size_t views) {
  return reading.ExchangesFiles() || (reading.mirrored && reading.views.size() == views);
}

bool IsMuchBetter(const Judged& judged, const Judged& given) {
  const RigHypothesis& reading = judged.reading;
  const auto views = static_cast<double>(reading.source.size());
  const bool turned = reading.mirrored && reading.views.size() == 1;
  if (turned && views * (given.mean - judged.mean) > kBroughtHome) return true;
  return judged.mean <
         (IsOfRig(reading, reading.source.size()) ? kBetterHypothesis : kMuchBetterHypothesis) * given.mean;
}

/// Reads a rig in one way after the other. Views that several readings share are made once.
class HypothesisScorer {
 public:
  HypothesisScorer(const std::vector<KeypointView>& some, const std::vector<std::string>& names,
                   const std::vector<KnownLength>& lengths, double min_confidence)
      : some_(some), other_side_(OtherSides(names)), lengths_(lengths), min_confidence_(min_confidence) {}

  Judged operator()(const RigHypothesis& reading) { return Judge(reading, nullptr); }

  /// What IsMuchBetter says of the whole judgement. Costs only grow from moment to moment: most readings are given up
  /// after one or two.
  bool MuchBetter(const RigHypothesis& reading, const Judged& given) {
    return IsMuchBetter(Judge(reading, &given), given);
  }

 private:
  using Key = std::tuple<std::size_t, std::size_t, bool, bool, double>;

  /// At all moments, or until it is not much better than `unless_better`, if given.
  Judged Judge(const RigHypothesis& reading, const Judged* unless_better) {
    Judged judged{reading, {}, 0.0, 0.0};
    std::vector<RigView> rig;
    for (std::size_t v = 0; v < some_.size(); ++v) rig.push_back(At(v, reading));
    const std::size_t moments = some_[0].time_s.size();
    for (std::size_t m = 0; m < moments; ++m) {
      judged.costs.push_back(CostOfAgreement(rig, static_cast<int>(m), lengths_, judged.share));
      judged.mean += judged.costs.back() / static_cast<double>(moments);
      if (unless_better != nullptr && !IsMuchBetter(judged, *unless_better)) return judged;
    }
    judged.share /= static_cast<double>(moments);
    return judged;
  }

  const RigView& At(std::size_t v, const RigHypothesis& reading) {
    const bool changed = std::find(reading.views.begin(), reading.views.end(), v) != reading.views.end();
    const Key key(v, reading.source[v], changed && reading.mirrored, changed && reading.sides,
                  changed ? reading.factor : 1.0);
    const auto made = made_.find(key);
    if (made != made_.end()) return made->second;
    const RigView view(ViewAsRead(some_, v, other_side_, reading), static_cast<int>(other_side_.size()),
                       min_confidence_);
    return made_.emplace(key, view).first->second;
  }

  const std::vector<KeypointView>& some_;
  std::vector<std::size_t> other_side_;
  const std::vector<KnownLength>& lengths_;
  double min_confidence_;
  std::map<Key, RigView> made_;
};

/// Views that mean something else, or files that lie elsewhere: all images mirrored is as much as two files exchanged.
std::size_t Changes(const RigHypothesis& reading) {
  return reading.ExchangesFiles() ? reading.Displaced() : std::min<std::size_t>(reading.views.size(), 2);
}

/// Which side is which in a mirrored image is asked again, limb by limb (FindSideExchanges).
bool AreSame(const RigHypothesis& a, const RigHypothesis& b) {
  return !a.ExchangesFiles() && a.views == b.views && a.mirrored && b.mirrored;
}

const Judged* BestOf(const std::vector<Judged>& all, const Judged& given, double least) {
  const Judged* best = nullptr;
  for (const Judged& judged : all) {
    if (judged.mean > kAlikeCosts * least + kAlikeCost || !IsMuchBetter(judged, given)) continue;
    const auto [changes, others] = std::pair(Changes(judged.reading), best ? Changes(best->reading) : 0);
    if (best == nullptr || changes < others || (changes == others && judged.mean < best->mean)) best = &judged;
  }
  return best;
}

}  // namespace

std::string CamerasOf(const RigHypothesis& reading, const std::vector<KeypointView>& views) {
  std::string names;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const bool read = std::find(reading.views.begin(), reading.views.end(), v) != reading.views.end();
    if (read || reading.source[v] != v) names += (names.empty() ? "" : ", ") + views[v].camera.name;
  }
  return names;
}

std::string WordsOf(const RigHypothesis& reading, const std::vector<KeypointView>& views) {
  const std::string cameras = CamerasOf(reading, views);
  if (reading.ExchangesFiles()) {
    std::string pairs;
    for (std::size_t v = 0; v < views.size(); ++v) {
      if (reading.source[v] == v) continue;
      pairs +=
          (pairs.empty() ? "" : ", ") + views[v].camera.name + " in those of " + views[reading.source[v]].camera.name;
    }
    return "what cameras see lies in each other's files: " + pairs;
  }
  if (reading.mirrored) {
    return "keypoints of camera " + cameras + " are of a mirrored image, x counts from the right" +
           (reading.sides ? " and left is called right" : "");
  }
  if (reading.sides) return "camera " + cameras + " lists left as right throughout";
  return "keypoints of camera " + cameras +
         " are of images of another size than the calibration: their pixels must be " + "multiplied by " +
         RoundedText(reading.factor, 3);
}

std::size_t RigHypothesis::Displaced() const {
  std::size_t displaced = 0;
  for (std::size_t v = 0; v < source.size(); ++v) displaced += source[v] != v ? 1 : 0;
  return displaced;
}

RigHypotheses FindRigHypotheses(const std::vector<KeypointView>& views, const std::vector<std::string>& names,
                                const std::vector<KnownLength>& lengths, double min_confidence, double sure) {
  if (views.size() < kLeastViewsRead || views.size() > kMostViewsRead) return {};
  const std::vector<KeypointView> some = AtSomeMoments(views, static_cast<int>(names.size()));
  if (some.empty()) return {};
  HypothesisScorer judge(some, names, lengths, min_confidence);
  RigHypothesis as_given;
  as_given.source = AsGiven(views.size());
  const Judged given = judge(as_given);
  if (given.mean <= kAgreeing) return {};
  std::vector<RigHypothesis> asked = Readings(views.size());
  const auto unasked = [&](const RigHypothesis& reading) {
    return given.mean <= kViewsDisagree && !IsOfRig(reading, views.size());
  };
  asked.erase(std::remove_if(asked.begin(), asked.end(), unasked), asked.end());
  const auto better = [&](const RigHypothesis& reading) { return judge.MuchBetter(reading, given); };
  if (std::none_of(asked.begin(), asked.end(), better)) return {};
  std::vector<Judged> all;
  for (const RigHypothesis& reading : asked) all.push_back(judge(reading));
  double least = given.mean;
  for (const Judged& judged : all) least = std::min(least, judged.mean);
  const Judged* best = BestOf(all, given, least);
  if (best == nullptr) return {};
  RigHypotheses found{{best->reading}, given.share, best->share,
                      given.mean,      best->mean,  Confidence(given.costs, best->costs)};
  const std::size_t changes = Changes(best->reading);
  for (const Judged& judged : all) {
    if (&judged == best || AreSame(judged.reading, best->reading)) continue;
    const bool alike = judged.mean <= kAlikeCosts * least + kAlikeCost;
    // What moves more files and agrees as well is the same rig seen from another side.
    if (alike && changes > 1 && Changes(judged.reading) > changes) continue;
    const double surely = Confidence(judged.costs, best->costs);
    if (!alike || surely >= sure) {
      found.confidence = std::min(found.confidence, surely);
      continue;
    }
    const auto listed = [&](const RigHypothesis& reading) { return AreSame(reading, judged.reading); };
    if (std::none_of(found.alike.begin(), found.alike.end(), listed)) found.alike.push_back(judged.reading);
  }
  return found;
}

std::vector<RigHypothesis> FindMirroredHypotheses(const std::vector<KeypointView>& views,
                                                  const std::vector<std::string>& names,
                                                  const std::vector<KnownLength>& lengths, double min_confidence,
                                                  double sure) {
  if (views.size() > kMostViewsRead) return {};
  const std::vector<KeypointView> some = AtSomeMoments(views, static_cast<int>(names.size()));
  if (some.empty()) return {};
  HypothesisScorer judge(some, names, lengths, min_confidence);
  RigHypothesis as_given;
  as_given.source = AsGiven(views.size());
  const Judged given = judge(as_given);
  std::vector<RigHypothesis> found;
  for (const RigHypothesis& reading : Readings(views.size())) {
    const bool exchanged = reading.ExchangesFiles() && reading.Displaced() == 2;
    const bool mirrored = reading.mirrored && !reading.sides && reading.views.size() == views.size();
    if (!exchanged && !mirrored) continue;
    const Judged judged = judge(reading);
    const bool worse = judged.mean > kAlikeCosts * given.mean + kAlikeCost;
    if (worse || Confidence(judged.costs, given.costs) >= sure) continue;
    found.push_back(reading);
  }
  return found;
}

std::vector<KeypointView> WithHypothesis(const std::vector<KeypointView>& views, const std::vector<std::string>& names,
                                         const RigHypothesis& reading) {
  const std::vector<std::size_t> other_side = OtherSides(names);
  std::vector<KeypointView> read;
  for (std::size_t v = 0; v < views.size(); ++v) read.push_back(ViewAsRead(views, v, other_side, reading));
  return read;
}

}  // namespace mocurate
