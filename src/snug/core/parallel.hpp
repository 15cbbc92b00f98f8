// parallel_for: independent jobs on a few threads, each writing to its own slot.
#pragma once

#include <functional>

namespace snug {

/// Threads that this machine runs at a time, at least 1.
[[nodiscard]] int core_count();

/// Calls job(index, worker) once for each index 0 .. count-1; worker is below max(1, threads) and never at work twice
/// at a time, the calling thread being worker 0. Fewer threads are used where the system gives no more. When jobs
/// throw, no further ones are begun, and the exception of the lowest index is thrown again after all have ended: which
/// one does not depend on the number of threads.
void parallel_for(int count, int threads, const std::function<void(int index, int worker)>& job);

}  // namespace snug
