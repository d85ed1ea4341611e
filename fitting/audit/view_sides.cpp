#include "fitting/audit/view_sides.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "fitting/audit/camera_moves.h"
#include "fitting/audit/rig_fault.h"
#include "fitting/audit/rig_samples.h"

namespace mocurate {
namespace {

constexpr double kViewChangeCost = 4.0;      ///< cost (negative log likelihood) of a change of state
constexpr double kExchangedViewCost = 0.05;  ///< cost of an exchanged frame
constexpr double kMostDetectionCost = 6.0;   ///< cost of a detection, at most: beyond it is an outlier
constexpr double kMostOfFrame = 12.0;        ///< cost of a frame, at most: its detections have common errors

using Pair = std::pair<std::size_t, std::size_t>;

const std::vector<std::pair<std::string, std::vector<std::string>>>& PartsOfLimbs() {
  static const std::vector<std::pair<std::string, std::vector<std::string>>> limbs = {
      {"arms", {"collar", "shoulder", "elbow", "wrist", "hand"}},
      {"legs", {"hip", "knee", "ankle", "foot", "heel", "big_toe", "small_toe"}}};
  return limbs;
}

std::vector<Pair> PairsOfParts(const std::vector<std::string>& names, const std::vector<std::string>& parts) {
  const auto find = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  std::vector<Pair> pairs;
  for (const std::string& part : parts) {
    const Pair pair{find("left_" + part), find("right_" + part)};
    if (pair.first < names.size() && pair.second < names.size()) pairs.push_back(pair);
  }
  return pairs;
}

double CostOfDetection(const ViewKeypoints& view, std::size_t at, std::size_t of_point,
                       const TriangulatedTracks& points, double noise_px) {
  const Eigen::Map<const Vector3d> point(points.positions.xyz.data() + 3 * of_point);
  const double square = PixelError(view, at, point).squaredNorm();
  return std::min(3.0 * std::log1p(square / (4.0 * noise_px * noise_px)), kMostDetectionCost);
}

/// Log-likelihood ratio of an exchange in a frame.
double GainAt(const ViewKeypoints& view, const TriangulatedTracks& points, const std::vector<Pair>& pairs, int frame,
              double noise_px) {
  const std::size_t first = static_cast<std::size_t>(frame) * static_cast<std::size_t>(points.positions.joints);
  double gain = 0.0;
  for (const Pair& pair : pairs) {
    const std::size_t left = first + pair.first;
    const std::size_t right = first + pair.second;
    if (points.confidence[left] <= 0.0 || points.confidence[right] <= 0.0) continue;
    for (const auto& [own, other] : {Pair{left, right}, Pair{right, left}}) {
      if (view.confidence[own] <= 0.0) continue;
      gain += view.confidence[own] *
              (CostOfDetection(view, own, own, points, noise_px) - CostOfDetection(view, own, other, points, noise_px));
    }
  }
  return std::clamp(gain, -kMostOfFrame, kMostOfFrame);
}

/// Frames in which the cheapest path is in the exchanged state.
std::vector<bool> CheapestPath(const std::vector<double>& gains) {
  std::vector<std::array<std::uint8_t, 2>> from(gains.size());
  std::array<double, 2> cost{0.0, kViewChangeCost};
  for (std::size_t f = 0; f < gains.size(); ++f) {
    std::array<double, 2> next{};
    for (int state = 0; state < 2; ++state) {
      const double stay = cost[state];
      const double change = cost[1 - state] + kViewChangeCost;
      from[f][state] = static_cast<std::uint8_t>(stay <= change ? state : 1 - state);
      next[state] = std::min(stay, change) + (state == 1 ? kExchangedViewCost - gains[f] : 0.0);
    }
    cost = next;
  }
  std::vector<bool> exchanged(gains.size(), false);
  int state = cost[1] < cost[0] ? 1 : 0;
  for (std::size_t f = gains.size(); f-- > 0;) {
    exchanged[f] = state == 1;
    state = from[f][state];
  }
  return exchanged;
}

}  // namespace

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

std::vector<SideExchange> FindSideExchanges(const std::vector<ViewKeypoints>& views, const TriangulatedTracks& points,
                                            const std::vector<std::string>& names, double noise_px,
                                            double least_margin) {
  std::vector<SideExchange> exchanges;
  if (views.size() < kLeastViewsAudited) return exchanges;
  const int frames = points.positions.frames;
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (const auto& [limb, parts] : PartsOfLimbs()) {
      const std::vector<Pair> pairs = PairsOfParts(names, parts);
      if (pairs.size() < 2) continue;  // a single pair may cross by a wrong detection
      std::vector<double> gains;
      for (int f = 0; f < frames; ++f) gains.push_back(GainAt(views[v], points, pairs, f, noise_px));
      const std::vector<bool> exchanged = CheapestPath(gains);
      for (int begin = 0; begin < frames; ++begin) {
        if (!exchanged[begin]) continue;
        SideExchange exchange{v, limb, begin, begin, 0.0};
        for (; exchange.frame_end < frames && exchanged[exchange.frame_end]; ++exchange.frame_end) {
          exchange.margin += gains[exchange.frame_end];
        }
        begin = exchange.frame_end;
        if (exchange.margin >= least_margin) exchanges.push_back(std::move(exchange));
      }
    }
  }
  return exchanges;
}

void ExchangeSides(const std::vector<SideExchange>& exchanges, const std::vector<std::string>& names,
                   std::vector<ViewKeypoints>& views) {
  for (const SideExchange& exchange : exchanges) {
    ViewKeypoints& view = views[exchange.view];
    for (const auto& [limb, parts] : PartsOfLimbs()) {
      if (limb != exchange.limb) continue;
      for (const Pair& pair : PairsOfParts(names, parts)) {
        for (int f = exchange.frame_begin; f < exchange.frame_end; ++f) {
          const std::size_t first = static_cast<std::size_t>(f) * names.size();
          std::swap(view.normalised[first + pair.first], view.normalised[first + pair.second]);
          std::swap(view.confidence[first + pair.first], view.confidence[first + pair.second]);
        }
      }
    }
  }
}

namespace {

/// Share of the cost that the exchange must remove. Finds 40 of 40 views with exchanged sides and none of 240 correct
/// ones. Source: bench_keypoint_rigs 40 5 sides=1 frames=45, and 60 5 frames=45 on four rigs
constexpr double kExplained = 0.1;

}  // namespace

std::optional<SidesThroughout> FindSidesThroughout(const RigSamples& samples, const RigModel& model,
                                                   const std::vector<double>& cost, double sure,
                                                   const TriangulationOptions& options) {
  if (samples.views() < kLeastViewsAudited || samples.count() < kFewestMoments) return {};
  std::vector<SidesThroughout> all;
  for (std::size_t v = 0; v < samples.views(); ++v) {
    if (model.sides_exchanged[v]) continue;
    SidesThroughout one{v, model, {}, 0.0};
    one.model.sides_exchanged[v] = true;
    one.cost = CostsUnder(samples, one.model, options);
    all.push_back(std::move(one));
  }
  const auto best = std::min_element(all.begin(), all.end(), [](const SidesThroughout& a, const SidesThroughout& b) {
    return Sum(a.cost) < Sum(b.cost);
  });
  if (best == all.end() || Sum(best->cost) > (1.0 - kExplained) * Sum(cost)) return {};
  double confidence = Confidence(cost, best->cost);
  for (const SidesThroughout& other : all) {
    if (other.view != best->view) confidence = std::min(confidence, Confidence(other.cost, best->cost));
  }
  best->confidence = ConfidenceOfTests(confidence, kTestsOfView * samples.views());
  if (best->confidence < sure) return {};
  return std::move(*best);
}

}  // namespace mocurate
