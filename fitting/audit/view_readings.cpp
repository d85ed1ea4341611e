#include "fitting/audit/view_readings.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "fitting/audit/confidence.h"
#include "fitting/audit/view_agreement.h"

namespace mocurate {
namespace {

constexpr std::size_t kLeastViews = 3;
constexpr std::size_t kMostViews = 12;
constexpr double kAgreeing = 0.08;    ///< cost of an entry up to which nothing is asked
constexpr double kMuchBetter = 0.45;  ///< of the cost as given
constexpr std::array<double, 8> kFactors = {0.25, 1.0 / 3.0, 0.5, 2.0 / 3.0, 1.5, 2.0, 3.0, 4.0};

struct Judged {
  std::vector<double> costs;  ///< of the moments
  double mean = 0.0;
  double share = 0.0;
};

Judged Judge(const std::vector<KeypointView>& views, int keypoints, const std::vector<KnownLength>& lengths,
             double min_confidence) {
  std::vector<RigView> rig;
  for (const KeypointView& view : views) rig.emplace_back(view, keypoints, min_confidence);
  Judged judged;
  const std::size_t moments = views[0].time_s.size();
  for (std::size_t m = 0; m < moments; ++m) {
    judged.costs.push_back(CostOfAgreement(rig, static_cast<int>(m), lengths, judged.share));
    judged.mean += judged.costs.back() / static_cast<double>(moments);
  }
  judged.share /= static_cast<double>(moments);
  return judged;
}

/// Of one view, or of all: mirrored, with sides and without, and of other sizes.
std::vector<ViewReading> Readings(std::size_t views) {
  std::vector<std::vector<std::size_t>> subjects;
  for (std::size_t v = 0; v < views; ++v) subjects.push_back({v});
  subjects.emplace_back(views);
  std::iota(subjects.back().begin(), subjects.back().end(), std::size_t{0});
  std::vector<ViewReading> readings;
  for (const auto& subject : subjects) {
    for (const bool sides : {false, true}) {
      readings.emplace_back();
      readings.back().views = subject;
      readings.back().mirrored = true;
      readings.back().sides = sides;
    }
    for (const double factor : kFactors) {
      readings.emplace_back();
      readings.back().views = subject;
      readings.back().factor = factor;
    }
  }
  return readings;
}

/// Index of the keypoint of the other side, or its own.
std::vector<std::size_t> OtherSides(const std::vector<std::string>& names) {
  std::vector<std::size_t> others(names.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    others[k] = k;
    for (const auto& [here, there] : {std::pair<std::string, std::string>{"left_", "right_"}, {"right_", "left_"}}) {
      if (names[k].rfind(here, 0) != 0) continue;
      const auto other = std::find(names.begin(), names.end(), there + names[k].substr(here.size()));
      if (other != names.end()) others[k] = static_cast<std::size_t>(other - names.begin());
    }
  }
  return others;
}

}  // namespace

std::vector<KeypointView> WithReading(std::vector<KeypointView> views, const std::vector<std::string>& names,
                                      const ViewReading& reading) {
  const std::vector<std::size_t> other = OtherSides(names);
  for (const std::size_t v : reading.views) {
    KeypointView& view = views[v];
    const std::vector<double> given = view.values;
    for (std::size_t i = 0; i < given.size() / 3; ++i) {
      const std::size_t k = i % names.size();
      const double* from = given.data() + 3 * (reading.sides ? i - k + other[k] : i);
      double* to = view.values.data() + 3 * i;
      std::copy(from, from + 3, to);
      if (to[2] <= 0.0) continue;
      to[0] = reading.factor * (reading.mirrored ? view.camera.width - to[0] : to[0]);
      to[1] *= reading.factor;
    }
  }
  return views;
}

std::optional<ViewReading> FindMisreadViews(const std::vector<KeypointView>& views,
                                            const std::vector<std::string>& names,
                                            const std::vector<KnownLength>& lengths, double min_confidence) {
  if (views.size() < kLeastViews || views.size() > kMostViews) return {};
  const auto keypoints = static_cast<int>(names.size());
  const std::vector<KeypointView> some = AtSomeMoments(views, keypoints);
  if (some.empty()) return {};
  const Judged given = Judge(some, keypoints, lengths, min_confidence);
  if (given.mean <= kAgreeing) return {};
  std::optional<ViewReading> best;
  std::vector<Judged> all;
  std::size_t chosen = 0;
  double least = kMuchBetter * given.mean;
  const std::vector<ViewReading> readings = Readings(views.size());
  for (const ViewReading& reading : readings) {
    all.push_back(Judge(WithReading(some, names, reading), keypoints, lengths, min_confidence));
    if (all.back().mean >= least) continue;
    least = all.back().mean;
    chosen = all.size() - 1;
    best = reading;
  }
  if (!best) return {};
  best->agreement = given.share;
  best->read = all[chosen].share;
  best->confidence = Confidence(given.costs, all[chosen].costs);
  for (std::size_t i = 0; i < all.size(); ++i) {
    // Which side is which in a mirrored image is asked again, limb by limb (FindSideExchanges).
    const bool same = readings[i].views == best->views && readings[i].mirrored && best->mirrored;
    if (i != chosen && !same)
      best->confidence = std::min(best->confidence, Confidence(all[i].costs, all[chosen].costs));
  }
  return best;
}

}  // namespace mocurate
