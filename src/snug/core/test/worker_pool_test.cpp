// WorkerPool: every index once, by workers within range, as often as asked.
#include "snug/core/worker_pool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace snug {
namespace {

TEST(WorkerPool, DoesEveryIndexOnceAtAnyNumberOfThreads) {
  for (const int threads : {-3, 0, 1, 2, 5}) {
    SCOPED_TRACE(threads);
    WorkerPool pool(threads);
    ASSERT_GE(pool.size(), 1);
    ASSERT_LE(pool.size(), std::max(1, threads));
    for (const int count : {0, 1, 2, 3, 100}) {
      std::vector<std::atomic<int>> done(static_cast<std::size_t>(count));
      std::atomic<bool> is_in_range{true};
      pool.run(count, [&](int index, int worker) {
        ++done[static_cast<std::size_t>(index)];
        if (worker < 0 || worker >= pool.size()) is_in_range = false;
      });
      for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
      EXPECT_TRUE(is_in_range);
    }
  }
}

TEST(WorkerPool, HasNoWorkerTwiceAtATimeAndEndsBeforeItReturns) {
  WorkerPool pool(4);
  for (int round = 0; round < 2000; ++round) {
    std::atomic<int> done{0};
    std::vector<std::atomic<int>> at_work(4);
    std::atomic<bool> is_twice{false};
    pool.run(8, [&](int, int worker) {
      std::atomic<int>& mine = at_work[static_cast<std::size_t>(worker)];
      if (++mine != 1) is_twice = true;
      ++done;
      --mine;
    });
    ASSERT_EQ(done, 8);
    ASSERT_FALSE(is_twice);
  }
}

}  // namespace
}  // namespace snug
