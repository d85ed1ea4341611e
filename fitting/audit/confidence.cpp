#include "fitting/audit/confidence.h"

#include <algorithm>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kSame = 1e-9;  ///< share of two losses; differences below this are rounding (numerical)

/// Cumulative distribution of Student's t (Wallace's approximation, to 0.002).
double StudentShare(double t, double freedom) {
  const double z = std::sqrt(freedom * std::log1p(t * t / freedom)) * (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0);
  return NormalShare(std::copysign(z, t));
}

/// Confidence that the mean is above 0, from the variation of the means of `spans` parts of equal length.
double ConfidenceBySpans(const std::vector<double>& gain, std::size_t spans) {
  std::vector<double> means;
  for (std::size_t s = 0; s < spans; ++s) {
    const std::size_t begin = s * gain.size() / spans, end = (s + 1) * gain.size() / spans;
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += gain[i];
    means.push_back(sum / static_cast<double>(end - begin));
  }
  const auto n = static_cast<double>(spans);
  double mean = 0.0;
  for (const double value : means) mean += value / n;
  double square = 0.0;
  for (const double value : means) square += (value - mean) * (value - mean);
  const double error = std::sqrt(square / (n * (n - 1.0)));
  if (error <= 0.0) return mean > 0.0 ? 1.0 : 0.0;
  return StudentShare(mean / error, n - 1.0);
}

std::vector<double> Gains(const std::vector<double>& worse, const std::vector<double>& better) {
  std::vector<double> gain;
  for (std::size_t i = 0; i < worse.size(); ++i) {
    const double more = worse[i] - better[i];
    const bool same = std::abs(more) <= kSame * (std::abs(worse[i]) + std::abs(better[i]));
    gain.push_back(same ? 0.0 : more);
  }
  return gain;
}

}  // namespace

double ConfidenceOfSeparate(const std::vector<double>& worse, const std::vector<double>& better) {
  return worse.size() < 2 ? 0.0 : ConfidenceBySpans(Gains(worse, better), worse.size());
}

double Confidence(const std::vector<double>& worse, const std::vector<double>& better) {
  const std::vector<double> gain = Gains(worse, better);
  double least = ConfidenceOfSeparate(worse, better);
  for (std::size_t spans = 2 * gain.size() / 3; spans >= kFewestSpans; spans = 2 * spans / 3) {
    least = std::min(least, ConfidenceBySpans(gain, spans));
  }
  return least;
}

double SpanConfidence(double sigmas) { return 2.0 * StudentShare(sigmas, kFewestSpans - 1.0) - 1.0; }

double NormalShare(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

}  // namespace mocurate
