// Ctrl-C: the first one is a call or a flag, in order.
#include "snug/commands/stop_signal.hpp"

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <future>

namespace snug::commands {
namespace {

TEST(StopSignal, CallsFromAThreadOfItsOwnAndCanBeMadeAgain) {
  for (const int signal : {SIGINT, SIGTERM}) {
    std::promise<std::thread::id> stopped;
    const StopSignal stop([&] { stopped.set_value(std::this_thread::get_id()); });
    ::raise(signal);
    auto future = stopped.get_future();
    ASSERT_EQ(future.wait_for(std::chrono::seconds(60)), std::future_status::ready);
    EXPECT_NE(future.get(), std::this_thread::get_id());
  }
}

TEST(StopSignal, ThatNobodySentIsCalledAtItsEnd) {
  int calls = 0;
  {
    const StopSignal stop([&] { ++calls; });
  }
  EXPECT_EQ(calls, 1) << "its thread ends with it";
}

TEST(CatchInterrupts, SetsAFlagAndLeavesTheSecondSignalAsItWas) {
  const auto run = [] {
    catch_interrupts();
    if (is_interrupted()) std::exit(9);
    ::raise(SIGTERM);
    if (!is_interrupted()) std::exit(9);
    ::raise(SIGTERM);
    std::exit(0);
  };
  EXPECT_EXIT(run(), testing::KilledBySignal(SIGTERM), "");
}

}  // namespace
}  // namespace snug::commands
