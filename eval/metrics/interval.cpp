#include "eval/metrics/interval.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kNormal975 = 1.96;
constexpr int kResamples = 1000;

}  // namespace

const char* Name(IntervalKind kind) {
  switch (kind) {
    case IntervalKind::kStudent:
      return "student_95";
    case IntervalKind::kAction2Motion:
      return "a2m_1.96_sd_over_sqrt_n";
    case IntervalKind::kActor:
      return "actor_1.96_variance";
    case IntervalKind::kBootstrap:
      return "bootstrap_95";
  }
  return "";
}

std::optional<std::array<double, 2>> CentralInterval(std::vector<double> values) {
  if (values.size() < 2) return std::nullopt;
  std::sort(values.begin(), values.end());
  const auto at = [&](double quantile) {
    const double place = quantile * static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(place);
    const double part = place - static_cast<double>(low);
    return low + 1 < values.size() ? (1.0 - part) * values[low] + part * values[low + 1] : values[low];
  };
  return std::array<double, 2>{at(0.025), at(0.975)};
}

std::vector<double> ResampledMeans(const std::vector<double>& values, int count, Random& random) {
  std::vector<double> means;
  for (int i = 0; i < count; ++i) {
    double sum = 0.0;
    for (std::size_t k = 0; k < values.size(); ++k) sum += values[random.Below(values.size())];
    means.push_back(sum / static_cast<double>(values.size()));
  }
  return means;
}

double StudentQuantile(double probability, int degrees) {
  return boost::math::quantile(boost::math::students_t(degrees), probability);
}

Summary Summarise(const std::vector<double>& values, IntervalKind kind) {
  Summary summary;
  const double n = static_cast<double>(values.size());
  if (values.empty()) return summary;
  for (const double value : values) summary.mean += value / n;
  double squares = 0.0;
  for (const double value : values) squares += (value - summary.mean) * (value - summary.mean);
  if (values.size() < 2) return summary;
  switch (kind) {
    case IntervalKind::kStudent:
      summary.half_width =
          StudentQuantile(0.975, static_cast<int>(values.size()) - 1) * std::sqrt(squares / (n - 1.0) / n);
      break;
    case IntervalKind::kAction2Motion:
      summary.half_width = kNormal975 * std::sqrt(squares / n) / std::sqrt(n);
      break;
    case IntervalKind::kActor:
      summary.half_width = kNormal975 * squares / n;
      break;
    case IntervalKind::kBootstrap: {
      Random random(0, "bootstrap");
      const auto interval = CentralInterval(ResampledMeans(values, kResamples, random));
      summary.half_width = 0.5 * ((*interval)[1] - (*interval)[0]);
      break;
    }
  }
  return summary;
}

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
