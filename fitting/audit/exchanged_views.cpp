#include "fitting/audit/exchanged_views.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fitting/audit/confidence.h"
#include "fitting/audit/view_agreement.h"

namespace mocurate {
namespace {

constexpr std::size_t kLeastViews = 3;
constexpr std::size_t kAllOrders = 5;   ///< views up to which all permutations are tried
constexpr std::size_t kMostViews = 12;  ///< more outvote two
constexpr double kAgreeing = 0.15;      ///< cost of an entry up to which nothing is asked
constexpr double kMuchBetter = 0.7;     ///< of the cost as the files are
constexpr double kAlike = 1.15;         ///< costs within this ratio are the same

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
  const std::vector<KeypointView> some = AtSomeMoments(views, keypoints);
  if (some.empty()) return {};
  const std::size_t moments = some[0].time_s.size();
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
    for (std::size_t m = 0; m < moments; ++m) {
      judged.costs.push_back(CostOfAgreement(rig, static_cast<int>(m), lengths, judged.share));
      judged.mean += judged.costs.back() / static_cast<double>(moments);
    }
    judged.share /= static_cast<double>(moments);
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
