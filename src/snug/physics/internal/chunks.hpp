// Chunks: loops over bodies, pairs or patches that the threads of a pool share.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "snug/core/worker_pool.hpp"

namespace snug::physics::internal {

/// Below it a loop is not shared: it takes about as long as to hand it over.
constexpr std::size_t kLeastShared = 512;
constexpr std::size_t kChunk = 128;  ///< whatever the number of threads

inline bool is_shared(const WorkerPool& pool, std::size_t count) { return pool.size() > 1 && count >= kLeastShared; }

/// Calls job(first, end) for ranges that make up 0 .. count-1 and may be done side by side.
template <class Job>
void for_ranges(WorkerPool& pool, std::size_t count, const Job& job) {
  if (!is_shared(pool, count)) return job(std::size_t{0}, count);
  pool.run(static_cast<int>((count + kChunk - 1) / kChunk), [&](int chunk, int) {
    const std::size_t first = kChunk * static_cast<std::size_t>(chunk);
    job(first, std::min(count, first + kChunk));
  });
}

/// nullptr: one thread.
template <class Job>
void for_ranges(WorkerPool* pool, std::size_t count, const Job& job) {
  pool != nullptr ? for_ranges(*pool, count, job) : job(std::size_t{0}, count);
}

/// The largest of value(first, end) over such ranges, and of 0.
template <class Value>
double largest_of_ranges(WorkerPool* pool, std::size_t count, const Value& value) {
  std::atomic<double> largest{0.0};
  for_ranges(pool, count, [&](std::size_t first, std::size_t end) {
    const double mine = value(first, end);
    double most = largest;
    while (mine > most && !largest.compare_exchange_weak(most, mine)) {
    }
  });
  return largest;
}

}  // namespace snug::physics::internal
