// Trial: what a session in a drawn plant promises, on the demonstrator's cell.
#include "snug/study/trial.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/model/other_container.hpp"
#include "snug/model/test/shortened.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/record/reader.hpp"
#include "snug/runs/recorder.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/runs/run.hpp"
#include "snug/study/monte_carlo.hpp"
#include "snug/study/witness.hpp"

namespace snug::study {
namespace {

using session::ItemEnd;
using session::SessionOptions;
using session::StopReason;
using simulated_plant::SimulatedPlantOptions;

using model::test::shortened;

SessionOptions quick(int samples = 2) {
  SessionOptions options;
  options.decision.time = 0.05;
  options.samples = samples;
  return options;
}

SimulatedPlantOptions plant_seed(std::uint64_t seed) {
  SimulatedPlantOptions options;
  options.seed = seed;
  return options;
}

TEST(CountedBoxes, LeavesOutWhatTheCheckOfTheFinishedLoadRejected) {
  const auto box = [](const char* id, cell::BoxState state) {
    cell::BoxResult result;
    result.id = id;
    result.state = state;
    return result;
  };
  const auto item = [](const char* id, ItemEnd end) {
    session::ItemReport report;
    report.id = id;
    report.end = end;
    return report;
  };
  const std::vector<cell::BoxResult> boxes = {box("A", cell::BoxState::Packed), box("B", cell::BoxState::Packed),
                                              box("C", cell::BoxState::Lost)};
  session::SessionResult session;
  session.items = {item("A", ItemEnd::Placed), item("B", ItemEnd::Rejected), item("C", ItemEnd::Gone)};
  EXPECT_EQ(counted_boxes(boxes, session), std::vector<std::string>{"A"});
}

TEST(Trial, PacksADrawnPlantAndIsTheSameWithAnyNumberOfThreads) {
  const model::Scenario scenario = shortened(2);
  SessionOptions options = quick();
  const Trial one = run_trial(scenario, "1", options, plant_seed(7));
  EXPECT_EQ(one.executed_boxes, 2) << one.session.stopped;
  EXPECT_EQ(one.items_sent, 2);
  EXPECT_EQ(one.items_as_planned, 2);
  EXPECT_EQ(one.boxes_lost, 0);
  EXPECT_EQ(one.session.stop_reason, StopReason::AllPacked);
  options.threads = options.decision.threads = 2;
  const Trial two = run_trial(scenario, "1", options, plant_seed(7));
  EXPECT_EQ(motion::format_program(one.session.program), motion::format_program(two.session.program));
  EXPECT_EQ(one.state_hash, two.state_hash);
  EXPECT_NE(run_trial(scenario, "1", options, plant_seed(8)).state_hash, one.state_hash) << "another plant";
}

TEST(Trial, IsTheSameRecordedAndItsRecordingHoldsWhatTheSessionSays) {
  const model::Scenario scenario = shortened(2);
  const Trial unseen = run_trial(scenario, "1", quick(0), plant_seed(7));
  const snug::test::ScratchFolder folder;
  OutputFile file(folder / "run.h5");
  TrialFiles files;
  files.recording.emplace().file = &file;
  files.describe = [](const runs::RunResult& one) { return std::to_string(one.state_hash); };
  const Trial recorded = run_trial(scenario, "1", quick(0), plant_seed(7), {}, files);
  EXPECT_EQ(recorded.state_hash, unseen.state_hash);
  const record::Recording read = record::load_recording(folder / "run.h5");
  EXPECT_TRUE(read.is_complete);
  EXPECT_EQ(read.result, std::to_string(unseen.state_hash)) << "one simulation";
  motion::Program program = unseen.session.program;
  program.tracking = motion::FastTracking{};
  EXPECT_EQ(read.header.program_text, motion::format_program(program));
  for (const record::Event& event : events_of(recorded.session)) {
    EXPECT_NE(std::ranges::find(read.events, event), read.events.end()) << event.kind << " of " << event.body;
  }
}

TEST(Trial, ARunOfTheProgramThatWasSentIsTheSession) {
  const model::Scenario scenario = shortened(2);
  for (const char* robot : {"", "ur10"}) {
    SCOPED_TRACE(robot);
    const snug::test::ScratchFolder folder;
    OutputFile recording(folder / "run.h5"), program(folder / "sent.csv");
    TrialFiles files;
    files.recording.emplace().file = &recording;
    files.program = &program;
    SessionOptions options = quick(0);
    SimulatedPlantOptions plant = plant_seed(0);  // the scenario's own numbers
    options.simulation.robot = plant.simulation.robot = robot;
    ASSERT_EQ(run_trial(scenario, "1", options, plant, {}, files).executed_boxes, 2);
    runs::RunCapture again;
    runs::RunOptions run;
    run.program = motion::load_program(folder / "sent.csv");
    EXPECT_EQ(run.program->robot, robot);
    run.sequence = "1";
    run.simulation.tracking = run.program->tracking;
    run.simulation.robot = robot;
    run.observer = &again;
    EXPECT_FALSE(runs::run(scenario, run).failure);
    const record::Recording read = record::load_recording(folder / "run.h5");
    ASSERT_GT(read.frames.size(), 1000U);
    std::size_t compared = 0;
    for (const record::Frame& frame : again.recording.frames) {
      const auto same = std::ranges::find_if(
          read.frames, [&](const record::Frame& one) { return std::abs(one.time - frame.time) < 1e-6; });
      if (same == read.frames.end()) continue;
      ++compared;
      ASSERT_LT((same->X_WE.p - frame.X_WE.p).norm(), 1e-5) << frame.time;
      for (std::size_t b = 0; b < frame.bodies.size(); ++b) {
        if (!frame.bodies[b].present || !same->bodies[b].present) continue;
        ASSERT_LT((same->bodies[b].X_WB.p - frame.bodies[b].X_WB.p).norm(), 1e-4) << frame.time << " body " << b;
      }
    }
    EXPECT_GT(compared, read.frames.size() / 2);
  }
}

/// As of a robot elsewhere: all that is known comes out of the plant's interface.
TEST(Trial, ARecordingOfWhatThePlantSaysShowsWhatHappened) {
  const model::Scenario scenario = shortened(2);
  SessionOptions options = quick(0);
  options.simulation.robot = "ur10";
  SimulatedPlantOptions plant_options = plant_seed(7);
  plant_options.simulation.robot = "ur10";
  simulated_plant::SimulatedPlant plant(scenario, "1", plant_options);
  const snug::test::ScratchFolder folder;
  OutputFile file(folder / "run.h5");
  TrialFiles files;
  files.recording.emplace().file = &file;
  files.describe = [](const runs::RunResult& one) { return runs::format_result(one); };
  const Witness truth = truth_of(plant);
  const Trial trial = run_trial(scenario, "1", options, plant, truth, {}, files);
  ASSERT_EQ(trial.executed_boxes, 2);
  const record::Recording read = record::load_recording(folder / "run.h5");
  EXPECT_TRUE(read.is_complete);
  ASSERT_GT(read.frames.size(), 1000U);
  EXPECT_NEAR(read.frames.back().time, trial.session.duration, 0.02);
  ASSERT_EQ(read.header.joints.size(), 6U);
  const auto body_of = [&](const std::string& name) {
    return std::ranges::find(read.header.bodies, name, &record::BodyInfo::name) - read.header.bodies.begin();
  };
  const record::Frame& last = read.frames.back();
  for (std::size_t i = 0; i < truth.items.size(); ++i) {
    const record::BodySample& box = last.bodies[static_cast<std::size_t>(body_of(truth.items[i]))];
    ASSERT_TRUE(box.present);
    EXPECT_LT((box.X_WB.p - truth.poses()[i]->p).norm(), 1e-3) << truth.items[i];
  }
  EXPECT_LT((last.X_WE.p - plant.read().X_WE.p).norm(), 1e-6);
  const auto held = std::ranges::find_if(read.frames, [](const auto& one) { return one.cup.attached_body >= 0; });
  ASSERT_NE(held, read.frames.end());
  EXPECT_LT(held->cup.pressure_gauge, -1e4);
  EXPECT_NEAR(held->cup.length, scenario.cup.hold_length, 1e-6);
  for (const char* kind : {"appear", "seal", "release", "send"})
    EXPECT_NE(std::ranges::find(read.events, kind, &record::Event::kind), read.events.end()) << kind;
  EXPECT_NEAR(runs::read_result(read.result)->filling_degree_percent, trial.executed_percent, 1e-9);
  motion::Program program = trial.session.program;
  program.tracking = motion::FastTracking{};
  EXPECT_EQ(read.header.program_text, motion::format_program(program));
}

TEST(Trial, PacksWithTheArm) {
  SessionOptions options = quick(0);
  options.simulation.robot = "ur10";
  SimulatedPlantOptions plant = plant_seed(7);
  plant.simulation.robot = "ur10";
  const Trial trial = run_trial(shortened(1), "1", options, plant);
  EXPECT_EQ(trial.executed_boxes, 1) << trial.session.stopped;
  EXPECT_FALSE(trial.session.failure) << trial.session.failure.text;
}

TEST(Trial, PacksWithNoisyPerceptionAndWithNone) {
  for (const perception::Kind kind : {perception::Kind::Noisy, perception::Kind::DeadReckoning}) {
    SimulatedPlantOptions plant = plant_seed(7);
    plant.perception = kind;
    const Trial trial = run_trial(shortened(2), "1", quick(), plant);
    EXPECT_EQ(trial.executed_boxes, 2) << perception::name_of(kind) << ": " << trial.session.stopped;
  }
}

TEST(Trial, LeavesABoxThatIsTooBigForTheContainerWithAReason) {
  const Trial trial = run_trial(model::with_container(shortened(18), "150x150x60"), "1", quick(), plant_seed(7));
  EXPECT_EQ(trial.executed_boxes, 0);
  EXPECT_EQ(trial.items_sent, 0);
  ASSERT_EQ(trial.session.items.size(), 18U);
  for (const session::ItemReport& item : trial.session.items) {
    EXPECT_EQ(item.reason, "too big for the container") << item.id;
    EXPECT_EQ(item.end, ItemEnd::Infeasible);
  }
  EXPECT_EQ(trial.session.stopped, "no more items, 18 not packed");
}

TEST(Trial, GoesOnAfterAnItemThatCanNeverFit) {
  model::Scenario scenario = model::with_container(shortened(18), "320x320x150");  // reads its text anew
  scenario.sequences.front().items.resize(2);
  scenario.parcels[14].size = Vector3(0.3, 0.3, 0.2);  // BOX027, the first item
  ASSERT_EQ(scenario.parcels[14].id, "BOX027");
  for (const char* agent : {"contact-aware", "margin", "manual", "offline"}) {
    SCOPED_TRACE(agent);
    SessionOptions options = quick(0);
    options.agent = agent;
    const Trial trial = run_trial(scenario, "1", options, plant_seed(7));
    ASSERT_EQ(trial.session.items.size(), 2U);
    EXPECT_EQ(trial.session.items[0].reason, "too big for the container");
    EXPECT_TRUE(trial.session.items[1].is_packed()) << trial.session.items[1].reason;
    EXPECT_EQ(trial.executed_boxes, 1);
  }
}

TEST(Trial, SaysWhyWhenThereIsNothingToDo) {
  const Trial nothing = run_trial(shortened(0), "1", quick(), plant_seed(7));
  EXPECT_EQ(nothing.session.stop_reason, StopReason::NoItems);
  EXPECT_TRUE(nothing.session.program.waypoints.empty());
  EXPECT_EQ(repeat(shortened(0), "1", nothing.session.program, nothing.session.plan, {}).items.size(), 0U);
  model::Scenario heavy = shortened(1);
  for (model::Parcel& parcel : heavy.parcels) parcel.inertia.mass = 50.0;
  const Trial lifted = run_trial(heavy, "1", quick(), plant_seed(7));
  ASSERT_EQ(lifted.session.items.size(), 1U);
  EXPECT_FALSE(lifted.session.items[0].reason.empty());
}

TEST(Trial, RefusesAnUnknownSequenceAndAgent) {
  EXPECT_THROW((void)run_trial(shortened(1), "nine", quick(), plant_seed(7)), InputError);
  SessionOptions options = quick();
  options.agent = "nobody";
  EXPECT_THROW((void)run_trial(shortened(1), "1", options, plant_seed(7)), InputError);
}

TEST(Trial, AnInterruptedSessionKeepsWhatIsDone) {
  SessionOptions options = quick(0);
  int asked = 0;
  options.is_interrupted = [&] { return ++asked > 1; };
  const Trial trial = run_trial(shortened(3), "1", options, plant_seed(7));
  EXPECT_EQ(trial.session.stop_reason, StopReason::Interrupted);
  EXPECT_EQ(trial.executed_boxes, 1);
  EXPECT_FALSE(trial.session.failure) << trial.session.failure.text;
}

}  // namespace
}  // namespace snug::study
