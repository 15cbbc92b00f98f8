// WorkerPool: threads that wait for short jobs, for work that comes thousands of times a second.
#include "snug/core/worker_pool.hpp"

#include <algorithm>
#include <chrono>
#include <system_error>

namespace snug {
namespace {

/// Waiting without sleep: to wake a thread takes as long as many a run. Long enough for what is done between the runs
/// of one step of physics.
constexpr std::chrono::microseconds kAwake{1000};
/// Times that a condition is asked, some 8 us, before the thread yields for the first time: a call to yield takes about
/// as long as a short job.
constexpr int kAtOnce = 10000;

/// Whether the condition held within kAwake. Gives way to whatever else wants the core.
template <class Condition>
bool await(const Condition& condition) {
  for (int i = 0; i < kAtOnce; ++i) {
    if (condition()) return true;
  }
  const auto end = std::chrono::steady_clock::now() + kAwake;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

}  // namespace

WorkerPool::WorkerPool(int threads) : shares_(static_cast<std::size_t>(std::max(threads, 1))) {
  try {
    for (int worker = 1; worker < threads; ++worker) helpers_.emplace_back([this, worker] { help(worker); });
  } catch (const std::system_error&) {  // no more threads: those that there are do it
  }
}

WorkerPool::~WorkerPool() {
  is_over_ = true;
  wake(helpers_asleep_, has_work_);
  for (std::thread& helper : helpers_) helper.join();
}

/// Whoever fell asleep before it could see the change that the caller has made.
void WorkerPool::wake(const std::atomic<int>& asleep, std::condition_variable& condition) {
  if (asleep == 0) return;
  { const std::lock_guard lock(mutex_); }
  condition.notify_all();
}

template <class Condition>
void WorkerPool::sleep_until(std::atomic<int>& asleep, std::condition_variable& changed, const Condition& condition) {
  std::unique_lock lock(mutex_);
  ++asleep;  // before the condition is read again: who changes it after that sees this
  changed.wait(lock, condition);
  --asleep;
}

void WorkerPool::take_indices(int worker) {
  const std::size_t count = shares_.size(), first = static_cast<std::size_t>(worker);
  for (std::size_t k = 0; k < count; ++k) {
    Share& share = shares_[(first + k) % count];
    for (int index = share.next++; index < share.end; index = share.next++) function_(context_, index, worker);
  }
}

void WorkerPool::run_erased(int count, Function function, const void* context) noexcept {
  if (helpers_.empty() || count < 2) {
    for (int index = 0; index < count; ++index) function(context, index, 0);
    return;
  }
  function_ = function, context_ = context;
  int begin = 0;
  for (int left = static_cast<int>(shares_.size()); Share & share : shares_) {
    share.next = begin;
    share.end = begin += (count - begin + left - 1) / left;
    --left;
  }
  state_ += kOpen;  // the helpers see all of the above
  wake(helpers_asleep_, has_work_);
  take_indices(0);
  state_ += kOpen;  // no helper begins from here on
  const auto has_ended = [this] { return state_ % kOpen == 0; };
  if (!await(has_ended)) sleep_until(callers_asleep_, has_ended_, has_ended);
}

/// Counts the helper among those at work, if the run with this state is still open.
bool WorkerPool::join_run(std::uint64_t state) {
  while (is_open(state)) {
    if (state_.compare_exchange_weak(state, state + 1)) return true;
  }
  return false;
}

void WorkerPool::help(int worker) {
  std::uint64_t last = 0;  // number of the run that it worked at
  const auto has_work = [&] {
    const std::uint64_t state = state_;
    return is_over_ || (is_open(state) && state / kOpen != last);
  };
  while (true) {
    if (!await(has_work)) sleep_until(helpers_asleep_, has_work_, has_work);
    if (is_over_) return;
    std::uint64_t state = state_;
    if (!join_run(state)) continue;
    last = state_ / kOpen;
    take_indices(worker);
    if (--state_ % kOpen == 0) wake(callers_asleep_, has_ended_);
  }
}

}  // namespace snug
