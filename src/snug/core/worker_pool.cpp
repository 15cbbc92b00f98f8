// WorkerPool: threads that wait for short jobs, for work that comes thousands of times a second.
#include "snug/core/worker_pool.hpp"

#include <system_error>

namespace snug {

WorkerPool::WorkerPool(int threads) {
  try {
    for (int worker = 1; worker < threads; ++worker) helpers_.emplace_back([this, worker] { help(worker); });
  } catch (const std::system_error&) {  // no more threads: those that there are do it
  }
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  has_work_.notify_all();
  for (std::thread& helper : helpers_) helper.join();
}

/// Works on indices until there are none; the lock is held outside of the jobs.
void WorkerPool::take_indices(std::unique_lock<std::mutex>& lock, int worker) {
  while (next_ < count_) {
    const int index = next_++;
    const Function function = function_;
    const void* const context = context_;
    lock.unlock();
    function(context, index, worker);
    lock.lock();
  }
}

void WorkerPool::run_erased(int count, Function function, const void* context) noexcept {
  if (helpers_.empty() || count < 2) {
    for (int index = 0; index < count; ++index) function(context, index, 0);
    return;
  }
  std::unique_lock lock(mutex_);
  function_ = function, context_ = context;
  next_ = 0, count_ = count;
  has_work_.notify_all();
  take_indices(lock, 0);
  has_ended_.wait(lock, [this] { return busy_ == 0; });
  function_ = nullptr;
}

void WorkerPool::help(int worker) {
  std::unique_lock lock(mutex_);
  while (true) {
    has_work_.wait(lock, [this] { return is_over_ || (function_ != nullptr && next_ < count_); });
    if (is_over_) return;
    ++busy_;
    take_indices(lock, worker);
    if (--busy_ == 0) has_ended_.notify_one();
  }
}

}  // namespace snug
