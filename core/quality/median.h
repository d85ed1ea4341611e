#pragma once

#include <algorithm>
#include <vector>

namespace mocurate {

/// The value in the middle, the upper of two; 0 of none. Any unit.
inline double Median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace mocurate
