// Cell: our own program packs the container, runs repeat bit by bit, the cup seals or says why not, scenes come to
// rest.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/test/demonstrator.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/record/reader.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/run.hpp"

namespace snug::runs {
namespace {

using cell::BoxResult;
using cell::BoxState;
using cell::build_world;
using cell::CellWorld;
using cell::demonstrator;
using cell::Gripper;
using cell::GripperEvent;
using cell::GripperState;
using cell::GripperStep;
using cell::kSource;
using cell::make_initial_state;
using cell::vertical_axis;

RunOptions demo_options() {
  const motion::Program program = motion::load_program(kSource / "src/snug/cell/test/demo_program.csv");
  RunOptions options;
  options.program = program;
  options.program_text = motion::format_program(program);
  options.sequence = "1";
  return options;
}

// ---- programs of our own

TEST(DemoProgram, PacksAllTwelveBoxesAndRepeatsBitByBit) {
  const RunResult result = run(demonstrator(), demo_options());
  EXPECT_FALSE(result.failure) << result.failure.text;
  ASSERT_EQ(result.boxes.size(), 12U);
  for (const BoxResult& box : result.boxes) EXPECT_EQ(box.state, BoxState::Packed) << box.id;
  EXPECT_NEAR(result.filling_degree_percent, 74.22, 0.005);  // of the report's boxes; two decimals
  EXPECT_TRUE(result.repicks.empty());
  const RunResult again = run(demonstrator(), demo_options());
  EXPECT_EQ(result.state_hash, again.state_hash);
  EXPECT_EQ(result.events.size(), again.events.size());
}

TEST(DemoProgram, ChangesItsStateHashWhenTheSceneChanges) {
  RunOptions options = demo_options();
  options.until = 12.0;  // past the first pick
  model::Scenario shifted = demonstrator();
  shifted.aligner->X_WA.p.x() += 1e-6;
  EXPECT_NE(run(demonstrator(), options).state_hash, run(shifted, options).state_hash);
}

// ---- options that do not fit

void expect_refused(const model::Scenario& scenario, const RunOptions& options, const std::string& key,
                    const std::string& expected) {
  try {
    (void)run(scenario, options);
    ADD_FAILURE() << "no complaint about " << key;
  } catch (const InputError& error) {
    EXPECT_EQ(error.key, key) << error.what();
    EXPECT_NE(error.expected.find(expected), std::string::npos) << error.what();
  }
}

TEST(RunOptions, AreRefusedWhenTheyDoNotFitTheScenario) {
  RunOptions options = demo_options();
  options.sequence = "9";
  expect_refused(demonstrator(), options, "--sequence", "one of 1, 2, 3");
  options = demo_options();
  options.corrections = "seq9";
  expect_refused(demonstrator(), options, "--corrections", "seq1, seq2-5");
  model::Scenario scenario = demonstrator();
  scenario.time_step = 0.003;
  expect_refused(scenario, demo_options(), "time_step", "fraction");
  scenario = demonstrator();
  scenario.tool.reset();
  expect_refused(scenario, demo_options(), "tool", "a tool");
  scenario = demonstrator();
  scenario.aligner.reset();
  expect_refused(scenario, demo_options(), "aligner", "an aligner");
}

TEST(RunOptions, HaveTheCupThatCorrectionsWereMadeForUnlessTheySayAnother) {
  model::Scenario scenario = demonstrator();
  EXPECT_EQ(cup_for(scenario, ""), cup::CupMode::Phases);
  EXPECT_EQ(cup_for(scenario, "seq1"), cup::CupMode::Holding);
  EXPECT_THROW((void)cup_for(scenario, "seq9"), InputError);
  const auto cup_of_run = [&](const RunOptions& options) {
    RunCapture capture;
    RunOptions short_run = options;
    short_run.until = 0.1;
    short_run.observer = &capture;
    (void)run(scenario, short_run);
    return nlohmann::json::parse(capture.recording.header.settings).at("cup").get<std::string>();
  };
  RunOptions options = demo_options();
  EXPECT_EQ(cup_of_run(options), "phases");
  options.corrections = "seq1";
  EXPECT_EQ(cup_of_run(options), "holding");
  scenario.controller.correction_layers[0].with_phases = true;
  EXPECT_EQ(cup_of_run(options), "phases");
  options.simulation.cup = cup::CupMode::Holding;
  EXPECT_EQ(cup_of_run(options), "holding");
}

TEST(RunOptions, AreRefusedForAWaypointWhoseNameNoPrefixMatches) {
  RunOptions options = demo_options();
  options.program->waypoints[3] = motion::named_waypoint("Dance007", options.program->waypoints[3].X_WE);
  EXPECT_THROW((void)run(demonstrator(), options), InputError);
}

TEST(RunOptions, AreRefusedForARecordingThatCannotBeWritten) {
  RunOptions options = demo_options();
  options.record_path = kSource / "no/such/folder/run.h5";
  EXPECT_THROW((void)run(demonstrator(), options), InputError);
}

// ---- recording

TEST(Recording, OfTwoSecondsHasAFrameForEveryTickAndWhatRan) {
  RunOptions options = demo_options();
  options.until = 2.0;
  options.version = "test";
  const snug::test::ScratchFolder folder;
  options.record_path = folder / "run.h5";
  const RunResult result = run(demonstrator(), options);
  const record::Recording recording = record::load_recording(options.record_path);
  EXPECT_EQ(recording.header.scenario_text, demonstrator().source_text);
  EXPECT_EQ(recording.header.program_text, options.program_text);
  EXPECT_EQ(recording.header.sequence, "1");
  EXPECT_EQ(recording.header.version, "test");
  ASSERT_EQ(recording.frames.size(), 250U);  // 2 s of 8 ms
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    // 1e-9: rounding of a sum of 2000 steps
    EXPECT_NEAR(recording.frames[i].time, 0.008 * static_cast<double>(i + 1), 1e-9);
    EXPECT_TRUE(recording.frames[i].X_WE.p.allFinite());
  }
  EXPECT_EQ(recording.events.size(), result.events.size());
}

TEST(Recording, HoldsTheContactsOfWhatSleepsUntilItWakes) {
  RunOptions options;
  options.until = 4.0;
  const snug::test::ScratchFolder folder;
  options.record_path = folder / "run.h5";
  const model::Scenario scenario = model::load_scenario(kSource / "scenarios/stack.yaml");
  (void)run(scenario, options);
  const record::Recording recording = record::load_recording(options.record_path);
  double weight = 0.0;
  for (const record::BodyInfo& body : recording.header.bodies) {
    if (body.kind == record::BodyKind::Dynamic) weight += 9.81 * body.mass;
  }
  ASSERT_GT(weight, 0.0);
  const record::Frame& last = recording.frames.back();
  EXPECT_EQ(last.solver.status, record::SolverStatus::NothingToSolve) << "it should sleep";
  double carried = 0.0;
  for (const record::ContactSample& contact : last.contacts) {
    const auto is_static = [&](int body) {
      return recording.header.bodies[static_cast<std::size_t>(body)].kind == record::BodyKind::Static;
    };
    if (is_static(contact.body_a)) carried += contact.force_B_W.z();
    if (is_static(contact.body_b)) carried -= contact.force_B_W.z();
  }
  EXPECT_NEAR(carried, weight, 0.01 * weight);  // found while it was still slow, not at rest
}

// ---- the cup in a world with one box

class GripperAtABox : public ::testing::Test {
 protected:
  GripperAtABox()
      : sequence_(*model::find_sequence(demonstrator(), "1")),
        world_(build_world(demonstrator(), {&sequence_, true, nullptr, {}})),
        state_(make_initial_state(demonstrator(), world_)),
        box_(world_.parcels[0]),
        gripper_(demonstrator(), cup::CupMode::Holding, world_) {
    half_ = 0.5 * model::collision_size(demonstrator(), *model::find_parcel(demonstrator(), "BOX027"));
    physics::set_present(state_, box_, true);
    physics::set_pose(world_.model, state_, box_, Pose{Matrix3::Identity(), Vector3(0.0, 0.0, 1.0)});
  }

  /// E with the lip's axis through `p_xy` of the top face, tilted about x, at `length` from it along z of E.
  [[nodiscard]] Pose tool_above(double x, double length, double tilt = 0.0) const {
    const Matrix3 R_WE = exp_rotation(Vector3(tilt, 0.0, 0.0)) * exp_rotation(Vector3(0.0, std::numbers::pi, 0.0));
    const Vector3 p_WS(x, 0.0, 1.0 + half_.z());
    return {R_WE, p_WS - length * R_WE.col(2)};
  }

  std::vector<GripperEvent> prepare_for(double seconds, const Pose& X_WE, const cup::CupCommand& command) {
    std::vector<GripperEvent> events;
    constexpr double kDt = 0.001;
    for (int i = 0; i < static_cast<int>(std::lround(seconds / kDt)); ++i) {
      gripper_.prepare(state_, X_WE, Twist{}, command, kDt, grip_, step_, events);
    }
    return events;
  }

  void expect_no_seal(const Pose& X_WE, cup::NoSeal reason) {
    const auto events = prepare_for(1.0, X_WE, {true, false});
    ASSERT_EQ(events.size(), 1U);  // once for each time that the vacuum comes on
    EXPECT_EQ(events[0].kind, GripperEvent::Kind::NoSeal);
    EXPECT_EQ(events[0].body, box_.index);
    EXPECT_EQ(events[0].no_seal.reason, reason) << cup::describe(events[0].no_seal.reason);
    EXPECT_TRUE(step_.uses.empty());
  }

  const model::Sequence& sequence_;
  CellWorld world_;
  physics::WorldState state_;
  physics::BodyId box_;
  Gripper gripper_;
  GripperState grip_;
  GripperStep step_;
  Vector3 half_ = Vector3::Zero();
};

TEST_F(GripperAtABox, SealsWhenTheLipIsOnTheFaceAndLetsGoWithTheVacuum) {
  const Pose X_WE = tool_above(0.02, 0.060);
  EXPECT_TRUE(prepare_for(0.1, X_WE, {false, false}).empty());
  auto events = prepare_for(0.1, X_WE, {true, false});
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, GripperEvent::Kind::Seal);
  EXPECT_EQ(events[0].body, box_.index);
  EXPECT_NEAR(events[0].length, 0.060, 1e-12);  // rounding
  EXPECT_LT((events[0].offset_P - Vector3(0.02, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_EQ(step_.cups.at(0).body, box_.index);
  EXPECT_EQ(step_.ignored, box_.index);
  EXPECT_EQ(step_.uses.size(), 1U);
  events = prepare_for(0.1, X_WE, {false, true});
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, GripperEvent::Kind::Released);
  EXPECT_TRUE(step_.uses.empty());
}

TEST_F(GripperAtABox, SaysThatTheFaceIsOutOfReach) {
  // Free length 72 mm, reach 8 mm: 85 mm is too far.
  expect_no_seal(tool_above(0.0, 0.085), cup::NoSeal::OutOfReach);
}

TEST_F(GripperAtABox, SaysThatTheFaceIsTooTilted) {
  expect_no_seal(tool_above(0.0, 0.060, 20.0 * std::numbers::pi / 180.0), cup::NoSeal::TooTilted);
}

TEST_F(GripperAtABox, SaysThatTheLipIsOverAnEdge) {
  // The sealing disc has a radius of 30 mm and may stand over the edge by 15 mm: 16 mm is too much.
  expect_no_seal(tool_above(half_.x() - 0.014, 0.060), cup::NoSeal::OverEdge);
}

TEST_F(GripperAtABox, SealsJustInsideTheLimitOfTheOverhang) {
  const auto events = prepare_for(0.01, tool_above(half_.x() - 0.016, 0.060), {true, false});
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, GripperEvent::Kind::Seal);
}

TEST_F(GripperAtABox, NamesNoBodyWhenNothingIsInFront) {
  const auto events = prepare_for(1.0, tool_above(2.0, 0.060), {true, false});
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, GripperEvent::Kind::NoSeal);
  EXPECT_EQ(events[0].body, -1);
}

TEST_F(GripperAtABox, LosesTheHoldWhenTheCupIsBentTooFar) {
  (void)prepare_for(0.01, tool_above(0.0, 0.050), {true, false});
  ASSERT_EQ(grip_.cup.phase, cup::CupPhase::Holding);
  const auto events = prepare_for(0.001, tool_above(0.0, 0.050, 50.0 * std::numbers::pi / 180.0), {true, false});
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].kind, GripperEvent::Kind::HoldLost);
  EXPECT_NE(events[0].loss, cup::HoldLoss::None);
}

// ---- scenes without a program

RunResult run_scene_file(const std::string& name) {
  const RunResult result = run(model::load_scenario(kSource / "scenarios" / name), RunOptions{});
  EXPECT_FALSE(result.failure) << result.failure.text << name;
  EXPECT_FALSE(result.bodies.empty()) << name;
  for (const BodyResult& body : result.bodies) {
    EXPECT_TRUE(body.X_WB.p.allFinite() && body.X_WB.R.allFinite() && std::isfinite(body.speed)) << body.name;
  }
  return result;
}

// Bodies at rest are put to sleep or creep by less than the tolerance of the solver, 1e-5 m/s.
constexpr double kAtRest = 1e-4;

TEST(Scene, StackOfFiveStaysWhereItIs) {
  const RunResult result = run_scene_file("stack.yaml");
  ASSERT_EQ(result.bodies.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_LT(result.bodies[i].speed, kAtRest);
    const Vector3 start((i % 2 == 1) ? 0.005 : 0.0, 0.0, 0.05 + 0.1 * static_cast<double>(i));
    EXPECT_LT((result.bodies[i].X_WB.p - start).norm(), 1e-4) << result.bodies[i].name;  // a tenth of a millimetre
  }
}

TEST(Scene, DroppedBoxEndsFlatOnTheFloor) {
  const RunResult result = run_scene_file("drop.yaml");
  ASSERT_EQ(result.bodies.size(), 1U);
  EXPECT_LT(result.bodies[0].speed, kAtRest);
  const Matrix3& R = result.bodies[0].X_WB.R;
  const double half_height = 0.5 * (R.cwiseAbs() * Vector3(0.20, 0.20, 0.10)).z();
  EXPECT_NEAR(result.bodies[0].X_WB.p.z(), half_height, 1e-4);
  EXPECT_NEAR(std::abs(R(2, vertical_axis(R))), 1.0, 1e-6);  // within 0.1 degree
}

TEST(Scene, SlidingBoxStopsAfterTheDistanceOfCoulomb) {
  const RunResult result = run_scene_file("slide.yaml");
  ASSERT_EQ(result.bodies.size(), 1U);
  EXPECT_LT(result.bodies[0].speed, kAtRest);
  const double distance = 1.0 / (2.0 * 0.2 * 9.81);
  EXPECT_NEAR(result.bodies[0].X_WB.p.x(), distance, 5e-4 * distance);  // 0.05 %: the target of `snug bench`
}

TEST(Scene, PushedBoxesEndAheadOfThePusher) {
  const RunResult result = run_scene_file("push.yaml");
  ASSERT_EQ(result.bodies.size(), 2U);
  // The pusher's front ends at -0.25 + 0.2 * 2 + 0.03 = 0.18 m. Boxes of e <= 0.05 leave it by little.
  EXPECT_GE(result.bodies[0].X_WB.p.x(), 0.28 - 1e-3);
  EXPECT_LT(result.bodies[0].X_WB.p.x(), 0.30);
  EXPECT_GT(result.bodies[1].X_WB.p.x(), result.bodies[0].X_WB.p.x() + 0.17);
  for (const BodyResult& body : result.bodies) {
    EXPECT_LT(body.speed, 0.25);
    EXPECT_GT(body.X_WB.R(2, 2), 0.999);  // upright
  }
}

TEST(Scene, RepeatsBitByBit) {
  EXPECT_EQ(run_scene_file("drop.yaml").state_hash, run_scene_file("drop.yaml").state_hash);
}

}  // namespace
}  // namespace snug::runs
