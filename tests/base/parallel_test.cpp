// Work on several threads: every range once, and an exception reaches the caller.

#include "core/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

namespace mocurate {
namespace {

TEST(ParallelFor, TakesEveryRangeOnce) {
  std::vector<std::atomic<int>> seen(1000);
  ParallelFor(1000, 7, 4, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) ++seen[static_cast<std::size_t>(i)];
  });
  for (const std::atomic<int>& count : seen) EXPECT_EQ(count, 1);
}

TEST(ParallelFor, OfTheRangesThatThrowTheLowestIsReported) {
  for (const int threads : {1, 2, 4}) {
    try {
      ParallelFor(8, 1, threads, [](int begin, int) {
        if (begin >= 3) throw std::runtime_error(std::to_string(begin));
      });
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "3");
    }
  }
}

}  // namespace
}  // namespace mocurate
