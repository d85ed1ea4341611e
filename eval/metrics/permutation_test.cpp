#include "eval/metrics/permutation_test.h"

#include <algorithm>
#include <cmath>

namespace mocurate {

double PairedExchangeTest(int count, int permutations, const std::function<double(const std::vector<bool>&)>& statistic,
                          Random& random) {
  constexpr double kRounding = 1e-12;  // equal differences may differ by summation order
  const double seen = std::abs(statistic(std::vector<bool>(static_cast<std::size_t>(count), false)));
  int as_far = 1;
  std::vector<bool> exchanged(static_cast<std::size_t>(count));
  for (int p = 0; p < permutations; ++p) {
    for (int i = 0; i < count; ++i) exchanged[static_cast<std::size_t>(i)] = random.Below(2) == 1;
    as_far += std::abs(statistic(exchanged)) >= seen * (1.0 - kRounding) ? 1 : 0;
  }
  return static_cast<double>(as_far) / (permutations + 1.0);
}

double PairedSignTest(const std::vector<double>& a, const std::vector<double>& b, int permutations, Random& random) {
  const auto count = static_cast<int>(std::min(a.size(), b.size()));
  if (count == 0) return 1.0;
  return PairedExchangeTest(
      count, permutations,
      [&](const std::vector<bool>& exchanged) {
        double sum = 0.0;
        for (int i = 0; i < count; ++i) {
          const auto at = static_cast<std::size_t>(i);
          sum += exchanged[at] ? b[at] - a[at] : a[at] - b[at];
        }
        return sum / count;
      },
      random);
}

}  // namespace mocurate
