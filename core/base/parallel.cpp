#include "core/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace mocurate {

void ParallelFor(int count, int chunk, int threads, const std::function<void(int begin, int end)>& work) {
  std::atomic<int> next{0};
  const auto take = [&] {
    for (int begin = next.fetch_add(chunk); begin < count; begin = next.fetch_add(chunk)) {
      work(begin, std::min(begin + chunk, count));
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(take);
  take();
  for (std::thread& other : others) other.join();
}

}  // namespace mocurate
