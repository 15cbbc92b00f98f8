// WorkerPool: threads that wait for short jobs, for work that comes thousands of times a second.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

namespace snug {

/// Threads are started once, where parallel_for() starts them with each call. run() allocates nothing.
class WorkerPool {
 public:
  /// `threads` counts the one that calls run(); with 1 there is no other. Fewer where the system gives no more.
  explicit WorkerPool(int threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Workers that may be at work at a time, the caller being worker 0.
  [[nodiscard]] int size() const { return 1 + static_cast<int>(helpers_.size()); }

  /// Calls job(index, worker) once for each index 0 .. count-1 and returns when all have ended. Each worker begins with
  /// its share of the indices, the same from call to call, so that what it works on stays in its cache; then it takes
  /// what others have left. Jobs must not throw; not to be called from within one.
  template <class Job>
  void run(int count, const Job& job) noexcept {
    run_erased(
        count, [](const void* context, int index, int worker) { (*static_cast<const Job*>(context))(index, worker); },
        &job);
  }

 private:
  using Function = void (*)(const void* context, int index, int worker);
  void run_erased(int count, Function function, const void* context) noexcept;
  void help(int worker);
  void take_indices(int worker);
  bool join_run(std::uint64_t state);
  void wake(const std::atomic<int>& asleep, std::condition_variable& condition);
  template <class Condition>
  void sleep_until(std::atomic<int>& asleep, std::condition_variable& changed, const Condition& condition);

  /// state_: twice the number of runs that have ended, one more while one is open to helpers; below it helpers at work.
  static constexpr std::uint64_t kOpen = 1 << 16;
  /// Indices that nobody has taken yet.
  struct alignas(64) Share {
    std::atomic<int> next{0};
    int end = 0;
  };
  static bool is_open(std::uint64_t state) { return state / kOpen % 2 == 1; }

  Function function_ = nullptr;
  const void* context_ = nullptr;
  std::vector<Share> shares_;  ///< one of each worker
  alignas(64) std::atomic<std::uint64_t> state_{0};
  std::atomic<bool> is_over_{false};
  std::atomic<int> helpers_asleep_{0}, callers_asleep_{0};
  std::mutex mutex_;
  std::condition_variable has_work_, has_ended_;
  std::vector<std::thread> helpers_;
};

}  // namespace snug
