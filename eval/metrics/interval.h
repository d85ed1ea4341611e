#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "core/base/error.h"
#include "core/base/random.h"

namespace mocurate {

/// Meaning of a "+-". The released codes print different quantities under one name (a2m_actor.md F7).
enum class IntervalKind {
  kStudent,        ///< half-width of the 95 % interval of the mean, Student t with n - 1 degrees of freedom (MultiAct)
  kAction2Motion,  ///< 1.96 sd / sqrt(n), population sd
  kActor,          ///< 1.96 times the population variance: in squared units, not an interval
  kBootstrap,      ///< 95 % of the means of resampled values: an interval without assuming a normal distribution
};

/// "student_95", "a2m_1.96_sd_over_sqrt_n", "actor_1.96_variance", "bootstrap_95".
const char* Name(IntervalKind kind);

/// From the 2.5 % to the 97.5 % quantile of values; nothing for fewer than 2.
std::optional<std::array<double, 2>> CentralInterval(std::vector<double> values);

/// Means of `count` resamples of the values, with replacement.
std::vector<double> ResampledMeans(const std::vector<double>& values, int count, Random& random);

struct Summary {
  double mean = 0.0;
  double half_width = 0.0;
};

/// Summary over the repetitions. One value has half-width 0; no value has mean 0. kBootstrap: half the width of the
/// interval of 1,000 resamples.
Summary Summarise(const std::vector<double>& values, IntervalKind kind);

/// Quantile of Student's t distribution for `degrees` >= 1; probability in (0, 1).
double StudentQuantile(double probability, int degrees);

/// Paired permutation test of two rows with one value per repetition, both scored against the same reference: the share
/// of sign changes whose mean difference is at least as far from 0 as the observed one (which is included, so that p is
/// never 0). `permutations` draws of signs. 1 for no values.
double PairedSignTest(const std::vector<double>& a, const std::vector<double>& b, int permutations, Random& random);

/// Permutation test on motions: `statistic` receives which of `count` pairs of motions are exchanged between the two
/// rows, and returns a difference of the rows. Returns the share of exchanges whose difference is at least as far from
/// 0 as without any.
double PairedExchangeTest(int count, int permutations, const std::function<double(const std::vector<bool>&)>& statistic,
                          Random& random);

}  // namespace mocurate
