#include "fitting/uncertainty/autocorrelated_error.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"

namespace mocurate {
namespace {

constexpr double kWhite = 0.1;      ///< autocorrelation of neighbours up to which noise counts as white
constexpr double kGross = 4.5;      ///< times the median departure: clamped there
constexpr double kMostLags = 60.0;  ///< frames of lag, at most (numerical)

/// Departures of each observed bone from the body's length, frame by frame; 0 where unobserved. Gross ones are clamped.
std::vector<std::vector<double>> DeparturesOfBones(const TrackWindow& whole) {
  std::vector<std::vector<double>> departures;
  std::vector<double> sizes;
  for (int j = 0; j < whole.tracks.joints(); ++j) {
    const int parent = whole.tracks.skeleton->joints[j].parent;
    if (parent < 0) continue;
    std::vector<double> of_bone(static_cast<std::size_t>(whole.end), 0.0);
    for (int f = 0; f < whole.end; ++f) {
      if (!whole.tracks.seen(f, j) || !whole.tracks.seen(f, parent)) continue;
      const Vector3d bone = whole.tracks.positions.at(f, j) - whole.tracks.positions.at(f, parent);
      of_bone[f] = bone.norm() - *whole.state.bone(j);
      sizes.push_back(std::abs(of_bone[f]));
    }
    departures.push_back(std::move(of_bone));
  }
  const double most = kGross * MeanMedian(sizes);
  for (std::vector<double>& of_bone : departures) {
    for (double& value : of_bone) value = std::clamp(value, -most, most);
  }
  return departures;
}

/// Mean product of departures that are `lag` frames apart.
double Product(const std::vector<std::vector<double>>& departures, int lag) {
  double sum = 0.0;
  double count = 0.0;
  for (const std::vector<double>& of_bone : departures) {
    for (std::size_t f = 0; f + lag < of_bone.size(); ++f) {
      if (of_bone[f] == 0.0 || of_bone[f + lag] == 0.0) continue;
      sum += of_bone[f] * of_bone[f + lag];
      count += 1.0;
    }
  }
  return count > 0.0 ? sum / count : 0.0;
}

}  // namespace

double AutocorrelationInflation(const TrackWindow& whole, double averaged) {
  const std::vector<std::vector<double>> departures = DeparturesOfBones(whole);
  const double square = Product(departures, 0);
  const double n = std::min(averaged, kMostLags);
  double growth = 1.0;
  for (int lag = 1; square > 0.0 && lag < n; ++lag) {
    const double correlation = Product(departures, lag) / square;
    if (correlation < kWhite) break;
    growth += 2.0 * (1.0 - lag / n) * correlation;
  }
  return growth;
}

}  // namespace mocurate
