// parallel_for: independent jobs on a few threads, each writing to its own slot.
#include "snug/core/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace snug {

int core_count() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

void parallel_for(int count, int threads, const std::function<void(int, int)>& job) {
  std::atomic<int> next{0};
  std::atomic<bool> has_failed{false};
  std::mutex mutex;
  std::exception_ptr error;
  int failed = count;
  const auto work = [&](int worker) {
    // Indices are handed out in order: when one fails, all below it have been begun, and say so if they fail too.
    while (!has_failed) {
      const int index = next++;
      if (index >= count) return;
      try {
        job(index, worker);
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (index < failed) {
          failed = index;
          error = std::current_exception();
        }
        has_failed = true;
      }
    }
  };
  std::vector<std::thread> helpers;
  try {
    for (int worker = 1; worker < std::min(threads, count); ++worker) helpers.emplace_back(work, worker);
  } catch (const std::system_error&) {  // no more threads: those that there are do it
  }
  work(0);
  for (std::thread& helper : helpers) helper.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace snug
