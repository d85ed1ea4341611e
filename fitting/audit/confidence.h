#pragma once

#include <vector>

namespace mocurate {

/// How sure it is that `better` is better than `worse`, in [0, 1]: that the mean of the moments' differences is above
/// 0, by their standard error.
double Confidence(const std::vector<double>& worse, const std::vector<double>& better);

/// Share of a normal distribution below z.
double NormalShare(double z);

}  // namespace mocurate
