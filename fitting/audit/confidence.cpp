#include "fitting/audit/confidence.h"

#include <cmath>

namespace mocurate {

double Confidence(const std::vector<double>& worse, const std::vector<double>& better) {
  const auto n = static_cast<double>(worse.size());
  if (n < 2.0) return 0.0;
  double mean = 0.0;
  for (std::size_t i = 0; i < worse.size(); ++i) mean += (worse[i] - better[i]) / n;
  double square = 0.0;
  for (std::size_t i = 0; i < worse.size(); ++i) square += std::pow(worse[i] - better[i] - mean, 2);
  const double error = std::sqrt(square / (n * (n - 1.0)));
  if (error <= 0.0) return mean > 0.0 ? 1.0 : 0.0;
  return NormalShare(mean / error);
}

double NormalShare(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

}  // namespace mocurate
