#pragma once

#include <functional>
#include <vector>

#include "core/base/random.h"

namespace mocurate {

/// Paired permutation test of two rows with one value per repetition, both scored against the same reference: the share
/// of sign changes of the differences whose mean is at least as far from 0 as the one seen (this one counted in, so
/// never 0). `permutations` draws of signs. 1 for no values.
double PairedSignTest(const std::vector<double>& a, const std::vector<double>& b, int permutations, Random& random);

/// Permutation test on motions: `statistic` is given which of `count` pairs of motions are exchanged between the two
/// rows, and gives a difference of the rows. The share of exchanges whose difference is at least as far from 0 as
/// without any.
double PairedExchangeTest(int count, int permutations, const std::function<double(const std::vector<bool>&)>& statistic,
                          Random& random);

}  // namespace mocurate
