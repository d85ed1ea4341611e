#include "eval/metrics/interval.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>

namespace mocurate {
namespace {

constexpr double kNormal975 = 1.96;

}  // namespace

const char* Name(IntervalKind kind) {
  switch (kind) {
    case IntervalKind::kStudent:
      return "student_95";
    case IntervalKind::kAction2Motion:
      return "a2m_1.96_sd_over_sqrt_n";
    case IntervalKind::kActor:
      return "actor_1.96_variance";
  }
  return "";
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
  }
  return summary;
}

}  // namespace mocurate
