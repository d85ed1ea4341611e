#include "core/quality/unit_changes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace mocurate {
namespace {

constexpr std::size_t kFewestPoints = 5;
constexpr double kNearTen = 0.2;  // of the logarithm of a factor: poses change a size by 1.6 about the median
constexpr int kLargestPower = 3;  // of ten: millimetres and metres

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Logarithms of the median distance of points from their middle, a frame each; nothing where too few are seen, or all
/// lie in one place.
std::vector<std::optional<double>> SizesOf(const TrackedPoints& points) {
  const std::vector<BodyCentre> centres = BodyCentres(points);
  std::vector<std::optional<double>> sizes(centres.size());
  for (int f = 0; f < points.frames(); ++f) {
    std::vector<double> distances;
    for (int k = 0; k < points.count(); ++k) {
      if (points.sees(f, k)) distances.push_back((points.at(f, k) - centres[static_cast<std::size_t>(f)].place).norm());
    }
    if (distances.size() < kFewestPoints) continue;
    const double size = MedianOf(std::move(distances));
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
  const double usual = MedianOf(seen);
  for (std::size_t f = 0; f < sizes.size(); ++f) {
    if (!sizes[f]) continue;
    const double power = std::round(*sizes[f] - usual);
    const bool near = std::abs(*sizes[f] - usual - power) <= kNearTen && std::abs(power) <= kLargestPower;
    powers[f] = near ? static_cast<int>(power) : 0;
  }
  return powers;
}

}  // namespace

std::vector<Finding> FindUnitChanges(const TrackedPoints& points) {
  const std::vector<std::optional<int>> powers = PowersOf(SizesOf(points));
  std::vector<Finding> findings;
  int before = 0;  // of the last frame that tells
  for (int f = 0; f < points.frames(); ++f) {
    const std::optional<int>& power = powers[static_cast<std::size_t>(f)];
    if (!power) continue;
    if (*power != 0 && *power == before) {
      findings.back().frame_end = f + 1;
    } else if (*power != 0) {
      const double factor = std::pow(10.0, *power);
      findings.push_back(FrameFinding("units_change", f, f + 1, "", factor,
                                      "the numbers of these frames are " + Digits(factor) +
                                          " times those of the others: they are of another unit; divide them by " +
                                          Digits(factor)));
      findings.back().severity = Severity::kError;
    }
    before = *power;
  }
  return findings;
}

}  // namespace mocurate
