#pragma once

#include <functional>
#include <vector>

#include "core/base/random.h"

namespace mocurate {

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
