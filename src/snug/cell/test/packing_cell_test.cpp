// Packing cell: belts, paths, wrenches, cylinders, meshes; limits said, bodies lost, runs that go on.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "snug/cell/run.hpp"
#include "snug/cell/scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/reader.hpp"

namespace snug::cell {
namespace {

namespace fs = std::filesystem;

constexpr double kGravity = 9.81;
constexpr double kPi = std::numbers::pi;

/// A folder of its own that goes with the test.
class Folder {
 public:
  Folder() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = fs::temp_directory_path() / fmt::format("snug-{}-{}", info->name(), static_cast<const void*>(this));
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

/// Bodies on a floor whose top is z = 0; `more` are further keys of the scenario.
std::string scene_text(double duration, const std::string& bodies, const std::string& contact,
                       const std::string& more = "") {
  return fmt::format(R"(
name: test
duration: {}
{}
materials: [{{name: m}}]
contacts: {{default: {}}}
bodies:
- {{name: floor, kind: static, size: [20, 20, 1], material: m, pose: {{position: [0, 0, -0.5]}}}}
{})",
                     duration, more, contact, bodies);
}

model::Scenario scene(double duration, const std::string& bodies,
                      const std::string& contact = "{friction: 0.4, restitution: 0}", const std::string& more = "") {
  return model::parse_scenario(scene_text(duration, bodies, contact, more), "test.yaml");
}

const BodyResult& body_of(const RunResult& result, const std::string& name) {
  for (const BodyResult& body : result.bodies) {
    if (body.name == name) return body;
  }
  throw std::runtime_error("no body " + name);
}

std::string loading_error(const std::string& text, const std::string& name) {
  try {
    (void)model::parse_scenario(text, name);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// --- belts ---

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
  const Folder folder;
  (void)folder.write("way.csv",
                     "time,x,y,z,roll_deg,pitch_deg,yaw_deg\n"
                     "0.1,1,0,0.3,0,0,0\n"
                     "0.35,1.5,0.2,0.3,0,0,90\n"
                     "0.9,1.5,-0.4,0.8,30,-20,90\n");
  const fs::path file = folder.write("scene.yaml", scene_text(1.0, R"(
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
  for (int i = 1; i <= 1000; ++i) {
    (void)run.advance();
    const double t = i * 1e-3;
    const Pose X = physics::pose_of(run.world().model, run.state(), arm);
    Vector3 p(1, 0, 0.3);
    Matrix3 R = Matrix3::Identity();
    if (t >= 0.1) {
      const double s = std::min(1.0, (t - 0.1) / 0.25);
      p = Vector3(1 + 0.5 * s, 0.2 * s, 0.3);
      R = turn(0, 0, 90 * s);
    }
    if (t >= 0.35) {
      const double s = std::min(1.0, (t - 0.35) / 0.55);
      p = Vector3(1.5, 0.2 - 0.6 * s, 0.3 + 0.5 * s);
      const Vector3 whole = log_rotation(turn(0, 0, 90).transpose() * turn(30, -20, 90));
      R = turn(0, 0, 90) * exp_rotation(s * whole);
    }
    ASSERT_LT((X.p - p).norm(), 1e-12) << t;
    ASSERT_LT((X.R - R).norm(), 1e-12) << t;
  }
}

TEST(KinematicPath, CarriesWhatLiesOnIt) {
  const Folder folder;
  (void)folder.write("way.csv", "time,x,y,z,qw,qx,qy,qz\n0,0,0,0.05,1,0,0,0\n2,0.2,0,0.05,1,0,0,0\n");
  const fs::path file = folder.write("scene.yaml", scene_text(2.0, R"(
- {name: tray, kind: kinematic, size: [0.4, 0.4, 0.1], material: m, path: {file: way.csv}}
- {name: b, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 0.15]}})",
                                                              "{friction: 0.4, restitution: 0}"));
  // It lags by v^2 / (2 mu g) while it is brought up to speed, 1.3 mm.
  EXPECT_NEAR(body_of(run(model::load_scenario(file), {}), "b").X_WB.p.x(), 0.2 - 0.01 / (2 * 0.4 * kGravity), 1e-4);
}

TEST(KinematicPath, ErrorsNameFileLineAndColumn) {
  const Folder folder;
  const auto error_of = [&folder](const std::string& table) {
    (void)folder.write("way.csv", table);
    return loading_error(
        scene_text(1.0, "- {name: a, kind: kinematic, size: [1, 1, 1], material: m, path: {file: way.csv}}",
                   "{friction: 0.4, restitution: 0}"),
        folder.at("scene.yaml").string());
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
                folder.at("scene.yaml").string())
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
  EXPECT_EQ(result.failure, "");
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
  const Folder folder;
  // Two boxes of 100 x 200 x 40 mm, 200 mm between their middles.
  (void)folder.write("two.obj", box_of_mesh("left", 1, -100) + box_of_mesh("right", 9, 100));
  const std::string text = scene_text(1.0, R"(
- {name: b, shapes: [{mesh: {file: two.obj, scale: 0.001}}], mass: 2, material: m, pose: {position: [0, 0, 0.03]}})",
                                      "{friction: 0.4, restitution: 0}");
  const model::Scenario scenario = model::load_scenario(folder.write("scene.yaml", text));
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
  const Folder folder;
  (void)folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  (void)folder.write("large.obj", box_of_mesh("left", 1, 0));
  (void)folder.write("text.obj", "not a mesh\n");
  for (const auto& [file, expected] :
       std::initializer_list<std::pair<std::string, std::string>>{{"flat.obj", "spans no volume"},
                                                                  {"large.obj", "scale: 0.001"},
                                                                  {"text.obj", "text.obj"},
                                                                  {"none.obj", "none.obj"}}) {
    const std::string error = loading_error(scene_text(1.0,
                                                       "- {name: b, shapes: [{mesh: {file: " + file +
                                                           "}}], mass: 2, material: m, pose: {position: [0, 0, 9]}}",
                                                       "{friction: 0, restitution: 0}"),
                                            folder.at("scene.yaml").string());
    EXPECT_NE(error.find(expected), std::string::npos) << file << ": " << error;
    EXPECT_NE(error.find("mesh"), std::string::npos) << error;
  }
}

// --- what a run says of itself ---

TEST(ContactLimits, ASqueezedBoxIsAFailureThatNamesItAndLeavesTheResultWhole) {
  const Folder folder;
  const model::Scenario scenario = scene(2.0, R"(
- {name: wall, kind: static, size: [0.2, 1, 0.6], material: m, pose: {position: [0.5, 0, 0.3]}}
- {name: b, size: [0.2, 0.2, 0.2], mass: 2, material: m, pose: {position: [0.25, 0, 0.1]}}
- {name: pusher, kind: kinematic, size: [0.1, 0.3, 0.3], material: m, pose: {position: [0, 0, 0.2]}, twist: {linear: [0.2, 0, 0]}})");
  RunOptions options;
  options.record_path = folder.at("run.h5");
  const RunResult result = run(scenario, options);
  for (const char* word : {"rigid", "'b'", "mm deep", "t = ", "time_step", "solver.contact_limits.rigid_depth"}) {
    EXPECT_NE(result.failure.find(word), std::string::npos) << word << " in " << result.failure;
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
    EXPECT_NE(result.failure.find(word), std::string::npos) << word << " in " << result.failure;
  }
  EXPECT_EQ(result.solver.worst_penetration, 0.0);
  EXPECT_GT(result.solver.worst_compliant_depth, 0.02);
}

TEST(ContactLimits, AreTheScenarios) {
  // 20 kg on 12 kN/m: 16 mm.
  const std::string body = "- {name: b, size: [0.2, 0.3, 0.1], mass: 20, material: m, pose: {position: [0, 0, 0.05]}}";
  const std::string contact = "{friction: 0.5, restitution: 0, stiffness: 12000, damping: 500}";
  EXPECT_EQ(run(scene(1.0, body, contact, "solver: {contact_limits: {compliant_depth: 0.05}}"), {}).failure, "");
  EXPECT_NE(run(scene(1.0, body, contact, "solver: {contact_limits: {compliant_depth: 0.01}}"), {}).failure, "");
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
  EXPECT_EQ(result.failure, "");
  EXPECT_NE(loading_error(scene_text(1.0, body(0.05 - 1.2 * depth), contact), "t.yaml").find("overlaps"),
            std::string::npos);
  EXPECT_NE(
      loading_error(scene_text(1.0, body(0.05 - depth), "{friction: 0.5, restitution: 0}"), "t.yaml").find("1 mm"),
      std::string::npos);
}

TEST(LostBody, IsAnOutcomeAndTheRunGoesOnWithoutIt) {
  const Folder folder;
  const model::Scenario scenario = scene(3.0, R"(
- {name: thrown, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 5]}, twist: {linear: [0, 900, 100]}}
- {name: later, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [5, 0, 5]}, twist: {linear: [990, 0, 0]}, appears_at: 0.5}
- {name: b, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 1]}})");
  RunOptions options;
  options.record_path = folder.at("run.h5");
  const RunResult result = run(scenario, options);
  EXPECT_EQ(result.failure, "");
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
  const Folder folder;
  RunOptions options;
  options.record_path = folder.at("run.h5");
  (void)run(scene(1.0, "- {name: b, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 1]}}",
                  "{friction: 0.4, restitution: 0}", "record_period: 0.02"),
            options);
  const record::Recording recording = record::load_recording(options.record_path);
  EXPECT_EQ(recording.frames.size(), 50u);
  EXPECT_DOUBLE_EQ(recording.header.record_period, 0.02);
  EXPECT_NEAR(recording.frames[1].time - recording.frames[0].time, 0.02, 1e-12);
}

TEST(Resume, GoesOnFromAnInstantAsIfItHadNotStopped) {
  const Folder folder;
  // In flight, spinning; asleep on the floor; appears before and after the instant; on a kinematic tray.
  const std::string bodies = R"(
- {name: flying, size: [0.1, 0.2, 0.3], mass: 1, material: m, com: [0.01, 0, 0], pose: {position: [0, 0, 9]}, twist: {linear: [0.3, 0, 2], angular: [3, 2, 1]}}
- {name: resting, size: [0.2, 0.2, 0.1], mass: 1, material: m, pose: {position: [2, 0, 0.05]}}
- {name: early, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [3, 0, 5]}, appears_at: 0.2}
- {name: late, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [4, 0, 5]}, appears_at: 0.9}
- {name: tray, kind: kinematic, size: [0.3, 0.3, 0.1], material: m, pose: {position: [-2, 0, 0.5]}, twist: {linear: [0.1, 0, 0]}})";
  RunOptions options;
  options.record_path = folder.at("run.h5");
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
  const Folder folder;
  const std::string body = "- {name: b, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 1]}}";
  RunOptions options;
  options.record_path = folder.at("run.h5");
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
  scenario.initial_state = model::InitialState{folder.at("none.h5"), std::nullopt};
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
}  // namespace snug::cell
