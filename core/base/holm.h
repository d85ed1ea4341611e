#pragma once

#include <vector>

namespace mocurate {

/// Holm's step-down correction of the p of several tests, in their order; at most 1. [Holm 1979]
std::vector<double> HolmCorrected(const std::vector<double>& p);

}  // namespace mocurate
