// parallel_for: every job once, and what is thrown is thrown to the caller, the same at any number of threads.
#include "snug/core/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

namespace snug {
namespace {

TEST(ParallelFor, DoesEveryJobOnceAtAnyNumberOfThreads) {
  for (const int count : {0, 1, 2, 100}) {
    for (const int threads : {-1, 0, 1, 2, 7, 1000}) {
      std::vector<int> done(static_cast<std::size_t>(count), 0);
      parallel_for(count, threads, [&](int i, int) { ++done[static_cast<std::size_t>(i)]; });
      EXPECT_EQ(done, std::vector<int>(static_cast<std::size_t>(count), 1)) << threads;
    }
  }
}

TEST(ParallelFor, NeverRunsAWorkerTwiceAtATime) {
  std::vector<std::atomic<int>> busy(4);
  std::atomic<int> most{0};
  parallel_for(2000, 4, [&](int, int worker) {
    const int now = ++busy.at(static_cast<std::size_t>(worker));
    if (now > most) most = now;
    --busy[static_cast<std::size_t>(worker)];
  });
  EXPECT_EQ(most, 1);
}

TEST(ParallelFor, ThrowsTheExceptionOfTheLowestIndexAndBeginsNothingAfterIt) {
  for (const int threads : {1, 2, 8}) {
    for (int round = 0; round < 50; ++round) {
      std::atomic<int> begun{0};
      std::string caught;
      try {
        parallel_for(1000, threads, [&](int i, int) {
          ++begun;
          if (i % 10 == 3) throw std::runtime_error(std::to_string(i));
        });
      } catch (const std::runtime_error& error) {
        caught = error.what();
      }
      EXPECT_EQ(caught, "3");
      EXPECT_LT(begun, 1000);
    }
  }
}

}  // namespace
}  // namespace snug
