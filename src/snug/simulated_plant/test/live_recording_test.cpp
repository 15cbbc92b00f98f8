// LiveRecording: the file grows with the plant's ticks, holds what happened, and changes nothing of it.
#include "snug/simulated_plant/live_recording.hpp"

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

/// The program that these motions are.
motion::Program live(SimulatedPlant& plant) {
  (void)pack(plant, "BOX027");
  plant.acknowledge();
  plant::Motion rest = packing_of("BOX027");
  rest.waypoints.erase(rest.waypoints.begin(), rest.waypoints.begin() + 3);
  (void)plant::run(plant, rest);
  (void)plant::observe(plant, {});
  (void)pack(plant, "BOX028");
  motion::Program program{"pack", packing_of("BOX027").waypoints, plant.simulation().options().tracking};
  for (const plant::Motion& motion : {rest, packing_of("BOX028")}) {
    program.waypoints.insert(program.waypoints.end(), motion.waypoints.begin(), motion.waypoints.end());
  }
  return program;
}

struct LiveRecordingTest : testing::Test {
  /// Of a new plant that lives.
  runs::RunResult record_to(const std::string& name, const RecordingEnd& end = {}) {
    OutputFile file(folder / name);
    LiveRecordingOptions options;
    options.file = &file;
    options.version = "test";
    plant.emplace(three_boxes(), "1", eventful());
    LiveRecording recording(*plant, three_boxes(), options);
    recording.note({0.0, "send", "BOX027", "first", {}});
    program = live(*plant);
    recording.note({plant->read().time, "note", "", "second", {}});
    return recording.close(end);
  }
  std::optional<SimulatedPlant> plant;
  motion::Program program;
  const snug::test::ScratchFolder folder;
};

TEST_F(LiveRecordingTest, ChangesNothingOfWhatHappens) {
  const runs::RunResult result = record_to("run.h5");
  SimulatedPlant unseen(three_boxes(), "1", eventful());
  (void)live(unseen);
  EXPECT_EQ(result.state_hash, unseen.simulation().hash(unseen.state()));
  EXPECT_EQ(result.duration, unseen.read().time);
  ASSERT_EQ(result.boxes.size(), unseen.boxes().size());
  for (std::size_t i = 0; i < result.boxes.size(); ++i) {
    EXPECT_EQ(result.boxes[i].X_TP, unseen.boxes()[i].X_TP);
    EXPECT_EQ(result.boxes[i].state, cell::BoxState::Packed);
  }
  const model::Container& container = *model::find_container(three_boxes(), "tote1");
  EXPECT_EQ(result.filling_degree_percent,
            model::compute_filling_degree_percent(three_boxes(), container, {"BOX027", "BOX028"}));
}

TEST_F(LiveRecordingTest, TheFileHasAFrameForEachTickAndEventsInTheOrderOfTime) {
  RecordingEnd end;
  end.describe = [](const runs::RunResult& one) { return "{\"boxes\": " + std::to_string(one.boxes.size()) + "}"; };
  const runs::RunResult result = record_to("run.h5", end);
  const record::Recording recording = record::load_recording(folder / "run.h5");
  EXPECT_TRUE(recording.is_complete);
  EXPECT_EQ(recording.result, "{\"boxes\": 2}");
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

TEST_F(LiveRecordingTest, KeepsTheProgramThatWasSentAndWhereInItEachFrameIs) {
  (void)record_to("run.h5");
  const record::Recording recording = record::load_recording(folder / "run.h5");
  EXPECT_EQ(recording.header.program_text, motion::format_program(program));
  EXPECT_EQ(recording.frames.back().program_row + 1, static_cast<int>(program.waypoints.size()));
  EXPECT_TRUE(std::ranges::is_sorted(recording.frames, {}, &record::Frame::program_row));
}

TEST_F(LiveRecordingTest, OneThatWasInterruptedSaysSo) {
  RecordingEnd end;
  end.ended_by = "the test";
  end.is_interrupted = true;
  EXPECT_TRUE(record_to("run.h5", end).is_interrupted);
  const record::RecordingReader reader(folder / "run.h5");
  EXPECT_FALSE(reader.is_complete());
  EXPECT_TRUE(reader.is_interrupted());
}

/// As a copy of the file is read in the middle of a motion: what a killed process leaves is record's to test.
TEST_F(LiveRecordingTest, IsInTheFileUpToASecondBeforeAtAnyTime) {
  OutputFile file(folder / "run.h5");
  LiveRecordingOptions options;
  options.file = &file;
  SimulatedPlantOptions slow = eventful();
  slow.simulation.tracking = motion::FastTracking{0.5};
  SimulatedPlant growing(three_boxes(), "1", slow);
  LiveRecording recording(growing, three_boxes(), options);
  const std::string sent = motion::format_program({"", packing_of("BOX027").waypoints, slow.simulation.tracking});
  int looks = 0;
  (void)pack(growing, "BOX027", [&](const cell::CellTick&) {
    const double now = growing.read().time;
    if (now < 1.1 * ++looks) return void(--looks);
    const record::RecordingReader reader(folder / "run.h5");
    EXPECT_GE(reader.times().back(), now - 1.0 - 1e-9);
    EXPECT_FALSE(reader.is_complete());
    EXPECT_EQ(reader.header().program_text, sent);
  });
  EXPECT_GE(looks, 2);
}

TEST_F(LiveRecordingTest, NothingThatWasSentIsNoFile) {
  {
    OutputFile file(folder / "run.h5");
    LiveRecordingOptions options;
    options.file = &file;
    SimulatedPlant still(three_boxes(), "1", eventful());
    const LiveRecording recording(still, three_boxes(), options);
    EXPECT_TRUE(plant::bring_and_wait(still, model::ParcelId("BOX027")));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// The second box comes, and the first is moved aside by a fault, while the tool leaves the first.
TEST(PerceivedWhileItMoves, WhatAFaultDoesToABoxThatWasLetGoIsDoneBefore) {
  SimulatedPlantOptions options = nominal("displace@1");
  options.seed = 4;
  SimulatedPlant plant(three_boxes(), "1", options);
  ASSERT_TRUE(plant::bring_and_wait(plant, model::ParcelId("BOX027")));
  plant::Motion motion = packing_of("BOX027");
  motion.perceive_after = motion::WaypointIndex(motion.waypoints.size() - 1);
  motion::Waypoint away = motion.waypoints.front();
  away.motion_class = motion::MotionClass::PostPlace;
  motion.waypoints.push_back(away);
  plant.start(motion);
  std::size_t faults = 0;
  while (plant.is_moving()) {
    for (const plant::Event& event : plant.advance()) {
      const auto* passed = plant::get<plant::WaypointPassed>(event);
      if (passed == nullptr || passed->waypoint != motion.perceive_after) continue;
      faults = fault_events(plant).size();
      EXPECT_TRUE(plant.bring(model::ParcelId("BOX028")));
    }
  }
  EXPECT_EQ(faults, 1U);
  EXPECT_EQ(fault_events(plant).size(), 1U);
}

}  // namespace
}  // namespace snug::simulated_plant
