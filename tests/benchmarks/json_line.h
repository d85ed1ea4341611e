#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <functional>
#include <vector>

namespace mocurate::benchmarks {

/// Runs `work` once as a warm-up, then `repeats` times, and prints one JSON line with the median.
inline void Report(const char* name, double items, const char* unit, int repeats, const std::function<void()>& work,
                   int threads = 1) {
  work();
  std::vector<double> seconds, cpu_seconds;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    const std::clock_t cpu_begin = std::clock();
    work();
    cpu_seconds.push_back(static_cast<double>(std::clock() - cpu_begin) / CLOCKS_PER_SEC);
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  std::sort(seconds.begin(), seconds.end());
  std::sort(cpu_seconds.begin(), cpu_seconds.end());
  const double median = seconds[seconds.size() / 2];
  std::printf(
      "{\"name\": \"%s\", \"seconds_median\": %.6f, \"seconds_min\": %.6f, \"cpu_seconds_median\": %.6f, \"repeats\": "
      "%d, \"items\": %.9g, "
      "\"unit\": \"%s\", \"items_per_s\": %.3f, \"threads\": %d}\n",
      name, median, seconds.front(), cpu_seconds[cpu_seconds.size() / 2], repeats, items, unit, items / median,
      threads);
}

}  // namespace mocurate::benchmarks
