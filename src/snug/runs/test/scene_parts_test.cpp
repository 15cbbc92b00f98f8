// What a scene may have beside boxes: belts, paths, wrenches, cylinders, meshes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "snug/cell/scene.hpp"
#include "snug/runs/run.hpp"
#include "snug/runs/test/scene_text.hpp"

namespace snug::runs {
namespace {

using cell::find_body;
using cell::Scene;

namespace fs = std::filesystem;
using snug::test::ScratchFolder;
using test::body_of;
using test::kGravity;
using test::loading_error;
using test::scene;
using test::scene_text;
using test::write;

constexpr double kPi = std::numbers::pi;

TEST(Belt, CarriesABoxAtFrictionUntilItMovesWithTheBelt) {
  constexpr double kSpeed = 0.6, kFriction = 0.4;
  const model::Scenario scenario = scene(3.0, R"(
- {name: belt, kind: static, size: [4, 0.5, 0.1], material: m, pose: {position: [0, 0, 0.05]}, surface_velocity: [0.6, 0, 0]}
- {name: box, size: [0.2, 0.2, 0.1], mass: 2, material: m, pose: {position: [-1, 0, 0.15]}})");
  Scene run(scenario);
  const physics::BodyId box = find_body(run.world(), "box");
  const double dt = scenario.time_step;
  for (int i = 1; i <= 3000; ++i) {
    ASSERT_EQ(run.advance().status, physics::StepStatus::Converged);
    const double expected = std::min(kSpeed, kFriction * kGravity * i * dt);
    // Contact opens for a step at the start at most; the solver leaves 1e-5 m/s.
    ASSERT_NEAR(physics::twist_of(run.world().model, run.state(), box).linear.x(), expected, kGravity * kFriction * dt)
        << i;
  }
  // It never sleeps on a belt that runs.
  EXPECT_NEAR(physics::twist_of(run.world().model, run.state(), box).linear.x(), kSpeed, 2e-5);
  const double way = kSpeed * 3.0 - kSpeed * kSpeed / (2.0 * kFriction * kGravity);
  EXPECT_NEAR(physics::pose_of(run.world().model, run.state(), box).p.x(), -1.0 + way, 2.0 * kSpeed * dt);
}

TEST(Belt, RunsWithTheBodyItBelongsToAndDoesNotPushWithItsEnds) {
  // The belt is turned by 90 degrees: its surface runs along y of the world. A box stands before its end.
  const model::Scenario scenario = scene(1.0, R"(
- name: belt
  kind: static
  size: [1, 0.5, 0.1]
  material: m
  pose: {position: [0, 0, 0.05], yaw_deg: 90}
  surface_velocity: [0.3, 0, 0]
- {name: on, size: [0.2, 0.2, 0.1], mass: 2, material: m, pose: {position: [0, 0, 0.15]}}
- {name: before, size: [0.1, 0.1, 0.1], mass: 2, material: m, pose: {position: [0, 0.55, 0.05]}})");
  const RunResult result = run(scenario, {});
  EXPECT_GT(body_of(result, "on").X_WB.p.y(), 0.25);
  EXPECT_NEAR(body_of(result, "on").X_WB.p.x(), 0.0, 1e-6);
  EXPECT_NEAR((body_of(result, "before").X_WB.p - Vector3(0, 0.55, 0.05)).norm(), 0.0, 1e-5);
}

// --- wrenches ---

TEST(AppliedWrench, AcceleratesByForceOverMassForAsLongAsItActs) {
  // Starts and ends within a step.
  const model::Scenario scenario =
      scene(1.0, "- {name: b, size: [0.2, 0.3, 0.4], mass: 2, material: m, pose: {position: [0, 0, 5]}}",
            "{friction: 0.4, restitution: 0}", R"(
gravity: [0, 0, 0]
solver: {sleep: {enabled: false}}
wrenches:
- {body: b, force: [3, -1, 2], start: 0.1004, end: 0.3507})");
  Scene run(scenario);
  for (int i = 0; i < 1000; ++i) (void)run.advance();
  const Twist V = physics::twist_of(run.world().model, run.state(), find_body(run.world(), "b"));
  EXPECT_NEAR((V.linear - 0.2503 / 2.0 * Vector3(3, -1, 2)).norm(), 0.0, 1e-12);
  EXPECT_EQ(V.angular, Vector3(0, 0, 0));
}

TEST(AppliedWrench, TurnsABodyByTorqueAndByTheArmOfItsForce) {
  // Cube of 0.2 m and 3 kg: I = m a^2 / 6 = 0.02. The force along z at x = 0.05 gives -0.05 F about y.
  const model::Scenario scenario =
      scene(0.5, "- {name: b, size: [0.2, 0.2, 0.2], mass: 3, material: m, pose: {position: [0, 0, 5]}}",
            "{friction: 0.4, restitution: 0}", R"(
gravity: [0, 0, 0]
wrenches:
- {body: b, torque: [0, 0.004, 0], frame: world}
- {body: b, force: [0, 0, 0.02], point: [0.05, 0, 0], frame: body})");
  Scene run(scenario);
  for (int i = 0; i < 500; ++i) (void)run.advance();
  const Twist V = physics::twist_of(run.world().model, run.state(), find_body(run.world(), "b"));
  EXPECT_NEAR(V.angular.y(), 0.5 * (0.004 - 0.05 * 0.02) / 0.02, 1e-9);
}

TEST(AppliedWrench, KeepsAwakeWhatItPushes) {
  // Slower than the speed below which bodies sleep: 1 mm/s after 0.5 s.
  const model::Scenario scenario =
      scene(2.0, "- {name: b, size: [0.2, 0.2, 0.2], mass: 1, material: m, pose: {position: [0, 0, 5]}}",
            "{friction: 0.4, restitution: 0}", R"(
gravity: [0, 0, 0]
wrenches: [{body: b, force: [0.001, 0, 0]}])");
  EXPECT_NEAR(body_of(run(scenario, {}), "b").X_WB.p.x(), 0.5 * 0.001 * 4.0, 1e-9);
}

// --- paths ---

TEST(KinematicPath, IsFollowedToRounding) {
  const ScratchFolder folder;
  (void)write(folder, "way.csv",
              "time,x,y,z,roll_deg,pitch_deg,yaw_deg\n"
              "0.1,1,0,0.3,0,0,0\n"
              "0.35,1.5,0.2,0.3,0,0,90\n"
              "0.9,1.5,-0.4,0.8,30,-20,90\n");
  const fs::path file = write(folder, "scene.yaml",
                              scene_text(1.0, R"(
- {name: arm, kind: kinematic, size: [0.1, 0.1, 0.1], material: m, path: {file: way.csv}}
- {name: b, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [-3, 0, 0.05]}})",
                                         "{friction: 0.4, restitution: 0}"));
  const model::Scenario scenario = model::load_scenario(file);
  Scene run(scenario);
  const physics::BodyId arm = find_body(run.world(), "arm");
  const auto turn = [](double roll, double pitch, double yaw) {
    return Matrix3(exp_rotation({0, 0, yaw * kPi / 180}) * exp_rotation({0, pitch * kPi / 180, 0}) *
                   exp_rotation({roll * kPi / 180, 0, 0}));
  };
  EXPECT_EQ(physics::pose_of(run.world().model, run.state(), arm).p, Vector3(1, 0, 0.3));
  // Three rows none of which turns back: the origin follows the parabola through them.
  const auto parabola = [](double t) {
    const Vector3 a(1, 0, 0.3), b(1.5, 0.2, 0.3), c(1.5, -0.4, 0.8);
    return Vector3((t - 0.35) * (t - 0.9) / (0.25 * 0.8) * a - (t - 0.1) * (t - 0.9) / (0.25 * 0.55) * b +
                   (t - 0.1) * (t - 0.35) / (0.8 * 0.55) * c);
  };
  Twist before;
  for (int i = 1; i <= 1000; ++i) {
    (void)run.advance();
    const double t = i * 1e-3;
    const Pose X = physics::pose_of(run.world().model, run.state(), arm);
    const Twist V = physics::twist_of(run.world().model, run.state(), arm);
    ASSERT_LT((X.p - parabola(std::clamp(t, 0.1, 0.9))).norm(), 1e-12) << t;
    if (i <= 100) {
      ASSERT_LT((X.R - turn(0, 0, 0)).norm(), 1e-12) << t;
    }
    if (i == 350) {
      ASSERT_LT((X.R - turn(0, 0, 90)).norm(), 1e-12) << t;
    }
    if (i >= 900) {
      ASSERT_LT((X.R - turn(30, -20, 90)).norm(), 1e-12) << t;
    }
    // No jump in speed between the first and the last row: 0.1 rad/s a step is 100 rad/s^2; straight lines jump by 6.
    if (i > 101 && i < 900) {
      ASSERT_LT((V.linear - before.linear).norm(), 0.02) << t;
      ASSERT_LT((V.angular - before.angular).norm(), 0.1) << t;
    }
    before = V;
  }
}

TEST(KinematicPath, OfTwentyRowsASecondCarriesABoxWithoutSlip) {
  // 0.6 m in 1.2 s with least jerk: at most 0.245 g, where friction 0.3 holds.
  const ScratchFolder folder;
  std::string table = "time,x,y,z,qw,qx,qy,qz\n";
  for (int i = 0; i <= 24; ++i) {
    const double s = i / 24.0;
    table += fmt::format("{:.6f},{:.9f},0,0,1,0,0,0\n", 0.2 + 1.2 * s, 0.6 * s * s * s * (10 - 15 * s + 6 * s * s));
  }
  (void)write(folder, "way.csv", table);
  const fs::path file = write(folder, "scene.yaml",
                              scene_text(1.6, R"(
- {name: tray, kind: kinematic, size: [0.6, 0.4, 0.1], material: m, path: {file: way.csv}}
- {name: b, size: [0.3, 0.2, 0.1], mass: 3, material: m, pose: {position: [0, 0, 0.1]}})",
                                         "{friction: 0.3, restitution: 0}"));
  Scene run(model::load_scenario(file));
  const physics::BodyId tray = find_body(run.world(), "tray"), box = find_body(run.world(), "b");
  for (int i = 1; i <= 1600; ++i) {
    ASSERT_EQ(run.advance().status, physics::StepStatus::Converged);
    const Vector3 apart = physics::pose_of(run.world().model, run.state(), box).p -
                          physics::pose_of(run.world().model, run.state(), tray).p;
    ASSERT_NEAR(apart.x(), 0.0, 1e-5) << i;  // measured: 5e-7; straight lines between the rows: 15e-3
  }
}

TEST(KinematicPath, RestsBetweenEqualRows) {
  const ScratchFolder folder;
  (void)write(
      folder, "way.csv",
      "time,x,y,z,yaw_deg,pitch_deg,roll_deg\n0,0,0,1,0,0,0\n0.2,1,0,1,90,0,0\n0.4,1,0,1,90,0,0\n0.6,0,0,1,0,0,0\n");
  const fs::path file =
      write(folder, "scene.yaml",
            scene_text(0.6, "- {name: arm, kind: kinematic, size: [0.1, 0.1, 0.1], material: m, path: {file: way.csv}}",
                       "{friction: 0.3, restitution: 0}"));
  Scene run(model::load_scenario(file));
  const physics::BodyId arm = find_body(run.world(), "arm");
  for (int i = 1; i <= 400; ++i) {
    (void)run.advance();
    const double x = physics::pose_of(run.world().model, run.state(), arm).p.x();
    ASSERT_LE(x, 1.0 + 1e-12) << i;  // does not overshoot
    if (i >= 200) {
      ASSERT_NEAR(x, 1.0, 1e-12) << i;
    }
  }
}

TEST(KinematicPath, CarriesWhatLiesOnIt) {
  const ScratchFolder folder;
  (void)write(folder, "way.csv", "time,x,y,z,qw,qx,qy,qz\n0,0,0,0.05,1,0,0,0\n2,0.2,0,0.05,1,0,0,0\n");
  const fs::path file = write(folder, "scene.yaml",
                              scene_text(2.0, R"(
- {name: tray, kind: kinematic, size: [0.4, 0.4, 0.1], material: m, path: {file: way.csv}}
- {name: b, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 0.15]}})",
                                         "{friction: 0.4, restitution: 0}"));
  // It lags by v^2 / (2 mu g) while it is brought up to speed, 1.3 mm.
  EXPECT_NEAR(body_of(run(model::load_scenario(file), {}), "b").X_WB.p.x(), 0.2 - 0.01 / (2 * 0.4 * kGravity), 1e-4);
}

TEST(KinematicPath, ErrorsNameFileLineAndColumn) {
  const ScratchFolder folder;
  const auto error_of = [&folder](const std::string& table) {
    (void)write(folder, "way.csv", table);
    return loading_error(
        scene_text(1.0, "- {name: a, kind: kinematic, size: [1, 1, 1], material: m, path: {file: way.csv}}",
                   "{friction: 0.4, restitution: 0}"),
        (folder / "scene.yaml").string());
  };
  const std::string header = "time,x,y,z,qw,qx,qy,qz\n";
  EXPECT_EQ(error_of(header + "0,0,0,3,1,0,0,0\n"), "");
  const std::pair<std::string, std::string> cases[] = {
      {"", "way.csv"},
      {header, "no points"},
      {"time,x,y,z\n0,0,0,0\n", "no such column"},
      {"time,x,y,z,roll_deg,pitch_deg,yawdeg\n", "way.csv:1: header: got 'yawdeg'; expected time,x,y,z,"},
      {"time,x,y,z,roll_deg,pitch_deg,yawdeg\n", "nearest is 'yaw_deg'"},
      {"time,x,y,z,qw,qx,qy,qz,yaw_deg\n", "a quaternion and angles"},
      {"time,x,x,z,qw,qx,qy,qz\n", "a second time"},
      {header + "0,0,0,0,1,0,0\n", "way.csv:2: got 7 fields; expected 8"},
      {header + "0,0,0,0,1,0,0,0\n1,0,0,zero,1,0,0,0\n", "way.csv:3: z: got 'zero'"},
      {header + "0,0,0,0,1,0,0,0\n0,0,0,0,1,0,0,0\n", "way.csv:3: time"},
      {header + "0,0,0,0,1,1,0,0\n", "norm"},
      {header + "0,0,0,0,1,0,0,0\n0.001,900,0,0,1,0,0,0\n", "way.csv:3"},
      {header + "nan,0,0,0,1,0,0,0\n", "way.csv:2: time"},
  };
  for (const auto& [table, expected] : cases) {
    SCOPED_TRACE(table);
    EXPECT_NE(error_of(table).find(expected), std::string::npos) << error_of(table);
  }
  EXPECT_NE(loading_error(
                scene_text(1.0, "- {name: a, kind: kinematic, size: [1, 1, 1], material: m, path: {file: none.csv}}",
                           "{friction: 0, restitution: 0}"),
                (folder / "scene.yaml").string())
                .find("none.csv"),
            std::string::npos);
}

// --- cylinders ---

std::string tilted_gravity(double tangent) {
  const double angle = std::atan(tangent);
  return fmt::format("gravity: [{}, 0, {}]", kGravity * std::sin(angle), -kGravity * std::cos(angle));
}

TEST(Cylinder, RollsDownASlopeAtTwoThirdsOfGravity) {
  constexpr double kTangent = 0.2;
  const model::Scenario scenario = scene(1.0, R"(
- {name: c, shapes: [{cylinder: {length: 0.2, radius: 0.05}}], mass: 2, material: m, pose: {position: [0, 0, 0.05], rpy_deg: [90, 0, 0]}})",
                                         "{friction: 0.4, restitution: 0}", tilted_gravity(kTangent));
  Scene run(scenario);
  const physics::BodyId c = find_body(run.world(), "c");
  const double acceleration = 2.0 / 3.0 * kGravity * std::sin(std::atan(kTangent));
  for (int i = 1; i <= 1000; ++i) {
    ASSERT_EQ(run.advance().status, physics::StepStatus::Converged);
    const Twist V = physics::twist_of(run.world().model, run.state(), c);
    // 20 rad/s at the end: the arm of the contact is that at the start of the step, (omega dt)^2 = 4e-4 of it.
    ASSERT_NEAR(V.linear.x(), acceleration * i * 1e-3, 1e-3 * acceleration * i * 1e-3 + 2e-5) << i;
    ASSERT_NEAR(V.angular.y() * 0.05, V.linear.x(), 1e-3 * V.linear.x() + 2e-5);
    ASSERT_LT(std::abs(V.linear.z()), 1e-3);
  }
  const Pose X = physics::pose_of(run.world().model, run.state(), c);
  EXPECT_NEAR(X.p.x(), 0.5 * acceleration, 1e-3 * acceleration);
  EXPECT_NEAR(X.p.z(), 0.05, 2e-5);
  EXPECT_NEAR(X.p.y(), 0.0, 1e-5);
}

TEST(Cylinder, StandingTipsWhereItsWeightLeavesItsRim) {
  // r = 0.03 m, centre of mass at 0.1 m: tips at a slope of 0.3, whatever the direction its own x points to. Set down
  // flat it stands on eight points of its rim and rocks by 1e-4 rad before the lowest point is one of them: that much
  // energy takes it over from 1 % below (10 of 14 directions), not from 2 %.
  for (const double yaw : {0.0, 4.0, 10.0, 77.0}) {
    for (const double tangent : {0.294, 0.303}) {
      SCOPED_TRACE(fmt::format("yaw {} tangent {}", yaw, tangent));
      const model::Scenario scenario = scene(3.0,
                                             fmt::format(R"(
- {{name: c, shapes: [{{cylinder: {{length: 0.2, radius: 0.03}}}}], mass: 2, material: m, pose: {{position: [0, 0, 0.1], yaw_deg: {}}}}})",
                                                         yaw),
                                             "{friction: 1.0, restitution: 0}", tilted_gravity(tangent));
      const double height = body_of(run(scenario, {}), "c").X_WB.p.z();
      if (tangent < 0.3) {
        EXPECT_NEAR(height, 0.1, 1e-4);
      } else {
        EXPECT_LT(height, 0.05);
      }
    }
  }
}

TEST(Cylinder, RestsOnItsSideAndOnItsEndAndInAPyramid) {
  const model::Scenario scenario = scene(2.0, R"(
- {name: end, shapes: [{cylinder: {length: 0.2, radius: 0.03}}], mass: 2, material: m, pose: {position: [1, 0, 0.11]}}
- {name: left, shapes: [{cylinder: {length: 0.4, radius: 0.05}}], mass: 2, material: m, pose: {position: [0, -0.05, 0.05], rpy_deg: [0, 90, 0]}}
- {name: right, shapes: [{cylinder: {length: 0.4, radius: 0.05}}], mass: 2, material: m, pose: {position: [0, 0.05, 0.05], rpy_deg: [0, 90, 0]}}
- {name: top, shapes: [{cylinder: {length: 0.4, radius: 0.05}}], mass: 2, material: m, pose: {position: [0, 0, 0.1367], rpy_deg: [0, 90, 0]}}
- {name: stopper, kind: static, size: [0.1, 0.1, 0.2], material: m, pose: {position: [0, -0.15, 0.1]}}
- {name: stopper2, kind: static, size: [0.1, 0.1, 0.2], material: m, pose: {position: [0, 0.15, 0.1]}})");
  const RunResult result = run(scenario, {});
  EXPECT_FALSE(result.failure) << result.failure.text;
  EXPECT_NEAR(body_of(result, "end").X_WB.p.z(), 0.1, 1e-5);
  EXPECT_NEAR(body_of(result, "left").X_WB.p.z(), 0.05, 1e-5);
  EXPECT_NEAR(body_of(result, "top").X_WB.p.z(), 0.05 + 0.1 * std::sin(kPi / 3.0), 2e-4);
  for (const BodyResult& body : result.bodies) EXPECT_LT(body.speed, 1e-3) << body.name;
}

// --- meshes ---

std::string box_of_mesh(const std::string& name, int first, double x) {
  std::string text = "o " + name + "\n";
  for (int v = 0; v < 8; ++v) {
    text +=
        fmt::format("v {} {} {}\n", x + ((v & 1) != 0 ? 50 : -50), (v & 2) != 0 ? 100 : -100, (v & 4) != 0 ? 20 : -20);
  }
  for (const char* face : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"}) {
    text += "f";
    for (const char* at = face; *at != '\0'; at += at[1] == '\0' ? 1 : 2) text += fmt::format(" {}", first + *at - '1');
    text += "\n";
  }
  return text;
}

TEST(Mesh, GivesOneHullForEachOfItsParts) {
  const ScratchFolder folder;
  // Two boxes of 100 x 200 x 40 mm, 200 mm between their middles.
  (void)write(folder, "two.obj", box_of_mesh("left", 1, -100) + box_of_mesh("right", 9, 100));
  const std::string text = scene_text(1.0, R"(
- {name: b, shapes: [{mesh: {file: two.obj, scale: 0.001}}], mass: 2, material: m, pose: {position: [0, 0, 0.03]}})",
                                      "{friction: 0.4, restitution: 0}");
  const model::Scenario scenario = model::load_scenario(write(folder, "scene.yaml", text));
  const model::Body& body = scenario.bodies.back();
  ASSERT_EQ(body.shapes.size(), 2u);
  for (const model::PlacedShape& placed : body.shapes) {
    EXPECT_EQ(std::get<geometry::ConvexHull>(placed.shape).vertices.size(), 8u);
  }
  // Two cuboids of 1 kg: (0.1^2 + 0.2^2) / 12 each about its own middle, and 0.1 m away from the common one.
  EXPECT_NEAR(body.inertia.inertia(2, 2), 2.0 * ((0.01 + 0.04) / 12.0 + 0.01), 1e-7);  // floats in the file
  EXPECT_NEAR(body_of(run(scenario, {}), "b").X_WB.p.z(), 0.02, 1e-6);
}

TEST(Mesh, ErrorsNameTheFile) {
  const ScratchFolder folder;
  (void)write(folder, "flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  (void)write(folder, "large.obj", box_of_mesh("left", 1, 0));
  (void)write(folder, "text.obj", "not a mesh\n");
  for (const auto& [file, expected] :
       std::initializer_list<std::pair<std::string, std::string>>{{"flat.obj", "spans no volume"},
                                                                  {"large.obj", "scale: 0.001"},
                                                                  {"text.obj", "text.obj"},
                                                                  {"none.obj", "none.obj"}}) {
    const std::string error = loading_error(scene_text(1.0,
                                                       "- {name: b, shapes: [{mesh: {file: " + file +
                                                           "}}], mass: 2, material: m, pose: {position: [0, 0, 9]}}",
                                                       "{friction: 0, restitution: 0}"),
                                            (folder / "scene.yaml").string());
    EXPECT_NE(error.find(expected), std::string::npos) << file << ": " << error;
    EXPECT_NE(error.find("mesh"), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace snug::runs
