#pragma once

#include <vector>

namespace mocurate {

/// Meaning of a "+-". The released codes print different quantities under one name (a2m_actor.md F7).
enum class IntervalKind {
  kStudent,        ///< half-width of the 95 % interval of the mean, Student t with n - 1 degrees of freedom (MultiAct)
  kAction2Motion,  ///< 1.96 sd / sqrt(n), population sd
  kActor,          ///< 1.96 times the population variance: in squared units, not an interval
};

/// "student_95", "a2m_1.96_sd_over_sqrt_n", "actor_1.96_variance".
const char* Name(IntervalKind kind);

struct Summary {
  double mean = 0.0;
  double half_width = 0.0;
};

/// Summary over the repetitions. One value has half-width 0; no value has mean 0.
Summary Summarise(const std::vector<double>& values, IntervalKind kind);

/// Quantile of Student's t distribution for `degrees` >= 1; probability in (0, 1).
double StudentQuantile(double probability, int degrees);

}  // namespace mocurate
