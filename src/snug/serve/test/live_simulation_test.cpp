// LiveSimulation: what a run gives and throws comes to who waits for it; a log that is full stops no run.
#include "snug/serve/live_simulation.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <future>

#include "snug/core/input_error.hpp"

namespace snug::serve {
namespace {

model::Scenario drop() { return model::load_scenario(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/drop.yaml"); }

TEST(LiveSimulation, GivesItsResultWithoutHowLongItTook) {
  LiveRun live("drop", 0.0);
  runs::RunOptions options;
  options.until = 0.1;
  LiveSimulation simulation(drop(), options, live);
  simulation.start([] { ADD_FAILURE() << "no trouble"; });
  for (std::size_t i = 0; !live.is_over(); ++i) (void)live.wait_for(i, std::chrono::seconds(10));
  const runs::RunResult& result = simulation.result();
  EXPECT_FALSE(result.failure);
  EXPECT_EQ(describe_watched(result).find("wall_s"), std::string::npos);
  EXPECT_EQ(describe_watched(result).find("real_time_factor"), std::string::npos);
}

TEST(LiveSimulation, ThrowsAgainWhatTheRunThrew) {
  LiveRun live("drop", 0.0);
  runs::RunOptions options;
  options.program = motion::Program{};
  options.sequence = "no such sequence";
  LiveSimulation simulation(drop(), options, live);
  std::promise<void> told;
  simulation.start([&] { told.set_value(); });
  told.get_future().wait();
  EXPECT_TRUE(live.is_over());
  EXPECT_THROW((void)simulation.result(), InputError);
}

TEST(ShownRun, GoesOnWhenItIsShownNoMore) {
  LiveRun live("drop", 0.0);
  ShownRun shown(live);
  record::RecordingHeader header;
  shown.begin(header);
  live.stop();
  EXPECT_TRUE(shown.add(record::Frame{}));
  EXPECT_TRUE(shown.add(record::Frame{}));
}

}  // namespace
}  // namespace snug::serve
