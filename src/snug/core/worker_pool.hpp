// WorkerPool: threads that wait for short jobs, for work that comes thousands of times a second.
#pragma once

#include <condition_variable>
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

  /// Calls job(index, worker) once for each index 0 .. count-1, in an order and by workers that differ from call to
  /// call, and returns when all have ended. Jobs must not throw; not to be called from within one.
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
  void take_indices(std::unique_lock<std::mutex>& lock, int worker);

  std::mutex mutex_;
  std::condition_variable has_work_, has_ended_;
  Function function_ = nullptr;  ///< nullptr: nothing to do
  const void* context_ = nullptr;
  int count_ = 0, next_ = 0;
  int busy_ = 0;  ///< helpers at work
  bool is_over_ = false;
  std::vector<std::thread> helpers_;
};

}  // namespace snug
