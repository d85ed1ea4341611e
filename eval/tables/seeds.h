#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace mocurate {

/// Kind of an interval from the smallest to the largest of several trainings.
inline constexpr const char* kRangeOfSeeds = "range_of_seeds";

/// Rows of one network trained with several seeds ("network": NAME/SEED, the same text after it in "name") become one
/// row at the place of the first: NAME, every metric as the mean over the seeds with its range as interval and the
/// seeds' values as repetitions, "seeds": the rows themselves. Samples of training (NAME/SEED@STEP) stay rows.
void MergeSeeds(nlohmann::json& rows);

/// Exact permutation test of two groups of independent values, "the first is less": the share of all assignments of the
/// values to groups of these sizes whose difference of means is no larger than the observed one. Of s and s values at
/// least 1 / C(2s, s): 1/6, 1/20, 1/70 of 2, 3, 4. [Fisher 1935]
double ChanceOfLess(const std::vector<double>& less, const std::vector<double>& more);

/// [{"metric", "better", "worse", "seeds": [of each], "difference": of the means, "p", "least_p": possible, "p_holm"}]
/// of all pairs of merged rows, for FID_train and accuracy. `p` is one-sided: of the direction seen; twice it where
/// none was expected. `p_holm` corrects it for the pairs of the metric.
nlohmann::json OrdersOfSeeds(const nlohmann::json& rows);

}  // namespace mocurate
