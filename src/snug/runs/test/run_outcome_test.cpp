// What a run says of itself: limits passed, bodies lost, contacts; runs that go on from an instant.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>

#include "snug/cell/scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/reader.hpp"
#include "snug/runs/run.hpp"
#include "snug/runs/test/scene_text.hpp"

namespace snug::runs {
namespace {

using cell::Scene;

using snug::test::ScratchFolder;
using test::body_of;
using test::kGravity;
using test::loading_error;
using test::scene;
using test::scene_text;

TEST(ContactLimits, ASqueezedBoxIsAFailureThatNamesItAndLeavesTheResultWhole) {
  const ScratchFolder folder;
  const model::Scenario scenario = scene(2.0, R"(
- {name: wall, kind: static, size: [0.2, 1, 0.6], material: m, pose: {position: [0.5, 0, 0.3]}}
- {name: b, size: [0.2, 0.2, 0.2], mass: 2, material: m, pose: {position: [0.25, 0, 0.1]}}
- {name: pusher, kind: kinematic, size: [0.1, 0.3, 0.3], material: m, pose: {position: [0, 0, 0.2]}, twist: {linear: [0.2, 0, 0]}})");
  RunOptions options;
  options.record_path = folder / "run.h5";
  const RunResult result = run(scenario, options);
  for (const char* word : {"rigid", "'b'", "mm deep", "t = ", "time_step", "solver.contact_limits.rigid_depth"}) {
    EXPECT_NE(result.failure.text.find(word), std::string::npos) << word << " in " << result.failure.text;
  }
  EXPECT_NEAR(result.duration, 2.0, 1e-9);
  ASSERT_EQ(result.bodies.size(), 1u);
  EXPECT_GT(result.solver.worst_penetration, 0.05);
  EXPECT_EQ(result.solver.worst_compliant_depth, 0.0);
  const auto deep = std::count_if(result.events.begin(), result.events.end(),
                                  [](const record::Event& event) { return event.kind == "deep contact"; });
  EXPECT_GE(deep, 1);
  const record::Recording recording = record::load_recording(options.record_path);
  EXPECT_TRUE(recording.is_complete);
  EXPECT_EQ(recording.events, result.events);
  EXPECT_EQ(recording.frames.size(), 250u);
}

TEST(ContactLimits, ABodyThatFallsThroughACompliantFloorIsAFailure) {
  const model::Scenario scenario = model::parse_scenario(R"(
name: test
duration: 1.5
materials: [{name: m}]
contacts: {default: {friction: 0.5, restitution: 0.05, stiffness: 200000, damping: 300}}
bodies:
- {name: b, shapes: [{capsule: {length: 0.1, radius: 0.02}}], material: m, pose: {position: [0, 0, 2.02], rpy_deg: [90, 0, 0]}, mass: 8.5}
containers: [{name: tote, inner_size: [1, 1, 1], material: m, floor_thickness: 0.01}])",
                                                         "test.yaml");
  const RunResult result = run(scenario, {});
  for (const char* word : {"compliant", "'b'", "'tote'", "stiffer", "solver.contact_limits.compliant_depth"}) {
    EXPECT_NE(result.failure.text.find(word), std::string::npos) << word << " in " << result.failure.text;
  }
  EXPECT_EQ(result.solver.worst_penetration, 0.0);
  EXPECT_GT(result.solver.worst_compliant_depth, 0.02);
}

TEST(ContactLimits, AreTheScenarios) {
  // 20 kg on 12 kN/m: 16 mm.
  const std::string body = "- {name: b, size: [0.2, 0.3, 0.1], mass: 20, material: m, pose: {position: [0, 0, 0.05]}}";
  const std::string contact = "{friction: 0.5, restitution: 0, stiffness: 12000, damping: 500}";
  EXPECT_EQ(run(scene(1.0, body, contact, "solver: {contact_limits: {compliant_depth: 0.05}}"), {}).failure.text, "");
  EXPECT_NE(run(scene(1.0, body, contact, "solver: {contact_limits: {compliant_depth: 0.01}}"), {}).failure.text, "");
  EXPECT_NE(loading_error(scene_text(1.0, body, contact, "solver: {contact_limits: {compliant_depht: 0.01}}"), "t.yaml")
                .find("'compliant_depth'"),
            std::string::npos);
}

TEST(Compliance, ABodyMayStartAtItsOwnEquilibrium) {
  const double depth = 20.0 * kGravity / 12000.0;
  const auto body = [](double z) {
    return fmt::format(
        "- {{name: b, size: [0.2, 0.3, 0.1], mass: 20, material: m, pose: {{position: [0, 0, {:.9f}]}}}}", z);
  };
  const std::string contact = "{friction: 0.5, restitution: 0, stiffness: 12000, damping: 50}";
  const RunResult result = run(scene(1.0, body(0.05 - depth), contact), {});
  EXPECT_NEAR(body_of(result, "b").X_WB.p.z(), 0.05 - depth, 1e-6);
  EXPECT_FALSE(result.failure) << result.failure.text;
  EXPECT_NE(loading_error(scene_text(1.0, body(0.05 - 1.2 * depth), contact), "t.yaml").find("overlaps"),
            std::string::npos);
  EXPECT_NE(
      loading_error(scene_text(1.0, body(0.05 - depth), "{friction: 0.5, restitution: 0}"), "t.yaml").find("1 mm"),
      std::string::npos);
}

TEST(LostBody, IsAnOutcomeAndTheRunGoesOnWithoutIt) {
  const ScratchFolder folder;
  const model::Scenario scenario = scene(3.0, R"(
- {name: thrown, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 5]}, twist: {linear: [0, 900, 100]}}
- {name: later, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [5, 0, 5]}, twist: {linear: [990, 0, 0]}, appears_at: 0.5}
- {name: b, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 1]}})");
  RunOptions options;
  options.record_path = folder / "run.h5";
  const RunResult result = run(scenario, options);
  EXPECT_FALSE(result.failure) << result.failure.text;
  EXPECT_NEAR(result.duration, 3.0, 1e-9);
  ASSERT_EQ(result.lost.size(), 2u);
  EXPECT_EQ(result.lost[0].name, "thrown");
  EXPECT_NEAR(result.lost[0].time, 1000.0 / 900.0, 2e-3);
  EXPECT_NEAR(result.lost[0].v_W.y(), 900.0, 1e-6);
  EXPECT_GT(result.lost[0].p_W.y(), 1000.0);
  EXPECT_EQ(result.lost[1].name, "later");
  ASSERT_EQ(result.bodies.size(), 1u);
  EXPECT_NEAR(body_of(result, "b").X_WB.p.z(), 0.05, 1e-5);
  const record::Recording recording = record::load_recording(options.record_path);
  EXPECT_TRUE(recording.is_complete);
  ASSERT_EQ(recording.events.size(), 2u);
  EXPECT_EQ(recording.events[0].kind, "out of cell");
  EXPECT_FALSE(recording.frames.back().bodies[1].present);
}

TEST(Contacts, OfTheResultBearTheWeightAlsoOfSleepingBodies) {
  const model::Scenario scenario = scene(3.0, R"(
- {name: low, size: [0.2, 0.2, 0.1], mass: 3, material: m, pose: {position: [0, 0, 0.05]}}
- {name: high, size: [0.1, 0.1, 0.1], mass: 2, material: m, pose: {position: [0.02, 0, 0.15]}})");
  const RunResult result = run(scenario, {});
  EXPECT_EQ(body_of(result, "low").speed, 0.0);  // asleep
  Vector3 on_low = Vector3::Zero(), on_high = Vector3::Zero();
  for (const ContactResult& contact : result.contacts) {
    if (contact.body_a == "low") on_low -= contact.force_B_W;
    if (contact.body_b == "low") on_low += contact.force_B_W;
    if (contact.body_a == "high") on_high -= contact.force_B_W;
    if (contact.body_b == "high") on_high += contact.force_B_W;
    EXPECT_NEAR(contact.phi, 0.0, 1e-5);
  }
  // The solver's tolerance is 1e-5 m/s a step: 0.03 N of 3 kg at 1 ms.
  EXPECT_NEAR((on_high - Vector3(0, 0, 2 * kGravity)).norm(), 0.0, 0.05);
  EXPECT_NEAR((on_low - Vector3(0, 0, 3 * kGravity)).norm(), 0.0, 0.05);
}

// --- records and resuming ---

TEST(RecordPeriod, IsTheScenarios) {
  const ScratchFolder folder;
  RunOptions options;
  options.record_path = folder / "run.h5";
  (void)run(scene(1.0, "- {name: b, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 1]}}",
                  "{friction: 0.4, restitution: 0}", "record_period: 0.02"),
            options);
  const record::Recording recording = record::load_recording(options.record_path);
  EXPECT_EQ(recording.frames.size(), 50u);
  EXPECT_DOUBLE_EQ(recording.header.record_period, 0.02);
  EXPECT_NEAR(recording.frames[1].time - recording.frames[0].time, 0.02, 1e-12);
}

TEST(Resume, GoesOnFromAnInstantAsIfItHadNotStopped) {
  const ScratchFolder folder;
  // In flight, spinning; asleep on the floor; appears before and after the instant; on a kinematic tray.
  const std::string bodies = R"(
- {name: flying, size: [0.1, 0.2, 0.3], mass: 1, material: m, com: [0.01, 0, 0], pose: {position: [0, 0, 9]}, twist: {linear: [0.3, 0, 2], angular: [3, 2, 1]}}
- {name: resting, size: [0.2, 0.2, 0.1], mass: 1, material: m, pose: {position: [2, 0, 0.05]}}
- {name: early, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [3, 0, 5]}, appears_at: 0.2}
- {name: late, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [4, 0, 5]}, appears_at: 0.9}
- {name: tray, kind: kinematic, size: [0.3, 0.3, 0.1], material: m, pose: {position: [-2, 0, 0.5]}, twist: {linear: [0.1, 0, 0]}})";
  RunOptions options;
  options.record_path = folder / "run.h5";
  const RunResult whole = run(scene(1.2, bodies), options);
  model::Scenario scenario = scene(1.2, bodies);
  for (const std::optional<double> time : {std::optional<double>(0.8), std::optional<double>(0.4)}) {
    scenario.initial_state = model::InitialState{options.record_path, time};
    EXPECT_NEAR(Scene(scenario).state().time(Scene(scenario).world().model), *time, 1e-12);
    const RunResult rest = run(scenario, {});
    ASSERT_EQ(rest.bodies.size(), whole.bodies.size());
    for (std::size_t i = 0; i < whole.bodies.size(); ++i) {
      SCOPED_TRACE(whole.bodies[i].name);
      EXPECT_EQ(rest.bodies[i].name, whole.bodies[i].name);
      // In flight only the rounding of poses and twists about other points is left. What rests is woken by the body
      // that appears and settles without the impulses of the steps before: less than the solver's tolerance in 1 ms.
      const double allowed = whole.bodies[i].name == "resting" ? 1e-8 : 1e-12;
      EXPECT_LT((rest.bodies[i].X_WB.p - whole.bodies[i].X_WB.p).norm(), allowed);
      EXPECT_LT((rest.bodies[i].X_WB.R - whole.bodies[i].X_WB.R).norm(), allowed);
    }
  }
}

TEST(Resume, SaysWhatIsMissing) {
  const ScratchFolder folder;
  const std::string body = "- {name: b, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 1]}}";
  RunOptions options;
  options.record_path = folder / "run.h5";
  (void)run(scene(0.5, body), options);
  const auto error_of = [](const model::Scenario& scenario) -> std::string {
    try {
      (void)run(scenario, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  model::Scenario scenario = scene(1.0, body);
  scenario.initial_state = model::InitialState{options.record_path, 0.7};
  EXPECT_NE(error_of(scenario).find("a recorded instant"), std::string::npos) << error_of(scenario);
  scenario.initial_state = model::InitialState{folder / "none.h5", std::nullopt};
  EXPECT_NE(error_of(scenario).find("none.h5"), std::string::npos);
  scenario = scene(1.0, "- {name: other, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 1]}}");
  scenario.initial_state = model::InitialState{options.record_path, std::nullopt};
  EXPECT_NE(error_of(scenario).find("'other'"), std::string::npos);
  scenario = scene(0.3, body);
  scenario.initial_state = model::InitialState{options.record_path, std::nullopt};
  EXPECT_NE(error_of(scenario).find("before the end of the run"), std::string::npos);
}

TEST(InitialState, ABodyThatStartsAsleepRestsUntilItIsTouched) {
  const model::Scenario scenario = scene(1.0, R"(
- {name: hung, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 2]}, asleep: true}
- {name: hit, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [3, 0, 0.05]}})");
  EXPECT_NEAR(body_of(run(scenario, {}), "hung").X_WB.p.z(), 2.0, 0.0);
  EXPECT_NE(
      loading_error(
          scene_text(
              1.0, "- {name: a, kind: static, size: [1, 1, 1], material: m, asleep: true, pose: {position: [0, 0, 5]}}",
              "{friction: 0, restitution: 0}"),
          "t.yaml")
          .find("asleep"),
      std::string::npos);
}

}  // namespace
}  // namespace snug::runs
