#pragma once

#include <functional>

namespace mocurate {

/// Calls `work(begin, end)` for the ranges of `chunk` numbers that [0, count) is cut into, on `threads` threads of
/// which the caller is one. The assignment of ranges to threads is unspecified: a result must not depend on it.
void ParallelFor(int count, int chunk, int threads, const std::function<void(int begin, int end)>& work);

}  // namespace mocurate
