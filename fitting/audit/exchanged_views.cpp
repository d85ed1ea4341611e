#include "fitting/audit/exchanged_views.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fitting/association/propose.h"
#include "fitting/audit/rig_samples.h"
#include "fitting/evidence/noise.h"

namespace mocurate {
namespace {

constexpr int kMoments = 24;
constexpr std::size_t kLeastViews = 3;
constexpr std::size_t kAllOrders = 5;   ///< views up to which all permutations are tried
constexpr std::size_t kMostViews = 12;  ///< more outvote two
constexpr double kAgreeing = 0.15;      ///< cost of an entry up to which nothing is asked
constexpr double kMuchBetter = 0.7;     ///< of the cost as the files are
constexpr double kAlike = 1.15;         ///< costs within this ratio are the same
constexpr double kFarOff = 0.1;         ///< of a person's extent: an entry so far from its rays is as good as nobody's
constexpr int kLeastKeypoints = 4;

/// A view's frame nearest to a moment, as another camera would see it.
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

/// Costs of all entries of a moment, 0 (on their rays) to 1 (nobody's) each: their mean.
double CostAt(const std::vector<RigView>& rig, int frame, const std::vector<KnownLength>& lengths, double& share) {
  std::vector<Sight> entries;
  for (std::size_t v = 0; v < rig.size(); ++v) {
    for (int p = 0; p < rig[v].people; ++p) {
      if (rig[v].seen[rig[v].Entry(frame, p)] >= kLeastKeypoints) entries.push_back({static_cast<int>(v), frame, p});
    }
  }
  if (entries.empty()) return 0.0;
  double cost = static_cast<double>(entries.size());
  for (const std::vector<Sight>& sights : ProposePeople(rig, entries, lengths, 0.0)) {
    if (sights.size() < 3 && rig.size() > 3) continue;  // two views agree on somebody by chance
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

struct Judged {
  std::vector<std::size_t> source;
  std::vector<double> costs;  ///< of the moments
  double mean = 0.0;
  double share = 0.0;
  int displaced = 0;
};

std::vector<std::vector<std::size_t>> Orders(std::size_t views) {
  std::vector<std::size_t> order(views);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::vector<std::vector<std::size_t>> orders;
  if (views <= kAllOrders) {
    do {
      orders.push_back(order);
    } while (std::next_permutation(order.begin(), order.end()));
    return orders;
  }
  orders.push_back(order);
  for (std::size_t a = 0; a < views; ++a) {
    for (std::size_t b = a + 1; b < views; ++b) {
      orders.push_back(order);
      std::swap(orders.back()[a], orders.back()[b]);
    }
  }
  return orders;
}

}  // namespace

std::optional<ViewExchange> FindExchangedViews(const std::vector<KeypointView>& views, int keypoints,
                                               const std::vector<KnownLength>& lengths, double min_confidence) {
  if (views.size() < kLeastViews || views.size() > kMostViews) return {};
  std::vector<double> moments;
  const std::vector<double>& time = views[0].time_s;
  const std::size_t count = std::min<std::size_t>(kMoments, time.size());
  for (std::size_t i = 0; i < count; ++i) moments.push_back(time[i * time.size() / count]);
  for (const KeypointView& view : views) {
    if (view.time_s.empty()) return {};
  }
  std::vector<KeypointView> some;
  for (const KeypointView& view : views) some.push_back(FramesAt(view, moments, keypoints));
  /// [camera][file]
  std::vector<std::vector<std::optional<RigView>>> seen(views.size(),
                                                        std::vector<std::optional<RigView>>(views.size()));
  const auto judge = [&](const std::vector<std::size_t>& source) {
    Judged judged{source, {}, 0.0, 0.0, 0};
    std::vector<RigView> rig;
    for (std::size_t v = 0; v < source.size(); ++v) {
      auto& view = seen[v][source[v]];
      if (!view) {
        KeypointView exchanged = some[source[v]];
        exchanged.camera = some[v].camera;
        view.emplace(exchanged, keypoints, min_confidence);
      }
      rig.push_back(*view);
      judged.displaced += source[v] != v ? 1 : 0;
    }
    for (std::size_t m = 0; m < moments.size(); ++m) {
      judged.costs.push_back(CostAt(rig, static_cast<int>(m), lengths, judged.share));
      judged.mean += judged.costs.back() / static_cast<double>(moments.size());
    }
    judged.share /= static_cast<double>(moments.size());
    return judged;
  };
  const auto orders = Orders(views.size());
  const Judged given = judge(orders[0]);
  if (given.mean <= kAgreeing) return {};
  std::vector<Judged> all;
  for (std::size_t i = 1; i < orders.size(); ++i) all.push_back(judge(orders[i]));
  double least = given.mean;
  for (const Judged& judged : all) least = std::min(least, judged.mean);
  const Judged* best = nullptr;
  for (const Judged& judged : all) {
    if (judged.mean > kAlike * least + 1e-3) continue;
    if (best == nullptr || judged.displaced < best->displaced ||
        (judged.displaced == best->displaced && judged.mean < best->mean)) {
      best = &judged;
    }
  }
  if (best == nullptr || best->mean > kMuchBetter * given.mean) return {};
  ViewExchange exchange{best->source, given.share, best->share, Confidence(given.costs, best->costs)};
  for (const Judged& judged : all) {
    // What moves more files and agrees as well is the same rig seen from another side.
    const bool alike = judged.mean <= kAlike * least + 1e-3;
    if (&judged == best || (alike && judged.displaced > best->displaced)) continue;
    exchange.confidence = std::min(exchange.confidence, Confidence(judged.costs, best->costs));
  }
  return exchange;
}

std::vector<KeypointView> WithExchangedViews(const std::vector<KeypointView>& views,
                                             const std::vector<std::size_t>& source) {
  std::vector<KeypointView> exchanged = views;
  for (std::size_t v = 0; v < views.size(); ++v) {
    exchanged[v] = views[source[v]];
    exchanged[v].camera = views[v].camera;
  }
  return exchanged;
}

}  // namespace mocurate
