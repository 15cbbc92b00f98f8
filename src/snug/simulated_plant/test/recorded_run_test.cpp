// RecordedRun: the same calls once more come to the same state, and a file holds what happened.
#include "snug/simulated_plant/recorded_run.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "snug/core/output_file.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/record/reader.hpp"
#include "snug/simulated_plant/test/demo_rows.hpp"

namespace snug::simulated_plant {
namespace {

using namespace test;

/// Two items, one of which falls, and a stop that is acknowledged.
SimulatedPlantOptions eventful() {
  SimulatedPlantOptions options = nominal("stop@1,displace@2");
  options.seed = 4;
  return options;
}

void live(SimulatedPlant& plant) {
  (void)pack(plant, "BOX027");
  plant.acknowledge();
  plant::Motion rest = packing_of("BOX027");
  rest.waypoints.erase(rest.waypoints.begin(), rest.waypoints.begin() + 3);
  (void)plant.submit(rest);
  (void)plant.perceive({});
  (void)pack(plant, "BOX028");
}

struct RecordedRunTest : testing::Test {
  RecordedRunTest() { live(plant); }
  [[nodiscard]] runs::RunResult record_to(const std::string& name, RecordedRunOptions options = {}) const {
    OutputFile file(folder / name);
    options.file = &file;
    return record(three_boxes(), "1", eventful(), plant.calls(), options);
  }
  SimulatedPlant plant{three_boxes(), "1", eventful()};
  const snug::test::ScratchFolder folder;
};

TEST_F(RecordedRunTest, ComesToTheSameStateAsThePlant) {
  const runs::RunResult result = record_to("run.h5");
  EXPECT_EQ(result.state_hash, plant.simulation().hash(plant.state()));
  EXPECT_EQ(result.duration, plant.read().time);
  ASSERT_EQ(result.boxes.size(), plant.boxes().size());
  for (std::size_t i = 0; i < result.boxes.size(); ++i) {
    EXPECT_EQ(result.boxes[i].X_TP, plant.boxes()[i].X_TP);
    EXPECT_EQ(result.boxes[i].state, cell::BoxState::Packed);
  }
  const model::Container& container = *model::find_container(three_boxes(), "tote1");
  EXPECT_EQ(result.filling_degree_percent,
            model::compute_filling_degree_percent(three_boxes(), container, {"BOX027", "BOX028"}));
}

TEST_F(RecordedRunTest, TheFileHasAFrameForEachTickAndEventsInTheOrderOfTime) {
  RecordedRunOptions options;
  options.version = "test";
  options.events = {{0.5, "send", "BOX027", "first", {}}, {3.0, "note", "", "second", {}}};
  options.describe = [](const runs::RunResult& one) { return "{\"boxes\": " + std::to_string(one.boxes.size()) + "}"; };
  const runs::RunResult result = record_to("run.h5", options);
  const record::Recording recording = record::load_recording(folder / "run.h5");
  EXPECT_TRUE(recording.is_complete);
  const double tick = three_boxes().controller.tick;
  EXPECT_NEAR(static_cast<double>(recording.frames.size()), result.duration / tick, 2.0);
  for (std::size_t i = 1; i < recording.frames.size(); ++i) {
    EXPECT_NEAR(recording.frames[i].time - recording.frames[i - 1].time, tick, 1e-9) << i;
  }
  EXPECT_TRUE(std::ranges::is_sorted(recording.events, {}, &record::Event::time));
  const auto count = [&](const std::string& kind) {
    return std::ranges::count(recording.events, kind, &record::Event::kind);
  };
  EXPECT_EQ(count("send"), 1);
  EXPECT_EQ(count("note"), 1);
  EXPECT_EQ(count("fault"), 2);
  EXPECT_EQ(result.events.size(), recording.events.size());
}

TEST_F(RecordedRunTest, OneThatWasInterruptedSaysSo) {
  RecordedRunOptions options;
  options.is_interrupted = true;
  EXPECT_TRUE(record_to("run.h5", options).is_interrupted);
  const record::RecordingReader reader(folder / "run.h5");
  EXPECT_FALSE(reader.is_complete());
  EXPECT_TRUE(reader.is_interrupted());
}

/// The second box comes, and the first is moved aside by a fault, while the tool leaves the first.
TEST_F(RecordedRunTest, WhatHappenedWhileTheToolPassedAWaypointHappensAgain) {
  SimulatedPlantOptions options = nominal("displace@1");
  options.seed = 4;
  SimulatedPlant moving(three_boxes(), "1", options);
  ASSERT_TRUE(moving.bring("BOX027"));
  plant::Motion motion = packing_of("BOX027");
  const int over = static_cast<int>(motion.waypoints.size()) - 1;
  motion::Waypoint away = motion.waypoints.front();
  away.motion_class = motion::MotionClass::PostPlace;
  motion.waypoints.push_back(away);
  int faults = 0;
  (void)moving.submit(motion, {over, [&] {
                                 const auto& events = moving.state().event_log.events();
                                 faults = static_cast<int>(std::ranges::count(events, "fault", &record::Event::kind));
                                 EXPECT_TRUE(moving.bring("BOX028"));
                               }});
  EXPECT_EQ(faults, 1) << "what a fault does to a box that was let go is done before it is looked at";
  ASSERT_EQ(moving.calls().size(), 3U);
  EXPECT_EQ(moving.calls()[1].passed, over);
  EXPECT_EQ(moving.calls()[2].passed, over);
  SimulatedPlant again(three_boxes(), "1", options);
  repeat(again, moving.calls());
  EXPECT_EQ(again.simulation().hash(again.state()), moving.simulation().hash(moving.state()));
  EXPECT_EQ(again.read().time, moving.read().time);
}

TEST_F(RecordedRunTest, RunsTwiceToTheSameFile) {
  (void)record_to("one.h5");
  (void)record_to("two.h5");
  const record::Recording one = record::load_recording(folder / "one.h5"),
                          two = record::load_recording(folder / "two.h5");
  ASSERT_EQ(one.frames.size(), two.frames.size());
  EXPECT_EQ(one.events, two.events);
}

TEST_F(RecordedRunTest, WithoutCallsIsAnEmptyCell) {
  OutputFile file(folder / "empty.h5");
  RecordedRunOptions options;
  options.file = &file;
  const runs::RunResult result = record(three_boxes(), "1", eventful(), {}, options);
  EXPECT_EQ(result.duration, 0.0);
  EXPECT_TRUE(result.boxes.empty());
  EXPECT_EQ(result.filling_degree_percent, 0.0);
}

}  // namespace
}  // namespace snug::simulated_plant
