#include "core/quality/unit_changes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/median.h"

namespace mocurate {
namespace {

constexpr std::size_t kFewestScaledPoints = 5;
constexpr double kNearTen = 0.2;  // of the logarithm of a factor: poses change a size by 1.6 about the median
constexpr int kLargestPower = 3;  // of ten: millimetres and metres
// Mean deviation of logarithms: people tracked to 20 mm stay below 0.05, random positions within a centimetre are
// above 0.26.
constexpr double kOneShape = 0.2;
constexpr int kFramesLookedAt = 64;
constexpr std::size_t kPairsOfAPoint = 3;  // with one alone, some random positions stay below 0.2
constexpr std::size_t kFewestSteadyPairs = 8;

/// Logarithms of the median distance of points from their middle, per frame; empty where too few are observed, or all
/// coincide.
std::vector<std::optional<double>> SizesOf(const TrackedPoints& points) {
  const std::vector<BodyCentre> centres = BodyCentres(points);
  std::vector<std::optional<double>> sizes(centres.size());
  for (int f = 0; f < points.frames(); ++f) {
    std::vector<double> distances;
    for (int k = 0; k < points.count(); ++k) {
      if (points.sees(f, k)) distances.push_back((points.at(f, k) - centres[static_cast<std::size_t>(f)].place).norm());
    }
    if (distances.size() < kFewestScaledPoints) continue;
    const double size = Median(std::move(distances));
    if (size > 0.0) sizes[static_cast<std::size_t>(f)] = std::log10(size);
  }
  return sizes;
}

/// Powers of ten by which frames differ from those of the most common size.
std::vector<std::optional<int>> PowersOf(const std::vector<std::optional<double>>& sizes) {
  std::vector<double> seen;
  for (const std::optional<double>& size : sizes) {
    if (size) seen.push_back(*size);
  }
  std::vector<std::optional<int>> powers(sizes.size());
  if (seen.empty()) return powers;
  const double usual = Median(seen);
  for (std::size_t f = 0; f < sizes.size(); ++f) {
    if (!sizes[f]) continue;
    const double power = std::round(*sizes[f] - usual);
    const bool near = std::abs(*sizes[f] - usual - power) <= kNearTen && std::abs(power) <= kLargestPower;
    powers[f] = near ? static_cast<int>(power) : 0;
  }
  return powers;
}

/// Logarithm of the distance of two points; empty where one is not observed, or both coincide.
std::optional<double> LogDistance(const TrackedPoints& points, int f, int a, int b) {
  if (!points.sees(f, a) || !points.sees(f, b)) return std::nullopt;
  const double distance = (points.at(f, a) - points.at(f, b)).norm();
  return distance > 0.0 ? std::optional<double>(std::log(distance)) : std::nullopt;
}

/// Pairs whose distance does not depend on the pose: each point with those at the most constant distances, over frames
/// of the most common size.
class ShapeRatio {
 public:
  ShapeRatio(const TrackedPoints& points, const std::vector<std::optional<int>>& powers) : points_(points) {
    std::vector<int> usual;
    for (int f = 0; f < points.frames(); ++f) {
      if (powers[static_cast<std::size_t>(f)] == 0) usual.push_back(f);
    }
    const std::size_t step = usual.size() / kFramesLookedAt + 1;
    for (std::size_t i = 0; i * step < usual.size(); ++i) usual[i] = usual[i * step];
    usual.resize((usual.size() + step - 1) / step);
    for (int k = 0; k < points.count(); ++k) AddPairsOf(k, usual);
  }

  /// Whether the distances of a frame equal those of the others up to one factor.
  bool Keeps(int frame) const {
    std::vector<double> ratios;
    for (const Pair& pair : pairs_) {
      if (!points_.sees(frame, pair.a) || !points_.sees(frame, pair.b)) continue;
      const std::optional<double> distance = LogDistance(points_, frame, pair.a, pair.b);
      if (!distance) return false;
      ratios.push_back(*distance - pair.log_distance);
    }
    return ratios.size() >= kFewestSteadyPairs && Deviation(ratios, Median(ratios)) < kOneShape;
  }

 private:
  struct Pair {
    int a = 0, b = 0;
    double log_distance = 0.0;  ///< median
  };

  static double Deviation(const std::vector<double>& values, double middle) {
    double sum = 0.0;
    for (const double value : values) sum += std::abs(value - middle);
    return sum / static_cast<double>(values.size());
  }

  void AddPairsOf(int a, const std::vector<int>& frames) {
    std::vector<std::pair<double, Pair>> steady;
    for (int b = 0; b < points_.count(); ++b) {
      std::vector<double> distances;
      for (const int f : frames) {
        if (const auto distance = LogDistance(points_, f, a, b)) distances.push_back(*distance);
      }
      if (distances.empty() || 2 * distances.size() < frames.size()) continue;
      const double middle = Median(distances), deviation = Deviation(distances, middle);
      if (deviation < kOneShape) steady.push_back({deviation, Pair{a, b, middle}});
    }
    std::stable_sort(steady.begin(), steady.end(), [](const auto& x, const auto& y) { return x.first < y.first; });
    if (steady.size() > kPairsOfAPoint) steady.resize(kPairsOfAPoint);
    for (const auto& [deviation, pair] : steady) pairs_.push_back(pair);
  }

  const TrackedPoints& points_;
  std::vector<Pair> pairs_;
};

}  // namespace

std::vector<Finding> FindUnitChanges(const TrackedPoints& points) {
  std::vector<std::optional<int>> powers = PowersOf(SizesOf(points));
  const auto differs = [](const std::optional<int>& power) { return power && *power != 0; };
  if (std::none_of(powers.begin(), powers.end(), differs)) return {};
  const ShapeRatio shape(points, powers);
  for (int f = 0; f < points.frames(); ++f) {
    std::optional<int>& power = powers[static_cast<std::size_t>(f)];
    if (differs(power) && !shape.Keeps(f)) power = 0;
  }
  std::vector<Finding> findings;
  int before = 0;  // power of the last frame that has one
  for (int f = 0; f < points.frames(); ++f) {
    const std::optional<int>& power = powers[static_cast<std::size_t>(f)];
    if (!power) continue;
    if (*power != 0 && *power == before) {
      findings.back().frame_end = f + 1;
    } else if (*power != 0) {
      const double factor = std::pow(10.0, *power);
      findings.push_back(FrameFinding("units_change", f, f + 1, "", factor,
                                      "the numbers of these frames are " + Digits(factor) +
                                          " times those of the others: another unit; divide them by " +
                                          Digits(factor)));
      findings.back().severity = Severity::kError;
    }
    before = *power;
  }
  return findings;
}

}  // namespace mocurate
