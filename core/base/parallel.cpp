#include "core/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace mocurate {

void ParallelFor(int count, int chunk, int threads, const std::function<void(int begin, int end)>& work) {
  std::atomic<int> next{0};
  std::mutex guard;
  std::exception_ptr thrown;
  int thrown_at = count;  // the lowest range that threw: which one is reported does not depend on the threads
  const auto take = [&] {
    for (int begin = next.fetch_add(chunk); begin < count; begin = next.fetch_add(chunk)) {
      try {
        work(begin, std::min(begin + chunk, count));
      } catch (...) {
        const std::lock_guard<std::mutex> held(guard);
        if (begin < thrown_at) {
          thrown = std::current_exception();
          thrown_at = begin;
        }
      }
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(take);
  take();
  for (std::thread& other : others) other.join();
  if (thrown) std::rethrow_exception(thrown);
}

}  // namespace mocurate
