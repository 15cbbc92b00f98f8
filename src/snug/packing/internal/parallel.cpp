// share_out: threads that take the next job.
#include "snug/packing/internal/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace snug::packing::internal {

void share_out(int count, int threads, const std::function<void(int, int)>& job) {
  const int crew_size = std::min(threads, count);
  if (crew_size <= 1) {
    for (int i = 0; i < count; ++i) job(i, 0);
    return;
  }
  std::atomic<int> next{0};
  std::vector<std::thread> crew;
  for (int t = 0; t < crew_size; ++t) {
    crew.emplace_back([&, t] {
      for (int i = next++; i < count; i = next++) job(i, t);
    });
  }
  for (std::thread& worker : crew) worker.join();
}

}  // namespace snug::packing::internal
