// Tests of scene identification: planted numbers come back, what recordings do not tell is refused by name.
#include "snug/identification/scene_fit.hpp"
#include "snug/core/test/scratch_folder.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <string>

#include "snug/cell/scene.hpp"
#include "snug/core/descriptor.hpp"
#include "snug/core/file_lock.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/identification/fitted_scenario.hpp"
#include "snug/identification/free_flight.hpp"
#include "snug/identification/internal/followed_rows.hpp"
#include "snug/identification/internal/motion_error.hpp"
#include "snug/identification/internal/program_motion.hpp"
#include "snug/identification/scene_page.hpp"
#include "snug/identification/test/helpers.hpp"
#include "snug/model/number_edit.hpp"

namespace snug::identification {
namespace {

constexpr double kPositionNoise = 0.0002, kRotationNoise = 0.002;  // m, rad: motion capture

/// A box is thrown onto a floor: it flies, hits, slides and comes to rest.
constexpr const char* kThrown = R"(name: thrown
duration: 1.0
materials:
  - {name: box}
  - {name: floor}
contacts:
  pairs:
    - {between: [box, floor], friction: 0.3, restitution: 0.2}
bodies:
  - {name: floor, kind: static, size: [20, 20, 0.2], material: floor, pose: {position: [0, 0, -0.1]}}
  - name: parcel
    size: [0.2, 0.16, 0.1]
    mass: 0.8
    material: box
    com: [0, 0, 0]
    inertia: [0.0025, 0.0035, 0.0045]
    pose: {position: [0, 0, 0.12]}
    twist: {linear: [1.2, 0.3, 0], angular: [0, 0, 1.0]}
)";

class SceneFitTest : public ::testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder_ / "scene.yaml") << kThrown; }

  [[nodiscard]] model::SceneTask task(const std::string& more) const {
    return model::parse_scene_task(
        "scenario: scene.yaml\ntracked_objects: [{body: parcel}]\n"
        "start: {from: scenario}\nnoise: {position: 0.0002, rotation_deg: 0.1146}\n" +
            more,
        folder_ / "task.yaml");
  }

  /// What 180 Hz motion capture would have seen with these numbers.
  [[nodiscard]] RecordedMotion record(const std::vector<model::NumberEdit>& truth, std::uint64_t seed,
                                      double noise = 1.0) const {
    cell::Scene scene(model::with_numbers(model::load_scenario(folder_ / "scene.yaml"), truth));
    const physics::BodyId id = cell::find_body(scene.world(), "parcel");
    Rng rng = Rng(seed).split("recorded");
    RecordedMotion motion;
    motion.name = "virtual";
    motion.tracked.push_back({"parcel", {}, {}, {}});
    const auto normal3 = [&](double deviation) {
      const double x = rng.normal(), y = rng.normal(), z = rng.normal();
      return Vector3(noise * deviation * Vector3(x, y, z));
    };
    for (int i = 0; i <= 700; ++i) {
      if (i % 5 == 0) {
        Pose X = physics::pose_of(scene.world().model, scene.state(), id);
        X.p += normal3(kPositionNoise);
        X.R = X.R * exp_rotation(normal3(kRotationNoise));
        motion.times.push_back(i * 1e-3);
        motion.tracked[0].poses.emplace_back(X);
      }
      (void)scene.advance();
    }
    return motion;
  }

  snug::test::ScratchFolder folder_;
};

constexpr const char* kTwo = R"(search: {local: 100, held_back: 5}
parameters:
  - {name: friction, path: "contacts.pairs[0].friction", value: 0.3, bounds: [0.05, 0.8], step: 0.002}
  - {name: restitution, path: "contacts.pairs[0].restitution", value: 0.2, bounds: [0, 0.9], step: 0.002}
)";

TEST_F(SceneFitTest, FindsPlantedFrictionAndRestitutionWithIntervalsThatCover) {
  const std::vector<model::NumberEdit> truth{{"contacts.pairs[0].friction", 0.41},
                                             {"contacts.pairs[0].restitution", 0.35}};
  const SceneExperiment experiment(task(kTwo), {record(truth, 1), record(truth, 2)}, 2);
  const SceneFit fit = identify_scene(experiment);
  ASSERT_EQ(fit.parameters.size(), 2U);
  EXPECT_NEAR(fit.values[0], 0.41, 0.01);
  EXPECT_NEAR(fit.values[1], 0.35, 0.03);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(fit.parameters[static_cast<std::size_t>(i)].verdict, Verdict::Identified);
    // Four standard errors: one case in ten thousand.
    EXPECT_LE(std::abs(fit.values[i] - truth[static_cast<std::size_t>(i)].value),
              4.0 * std::sqrt(fit.covariance(i, i)));
  }
  EXPECT_NEAR(fit.chi2_per_dof, 1.0, 0.15);
  EXPECT_TRUE(fit.is_trusted);
  EXPECT_LT(fit.held_back_error, 1.0);  // mm; with noise of 0.35 mm in all
}

TEST_F(SceneFitTest, WritesWhatStaysUncertainWhereAllNumbersOfAKindWereFound) {
  const SceneExperiment experiment(task(kTwo), {record({}, 1)}, 1);
  SceneFit fit;
  fit.values = experiment.start();
  fit.parameters = {{"friction", 0.3, 0.003, "", Verdict::Identified, ""},
                    {"restitution", 0.2, 0.01, "", Verdict::Identified, ""}};
  const FittedScenario fitted = fitted_scenario(experiment, fit);
  const model::Scenario& found = fitted.scenario;
  EXPECT_NEAR(found.uncertainty.friction, std::sqrt(3.0) * 0.01, 1e-4);  // the only pair
  model::Uncertainty others = found.uncertainty;
  others.friction = model::Uncertainty{}.friction;
  EXPECT_EQ(others, model::Uncertainty{});
  EXPECT_EQ(model::parse_scenario(found.source_text, "again").uncertainty, found.uncertainty);
  const std::string page = make_page(experiment, fit, fitted.changes);
  EXPECT_NE(page.find("0.0173"), std::string::npos) << page;
  fit.parameters[0].verdict = Verdict::NotIdentifiable;
  EXPECT_EQ(fitted_scenario(experiment, fit).scenario.uncertainty, model::Uncertainty{});
}

TEST_F(SceneFitTest, GivesTheSameBytesAtAnyNumberOfThreads) {
  const std::vector<model::NumberEdit> truth{{"contacts.pairs[0].friction", 0.35}};
  const std::vector<RecordedMotion> motions{record(truth, 3), record(truth, 4)};
  const SceneFit one = identify_scene(SceneExperiment(task(kTwo), motions, 1));
  const SceneFit three = identify_scene(SceneExperiment(task(kTwo), motions, 3));
  EXPECT_EQ(one.values, three.values);
  EXPECT_EQ(one.parameters, three.parameters);
  EXPECT_EQ(one.evaluations, three.evaluations);
}

TEST_F(SceneFitTest, RefusesByNameWhatTheRecordingsDoNotTell) {
  // Mass and inertia together change nothing where only gravity and dry friction act.
  const model::SceneTask both = task(R"(search: {local: 60}
parameters:
  - {name: friction, path: "contacts.pairs[0].friction", value: 0.3, bounds: [0.05, 0.8], step: 0.002}
  - {name: weight, form: scale, paths: [bodies.parcel.mass, "bodies.parcel.inertia[0]", "bodies.parcel.inertia[1]", "bodies.parcel.inertia[2]"], value: 1.5, bounds: [0.5, 2]}
)");
  const SceneFit fit = identify_scene(SceneExperiment(both, {record({}, 5)}, 2));
  ASSERT_EQ(fit.unknown.size(), 1U);
  ASSERT_EQ(fit.unknown[0].shares.size(), 1U);
  EXPECT_EQ(fit.unknown[0].shares[0].first, "weight");
  EXPECT_EQ(fit.parameters[1].verdict, Verdict::NotIdentifiable);
  EXPECT_EQ(fit.values[1], 1.5);  // left alone
  EXPECT_TRUE(std::isinf(fit.parameters[1].standard_error));
  EXPECT_NEAR(fit.values[0], 0.3, 0.01);
}

/// A box slides over a floor towards a wall.
constexpr const char* kSliding = R"(name: sliding
duration: 1.0
gravity: [0, 0, -9.81]
materials: [{name: box}, {name: floor}, {name: wall}]
contacts:
  pairs:
    - {between: [box, floor], friction: 0.3, restitution: 0.0}
    - {between: [box, wall], friction: 0.0, restitution: 0.3}
bodies:
  - {name: floor, kind: static, size: [8, 2, 0.1], material: floor, pose: {position: [0, 0, -0.05]}}
  - {name: wall, kind: static, size: [0.1, 2, 0.4], material: wall, pose: {position: [0.75, 0, 0.21]}}
  - name: parcel
    size: [0.2, 0.2, 0.1]
    mass: 0.55
    material: box
    pose: {position: [0, 0, 0.05]}
    twist: {linear: [1.0, 0, 0]}
)";

TEST_F(SceneFitTest, GivesTheErrorOfAFrozenPartnerToTheOtherOne) {
  std::ofstream(folder_ / "scene.yaml") << kSliding;
  // On a plane only their product shows; gravity starts 5 % off.
  const model::SceneTask both = task(R"(search: {local: 60, held_back: 0}
parameters:
  - {name: mu, path: "contacts.pairs[0].friction", value: 0.3, bounds: [0.05, 0.6]}
  - {name: g, form: scale, path: "gravity[2]", value: 1.05, bounds: [0.7, 1.3]}
)");
  const SceneFit fit = identify_scene(SceneExperiment(both, {record({{"contacts.pairs[0].friction", 0.22}}, 12)}, 2));
  EXPECT_NEAR(fit.chi2_per_dof, 1.0, 0.2);
  EXPECT_NE(fit.parameters[0].verdict, Verdict::Identified);
  EXPECT_LT(std::abs(fit.values[0] - 0.22), 3.0 * fit.parameters[0].standard_error);
  EXPECT_LT(fit.covariance(0, 1) / std::sqrt(fit.covariance(0, 0) * fit.covariance(1, 1)), -0.95);
}

TEST_F(SceneFitTest, FindsWhatTheFirstSimulationDoesNotReach) {
  std::ofstream(folder_ / "scene.yaml") << kSliding;
  const std::vector<model::NumberEdit> truth{{"contacts.pairs[0].friction", 0.22},
                                             {"bodies.parcel.twist.linear[0]", 2.1},
                                             {"contacts.pairs[1].restitution", 0.4}};
  const model::SceneTask wall = task(R"(search: {local: 100, held_back: 0}
parameters:
  - {name: mu, path: "contacts.pairs[0].friction", value: 0.3, bounds: [0.05, 0.6]}
  - {name: v0, path: "bodies.parcel.twist.linear[0]", value: 1.4, bounds: [1.3, 2.5]}
  - {name: e, path: "contacts.pairs[1].restitution", value: 0.2, bounds: [0, 0.9]}
)");
  SceneFitOptions options;
  options.with_profile = true;
  const SceneFit fit = identify_scene(SceneExperiment(wall, {record(truth, 13), record(truth, 14)}, 2), options);
  EXPECT_TRUE(fit.unknown.empty());
  EXPECT_NEAR(fit.chi2_per_dof, 1.0, 0.15);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(fit.parameters[i].verdict, Verdict::Identified) << fit.parameters[i].name;
    EXPECT_LT(std::abs(fit.parameters[i].value - truth[i].value), 4.0 * fit.parameters[i].standard_error);
    // The sum of squares is a parabola here: the profile's interval is that of two standard errors.
    ASSERT_EQ(fit.profiles.size(), 3U);
    const double half = 0.5 * (fit.profiles[i].high - fit.profiles[i].low);
    EXPECT_NEAR(half / (1.96 * fit.parameters[i].standard_error), 1.0, 0.3) << fit.parameters[i].name;
  }
}

TEST_F(SceneFitTest, LeavesOutSamplesThatJumpAndCountsThem) {
  const std::vector<model::NumberEdit> truth{{"contacts.pairs[0].friction", 0.41}};
  RecordedMotion motion = record(truth, 15);
  std::vector<record::PoseSample>& poses = motion.tracked[0].poses;
  poses[40].p.x() += 0.3;
  poses[41].p.z() -= 0.05;
  poses[90] = Pose{poses[90].pose().R * exp_rotation(Vector3(0.0, 0.0, 3.1)), poses[90].p};
  const SceneFit fit = identify_scene(SceneExperiment(task(kTwo), {motion, record(truth, 16)}, 2));
  ASSERT_EQ(fit.rejected.size(), 1U);
  EXPECT_EQ(fit.rejected[0].samples, 3);
  EXPECT_NEAR(fit.chi2_per_dof, 1.0, 0.15);
  EXPECT_LT(std::abs(fit.values[0] - 0.41), 4.0 * fit.parameters[0].standard_error);
}

TEST_F(SceneFitTest, NamesUnitsAndConventionsThatAreNotOurs) {
  const RecordedMotion good = record({}, 17);
  const auto refused = [&](const std::function<void(RecordedMotion&)>& spoil, const char* part) {
    RecordedMotion bad = good;
    spoil(bad);
    test::expect_refused([&] { (void)SceneExperiment(task(kTwo), {bad}, 1); }, part);
  };
  const auto each = [](RecordedMotion& motion, const std::function<void(record::PoseSample&)>& change) {
    for (record::PoseSample& pose : motion.tracked[0].poses) change(pose);
  };
  refused(
      [](RecordedMotion& motion) {
        for (double& time : motion.times) time *= 1e3;
      },
      "milliseconds");
  refused(
      [&](RecordedMotion& motion) {
        each(motion, [](record::PoseSample& pose) { pose.p = 1e3 * (pose.p + Vector3(0.5, 0.0, 0.0)); });
      },
      "millimetres");
  refused(
      [&](RecordedMotion& motion) {  // x, y, z, w where w, x, y, z is read
        each(motion, [](record::PoseSample& pose) {
          pose.quat = Quaternion(pose.quat.x(), pose.quat.y(), pose.quat.z(), pose.quat.w());
        });
      },
      "x, y, z, w");
  refused(
      [&](RecordedMotion& motion) {
        each(motion, [](record::PoseSample& pose) {
          pose = Pose{pose.pose().R * exp_rotation(Vector3(0.0, 0.0, 3.14)), pose.p};
        });
      },
      "180 degrees");
  refused(
      [&](RecordedMotion& motion) {
        for (std::size_t k = 60; k < motion.tracked[0].poses.size(); ++k) {
          record::PoseSample& pose = motion.tracked[0].poses[k];
          pose = Pose{pose.pose().R * exp_rotation(Vector3(3.14, 0.0, 0.0)), pose.p};
        }
      },
      "half turn about its x axis");
}

TEST_F(SceneFitTest, ReadsRowsInWhichMarkersWereLost) {
  const std::string columns = "t,x,y,z,qw,qx,qy,qz\n";
  const auto read = [&](const std::string& row) {
    return parse_motions(task(kTwo), columns + "0,0,0,0.12,1,0,0,0\n0.1,0.1,0,0.1,1,0,0,0\n" + row + "\n", "a.csv");
  };
  for (const char* row : {"0.2,,,,,,,", "0.2,nan,nan,nan,nan,nan,nan,nan"}) {
    const std::vector<RecordedMotion> motions = read(row);
    ASSERT_EQ(motions[0].times.size(), 3U);
    EXPECT_FALSE(record::is_tracked(motions[0].tracked[0].poses[2]));
  }
  test::expect_refused([&] { (void)read("0.2,0.1,,0.1,1,0,0,0"); }, "beside other numbers");
  test::expect_refused([&] { (void)read(",0.1,0,0.1,1,0,0,0"); }, "every row");
}

/// A robot's log with a tool on a circle, and a box that comes after 2 s and is picked after 4 s.
TEST(RecordedDrive, IsThePathOfTheLogWithItsSwitchAndTheBoxesThatCame) {
  const auto tool_at = [](double t) {
    return Pose{exp_rotation(Vector3(0.0, 0.0, 0.3 * std::sin(t))),
                Vector3(0.3 * std::cos(0.5 * t), 0.3 * std::sin(0.5 * t), 0.2)};
  };
  Rng rng = Rng(3).split("log");
  record::ArchiveRecording recording;
  recording.robot.names = {"actual_digital_output_bits"};
  recording.robot.columns.resize(1);
  for (int k = 0; k < 1000; ++k) {
    const double t = 0.003 + 0.008 * k;
    recording.robot.times.push_back(50.0 + t);
    Pose X = tool_at(t);
    X.p += 3e-5 * Vector3(rng.normal(), rng.normal(), rng.normal());
    recording.robot.tool.emplace_back(X);
    recording.robot.columns[0].push_back(t > 4.0 ? 1.0 : 0.0);
  }
  ASSERT_TRUE(has_drive(recording));
  const validation::SimulatedRun run = run_of_log(recording, {"BOX"});
  validation::Measurement measured;
  measured.bodies.resize(1);
  const Pose X_WP{Matrix3::Identity(), tool_at(4.0).p - Vector3(0.0, 0.0, 0.1)};
  for (int k = 0; k < 720; ++k) {
    const double t = k / 120.0;
    measured.pose_times.push_back(t);
    measured.bodies[0].push_back(t < 2.0 ? record::lost_pose() : record::PoseSample(X_WP));
  }
  const RecordedDrive drive = make_drive(recording, run, measured, 0.008);
  double worst = 0.0, worst_speed = 0.0;
  for (std::size_t k = 4; k + 4 < drive.tool.size(); ++k) {
    const double t = 0.003 + 0.008 * static_cast<double>(k);
    worst = std::max(worst, (drive.tool[k].X_WE.p - tool_at(t).p).norm());
    const Vector3 v = 0.15 * Vector3(-std::sin(0.5 * t), std::cos(0.5 * t), 0.0);
    worst_speed = std::max(worst_speed, (drive.tool[k].V_WE.linear - v).norm());
  }
  EXPECT_LT(worst, 9e-5);        // 30 um of noise, less by sqrt(3): five deviations of the furthest of 1000
  EXPECT_LT(worst_speed, 0.01);  // what the same noise does to slopes over 48 ms
  ASSERT_EQ(drive.arrivals.size(), 1U);
  EXPECT_NEAR(drive.arrivals[0].time, 2.0, 0.009);
  EXPECT_LT((drive.arrivals[0].X_WP.p - X_WP.p).norm(), 1e-12);
  std::size_t first = 0;
  while (!drive.vacuum[first]) ++first;
  EXPECT_NEAR(0.008 * static_cast<double>(first), 4.0 - 0.003, 0.0081);
}

TEST_F(SceneFitTest, FindsOwnStartVelocityAndDelayOfEachRecording) {
  const std::vector<model::NumberEdit> truth{{"contacts.pairs[0].friction", 0.25},
                                             {"bodies.parcel.twist.linear[0]", 1.27}};
  std::vector<RecordedMotion> motions{record(truth, 6), record(truth, 7)};
  for (double& time : motions[0].times) time += 0.004;  // its clock is late
  const model::SceneTask own = task(R"(own: {velocity: 0.1, delay: 0.01}
search: {local: 100, held_back: 0}
parameters:
  - {name: friction, path: "contacts.pairs[0].friction", value: 0.3, bounds: [0.05, 0.8], step: 0.002}
)");
  const SceneFit fit = identify_scene(SceneExperiment(own, motions, 2));
  EXPECT_NEAR(fit.values[0], 0.25, 0.01);
  EXPECT_NEAR(fit.chi2_per_dof, 1.0, 0.2);
}

TEST_F(SceneFitTest, AClockOfUnknownRateIsInTheErrorsOfSpeedAndFriction) {
  std::string slides = kThrown;
  slides.replace(slides.find("[0, 0, 0.12]"), 12, "[0, 0, 0.05]");
  slides.replace(slides.find("[1.2, 0.3, 0], angular: [0, 0, 1.0]"), 35, "[1.2, 0, 0], angular: [0, 0, 0]");
  std::ofstream(folder_ / "scene.yaml") << slides;
  const std::vector<RecordedMotion> motions{record({}, 30)};
  const auto errors_with = [&](const std::string& rate) {
    return identify_scene(SceneExperiment(task("clock_rate: " + rate + R"(
search: {local: 100, held_back: 0}
parameters:
  - {name: friction, path: "contacts.pairs[0].friction", value: 0.3, bounds: [0.05, 0.8]}
  - {name: speed, path: "bodies.parcel.twist.linear[0]", value: 1.2, bounds: [0.5, 2]}
)"),
                                          motions, 2))
        .parameters;
  };
  const std::vector<Parameter> known = errors_with("0"), unknown = errors_with("0.02");
  // Times that are too long by r make speeds too small by r, accelerations by 2 r.
  const auto added = [&](std::size_t i) {
    return std::sqrt(std::pow(unknown[i].standard_error, 2) - std::pow(known[i].standard_error, 2));
  };
  EXPECT_NEAR(added(0), 2.0 * 0.02 * 0.3, 0.05 * 2.0 * 0.02 * 0.3);
  EXPECT_NEAR(added(1), 0.02 * 1.2, 0.05 * 0.02 * 1.2);
  EXPECT_EQ(known[0].value, unknown[0].value);
}

TEST_F(SceneFitTest, FindsTheRateOfARecordingsOwnClock) {
  std::vector<RecordedMotion> motions{record({{"contacts.pairs[0].friction", 0.25}}, 40)};
  for (double& time : motions[0].times) time *= 1.01;
  const std::string rest = R"(search: {local: 100, held_back: 0}
parameters:
  - {name: friction, path: "contacts.pairs[0].friction", value: 0.3, bounds: [0.05, 0.8], step: 0.002}
)";
  const SceneFit fit = identify_scene(SceneExperiment(task("own: {clock_rate: 0.01}\n" + rest), motions, 2));
  EXPECT_NEAR(fit.values[0], 0.25, 0.005);
  EXPECT_NEAR(fit.chi2_per_dof, 1.0, 0.2);
  EXPECT_GT(identify_scene(SceneExperiment(task(rest), motions, 2)).chi2_per_dof, 3.0);
}

TEST_F(SceneFitTest, FindsWhereTheRecordedFrameSitsInItsBody) {
  // 9 mm and 1.7 degrees off: without unknowns of its own for them friction would have to explain what it cannot.
  const Pose X_BM{exp_rotation(Vector3(0.02, -0.01, 0.02)), Vector3(0.005, -0.006, 0.004)};
  std::vector<RecordedMotion> motions{record({{"contacts.pairs[0].friction", 0.25}}, 16)};
  for (record::PoseSample& pose : motions[0].tracked[0].poses) pose = pose.pose() * X_BM;
  const std::string rest = R"(search: {local: 100, held_back: 0}
parameters:
  - {name: friction, path: "contacts.pairs[0].friction", value: 0.3, bounds: [0.05, 0.8], step: 0.002}
)";
  const SceneFit fit =
      identify_scene(SceneExperiment(task("own: {frame_position: 0.005, frame_rotation_deg: 1}\n" + rest), motions, 2));
  EXPECT_NEAR(fit.values[0], 0.25, 0.01);
  EXPECT_NEAR(fit.chi2_per_dof, 1.0, 0.2);
  EXPECT_GT(identify_scene(SceneExperiment(task(rest), motions, 2)).chi2_per_dof, 100.0);
}

TEST_F(SceneFitTest, FindsWhereTheRecordedWorldSits) {
  // 5 mm and 0.6 degrees off, as a robot base whose pose is known badly.
  const Pose X_MW{exp_rotation(Vector3(0.006, -0.008, 0.005)), Vector3(0.003, 0.004, -0.001)};
  std::vector<RecordedMotion> motions{record({{"contacts.pairs[0].friction", 0.25}}, 18)};
  for (record::PoseSample& pose : motions[0].tracked[0].poses) pose = X_MW * pose.pose();
  const std::string rest = R"(search: {local: 100, held_back: 0}
parameters:
  - {name: friction, path: "contacts.pairs[0].friction", value: 0.3, bounds: [0.05, 0.8], step: 0.002}
)";
  const SceneFit fit =
      identify_scene(SceneExperiment(task("own: {bias: 0.005, bias_rotation_deg: 1}\n" + rest), motions, 2));
  EXPECT_NEAR(fit.values[0], 0.25, 0.01);
  EXPECT_NEAR(fit.chi2_per_dof, 1.0, 0.2);
  EXPECT_GT(identify_scene(SceneExperiment(task(rest), motions, 2)).chi2_per_dof, 10.0);
  // Unless the task says, the recording does.
  motions[0].world_position_error = 0.004;
  motions[0].world_rotation_error = 0.01;
  const SceneExperiment told(task(rest), motions, 2);
  EXPECT_EQ(told.task().own.bias, 0.004);
  EXPECT_EQ(told.task().own.bias_rotation, 0.01);
  EXPECT_NEAR(identify_scene(told).values[0], 0.25, 0.01);
  EXPECT_EQ(SceneExperiment(task("own: {bias: 0.001}\n" + rest), motions, 2).task().own.bias, 0.001);
}

TEST_F(SceneFitTest, OwnUnknownsChangeTheRowsThatTheirTermNamesAndNoOther) {
  std::string two = kThrown;
  two.insert(two.find("bodies:"), "    - {between: [box, box], friction: 0.3, restitution: 0.1}\n");
  std::ofstream(folder_ / "scene.yaml")
      << two << "  - {name: other, size: [0.1, 0.1, 0.1], mass: 0.5, material: box, pose: {position: [3, 3, 0.05]}, "
      << "twist: {angular: [0, 0, 1]}}\n";
  RecordedMotion motion = record({}, 17);
  motion.tracked.push_back(motion.tracked.front());
  motion.tracked.back().body = "other";
  model::SceneTask both = task(
      "own: {velocity: 0.1, delay: 0.01, bias: 0.001, bias_rotation_deg: 0.1, frame_position: 0.005, "
      "frame_rotation_deg: 1}\n"
      "search: {local: 10, held_back: 0}\n"
      "parameters: [{name: friction, path: \"contacts.pairs[0].friction\", value: 0.3, bounds: [0.05, 0.8], step: "
      "0.002}]\n");
  both.tracked.push_back(both.tracked.front());
  both.tracked.back().body = "other";
  const SceneExperiment scene(both, {motion}, 1);
  const numerics::BatchedProblem::Term term = scene.term_of(0);
  ASSERT_EQ(term.own.size(), 3 + 1 + 6 + 2 * 6);
  ASSERT_EQ(term.own_rows.size(), static_cast<std::size_t>(term.own.size()));
  const std::vector<Eigen::VectorXd> points{scene.start()};
  const auto residuals = [&](const Eigen::VectorXd& own) {
    return scene.evaluate(points, std::vector<SceneExperiment::Job>{{0, 0, own}}).front().residuals;
  };
  const Eigen::VectorXd before = residuals(term.own);
  ASSERT_EQ(before.size(), term.residuals);
  for (Eigen::Index j = 0; j < term.own.size(); ++j) {
    SCOPED_TRACE(j);
    Eigen::VectorXd moved = term.own;
    moved[j] += term.own_step[j];
    Eigen::VectorXd change = residuals(moved) - before;
    for (const auto& [first, count] : term.own_rows[static_cast<std::size_t>(j)]) {
      EXPECT_GT(change.segment(first, count).norm(), 0.0);
      change.segment(first, count).setZero();
    }
    EXPECT_EQ(change.norm(), 0.0);
  }
}

TEST_F(SceneFitTest, FindsACentreOfMassThatIsAside) {
  const std::vector<model::NumberEdit> truth{{"bodies.parcel.com[0]", 0.012}, {"bodies.parcel.com[1]", -0.007}};
  const model::SceneTask com = task(R"(search: {local: 100, held_back: 0}
parameters:
  - {name: com_x, path: "bodies.parcel.com[0]", value: 0, bounds: [-0.03, 0.03], step: 0.0005}
  - {name: com_y, path: "bodies.parcel.com[1]", value: 0, bounds: [-0.03, 0.03], step: 0.0005}
)");
  const SceneFit fit = identify_scene(SceneExperiment(com, {record(truth, 8), record(truth, 9)}, 2));
  EXPECT_NEAR(fit.values[0], 0.012, 0.002);
  EXPECT_NEAR(fit.values[1], -0.007, 0.002);
}

// A recorded world that sits higher by less than a sample's noise: chi2 hardly shows it (1 + 0.81 / 6), nor do
// neighbours, whose correlation is shared among six axes; its axis is off through every part of all recordings.
TEST_F(SceneFitTest, IdentifiesNothingWhereOneAxisIsOffThroughAllRecordings) {
  const std::vector<model::NumberEdit> truth{{"contacts.pairs[0].friction", 0.41},
                                             {"contacts.pairs[0].restitution", 0.35}};
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    std::vector<RecordedMotion> motions{record(truth, seed), record(truth, seed + 10)};
    EXPECT_FALSE(identify_scene(SceneExperiment(task(kTwo), motions, 2)).is_systematic) << seed;
    for (RecordedMotion& motion : motions) {
      for (auto& pose : motion.tracked[0].poses) pose.p.z() += 0.9 * kPositionNoise;
    }
    const SceneFit fit = identify_scene(SceneExperiment(task(kTwo), motions, 2));
    EXPECT_LT(fit.chi2_per_dof, 1.3);
    EXPECT_TRUE(fit.is_systematic) << seed;
    for (const auto& parameter : fit.parameters) EXPECT_NE(parameter.verdict, Verdict::Identified) << seed;
  }
}

TEST_F(SceneFitTest, SaysThatItCannotBeTrustedWhenTheSceneIsAnother) {
  // The floor is another one than the scenario has, and nothing that may move explains it.
  const model::SceneTask wrong = task(R"(search: {local: 40, held_back: 0}
parameters:
  - {name: restitution, path: "contacts.pairs[0].restitution", value: 0.2, bounds: [0, 0.9], step: 0.002}
)");
  const SceneFit fit = identify_scene(SceneExperiment(wrong, {record({{"contacts.pairs[0].friction", 0.6}}, 10)}, 2));
  EXPECT_FALSE(fit.is_trusted);
  EXPECT_EQ(fit.parameters[0].verdict, Verdict::NotIdentifiable);
}

TEST_F(SceneFitTest, GoesOnFromItsLogWithoutComputingAgain) {
  const std::string text = std::string("loss: distance\n") + kTwo;
  const std::vector<RecordedMotion> motions{record({{"contacts.pairs[0].friction", 0.4}}, 11)};
  SceneFitOptions options;
  options.log = folder_ / "points.csv";
  options.with_errors = false;
  const SceneFit first = identify_scene(SceneExperiment(task(text), motions, 2), options);
  std::ifstream file(options.log);
  const std::string before(std::istreambuf_iterator<char>(file), {});
  const SceneFit second = identify_scene(SceneExperiment(task(text), motions, 2), options);
  std::ifstream again(options.log);
  EXPECT_EQ(before, std::string(std::istreambuf_iterator<char>(again), {}));  // nothing new
  EXPECT_EQ(first.values, second.values);
  EXPECT_NEAR(first.values[0], 0.4, 0.01);
  // What a kill cut is taken away, and nothing else; a log that another search writes is refused.
  for (const std::string& cut : {before + "0.25,0.", before.substr(0, before.size() - 3), before.substr(0, 10)}) {
    std::ofstream(options.log, std::ios::binary) << cut;
    (void)identify_scene(SceneExperiment(task(text), motions, 2), options);
    std::ifstream whole(options.log);
    EXPECT_EQ(before, std::string(std::istreambuf_iterator<char>(whole), {})) << cut.size();
  }
  {
    const Descriptor other(::open(options.log.c_str(), O_RDWR | O_CLOEXEC));
    ASSERT_TRUE(try_lock(other.get(), LockByte::Writer, LockKind::Exclusive));
    EXPECT_THROW((void)identify_scene(SceneExperiment(task(text), motions, 2), options), InputError);
  }
  // The log of another problem is refused.
  std::ofstream(options.log) << "something else\n";
  EXPECT_THROW((void)identify_scene(SceneExperiment(task(text), motions, 2), options), InputError);
}

TEST_F(SceneFitTest, SaysWhichBodyAndWhichPathIsWrong) {
  const auto message = [&](const std::string& more) {
    try {
      const SceneExperiment experiment(task(more), {record({}, 12)}, 1);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  const std::string path = message("parameters: [{name: a, path: contacts.pears.friction, value: 1, bounds: [0, 2]}]");
  EXPECT_NE(path.find("nearest is 'pairs'"), std::string::npos) << path;
  const std::string key =
      message("parameters: [{name: a, path: \"contacts.pairs[0].frictoin\", value: 1, bounds: [0, 2]}]");
  EXPECT_NE(key.find("friction"), std::string::npos) << key;
  const std::string list = message("parameters: [{name: a, path: bodies.parcel.size, value: 1, bounds: [0, 2]}]");
  EXPECT_NE(list.find("single number"), std::string::npos) << list;
}

TEST(ProgramMotion, OfAnAcceleratedBodyIsTheMeanWhereARecordingHasMeans) {
  constexpr double kPeriod = 1.0 / 360.0;
  const auto at = [](double t) {
    return Pose{exp_rotation(Vector3(0.0, 0.0, 3.0 * t * t)), Vector3(2.0 * t * t, 0.1 * t, 0.0)};
  };
  internal::ProgramRun run;
  run.tracks.resize(1);
  for (int i = 0; i <= 4000; ++i) run.tracks[0].add(1e-4 * i, at(1e-4 * i));
  run.until = run.end = 0.4;
  RecordedMotion motion;
  motion.period = kPeriod;
  motion.tracked.push_back({"parcel", {}, {}, {}});
  for (const double middle : {0.1, 0.3}) {
    Vector3 p = Vector3::Zero(), turn = Vector3::Zero();
    for (int k = 0; k < 6; ++k) {
      const Pose X = at(middle + (k - 2.5) * kPeriod);
      p += X.p / 6.0, turn += log_rotation(X.R) / 6.0;
    }
    motion.times.push_back(middle);
    motion.tracked[0].poses.emplace_back(Pose{exp_rotation(turn), p});
    motion.tracked[0].averaged.push_back(6);
  }
  model::SceneTask task;
  task.start.from = model::StartFrom::Scenario;
  task.tracked = {{"parcel", {}, {}, {}}};
  task.position_noise = 1e-4;
  task.rotation_position_ratio = 0.1;
  const internal::OwnValues own(task, 0, {});
  const internal::ComparedSamples samples = internal::compared_samples(task, motion);
  internal::SimulatedMotion simulated = internal::motion_of(run, motion, samples, own);
  const auto error = [&] { return internal::compare(task, motion, samples, simulated, own, 1.0); };
  // Between samples at 10 kHz the line is 4 m/s^2 dt^2 / 8 = 5 nm off; what stands in the middle alone is 45 um off.
  EXPECT_LT(error().position, 1e-8);
  EXPECT_LT(error().rotation, 2e-8);
  EXPECT_NEAR((at(0.1).p - motion.tracked[0].poses[0].p).norm(), 4.5e-5, 1e-6);
  // A mean of six is known sqrt(6) times as well as a sample.
  const record::PoseSample& first = simulated.bodies[0][0];
  simulated.bodies[0][0] = Pose{first.pose().R, first.p + Vector3(1e-4, 0.0, 0.0)};
  EXPECT_NEAR(error().residuals[0], std::sqrt(6.0), 1e-3);
}

TEST(ProgramMotion, OfABodyAtRestKeepsTheFirstAndTheLastPose) {
  internal::Track track;
  for (int i = 0; i <= 10; ++i) track.add(0.1 * i, Pose{Matrix3::Identity(), Vector3(i < 3 ? 0.1 * i : 0.2, 0.0, 0.0)});
  ASSERT_EQ(track.times.size(), 4U);
  EXPECT_EQ(track.times[2], 0.2);
  EXPECT_EQ(track.times[3], 1.0);
  EXPECT_EQ(track.poses[2], track.poses[3]);
}

TEST_F(SceneFitTest, RowsEndWhereWhatOppositeStepsDoIsNoLongerOpposite) {
  const SceneExperiment experiment(task(kTwo), {record({}, 5)}, 1);
  const Eigen::Index samples = experiment.samples_of(0), good = 300;
  internal::Neighbourhood around;
  around.middle = {Eigen::VectorXd::Zero(samples)};
  around.is_between = {true, true};
  around.up.assign(2, {Eigen::VectorXd::Ones(samples)});
  around.down.assign(2, {-Eigen::VectorXd::Ones(samples)});
  // The second parameter tips the box the same way whether it grows or shrinks.
  for (auto* side : {&around.up, &around.down}) (*side)[1][0].tail(samples - good).setConstant(1000.0);
  const internal::RowCounts all = {{samples}};
  std::vector<bool> is_bent;
  internal::RowWeights weights = internal::equal_weights(experiment, {0});
  EXPECT_EQ(internal::find_straight(experiment, {0}, around, all, is_bent, weights), (internal::RowCounts{{good}}));
  EXPECT_EQ(is_bent, (std::vector<bool>{false, true}));
  EXPECT_EQ(weights[0].head(good), Eigen::VectorXd(Eigen::VectorXd::Ones(good)));
}

TEST_F(SceneFitTest, RowsThatAreBentSayNoMoreThanOneNumberOfThatVariance) {
  const SceneExperiment experiment(task(kTwo), {record({}, 5)}, 1);
  const Eigen::Index samples = experiment.samples_of(0);
  // Each row moves by 10 with the parameter, and both ways by 0.3: together 0.09 for each of them.
  internal::Neighbourhood around;
  around.middle = {Eigen::VectorXd::Zero(samples)};
  around.is_between = {true};
  around.up = {{Eigen::VectorXd::Constant(samples, 10.3)}};
  around.down = {{Eigen::VectorXd::Constant(samples, -9.7)}};
  const internal::RowCounts all = {{samples}};
  std::vector<bool> is_bent;
  internal::RowWeights weights = internal::equal_weights(experiment, {0});
  EXPECT_EQ(internal::find_straight(experiment, {0}, around, all, is_bent, weights), all);
  const Eigen::Index each = experiment.rows_of(0).front().each;
  const double at_end = 1.0 / std::sqrt(1.0 + 0.09 * static_cast<double>(samples));
  EXPECT_NEAR(weights[0][samples - 1], at_end, 1e-12);
  EXPECT_NEAR(weights[0][0], 1.0 / std::sqrt(1.0 + 0.09 * static_cast<double>(each)), 1e-12);
  // However long the body lies there: the sum of all weights grows with the logarithm of the rows alone.
  EXPECT_LT(internal::total(experiment, {0}, all, weights),
            std::log1p(0.09 * static_cast<double>(samples)) / 0.09 + 1.0);
  Eigen::VectorXd residuals = Eigen::VectorXd::Ones(samples);
  internal::weigh(experiment, 0, {samples - each}, weights[0], residuals);
  EXPECT_EQ(residuals[0], weights[0][0]);
  EXPECT_EQ(residuals[samples - 1], 0.0);
}

TEST_F(SceneFitTest, RowsThatAFitDoesNotExplainEndWhereTheyBeginToStayAway) {
  const SceneExperiment experiment(task(kTwo), {record({}, 5)}, 1);
  const Eigen::Index samples = experiment.samples_of(0), each = experiment.rows_of(0).front().each;
  const Eigen::Index away = 20 * each;
  Eigen::VectorXd residuals = Eigen::VectorXd::Ones(samples);
  residuals.segment(5 * each, each).setConstant(100.0);  // for a moment
  EXPECT_EQ(internal::find_explained(experiment, {0}, {residuals}, 1.0), (internal::RowCounts{{samples}}));
  residuals.tail(samples - away).setConstant(10.0);
  EXPECT_EQ(internal::find_explained(experiment, {0}, {residuals}, 1.0), (internal::RowCounts{{away}}));
  // Where what was fitted before is as far off, it is no other.
  EXPECT_EQ(internal::find_explained(experiment, {0}, {residuals}, 100.0), (internal::RowCounts{{samples}}));
}

TEST(FreeFlight, IsFoundFromPosesOfATumblingBody) {
  const SpatialInertia inertia{0.8, Vector3(0.01, -0.02, 0.03), Vector3(0.002, 0.003, 0.004).asDiagonal()};
  const Vector3 gravity(0.0, 0.0, -9.81), w0(3.0, -6.0, 2.0), v0(1.0, 0.5, 2.0);
  // A second opinion: Euler's equations by many small steps.
  Pose X{exp_rotation(Vector3(0.3, 0.2, -0.4)), Vector3(0.1, 0.2, 0.5)};
  const Pose start = X;
  Vector3 p_cm = X * inertia.com, v = v0, w_B = X.R.transpose() * w0;
  std::vector<double> times;
  std::vector<record::PoseSample> poses;
  constexpr int kSmall = 2000;
  constexpr double kDt = 0.1 / kSmall;
  for (int i = 0; i <= kSmall; ++i) {
    if (i % 200 == 0) {
      times.push_back(5.0 + i * kDt);
      poses.emplace_back(Pose{X.R, p_cm - X.R * inertia.com});
    }
    const auto slope = [&](const Vector3& w) {
      return Vector3(inertia.inertia.diagonal().cwiseInverse().cwiseProduct(-w.cross(inertia.inertia * w)));
    };
    const Vector3 middle = w_B + 0.5 * kDt * slope(w_B);
    X.R = X.R * exp_rotation(kDt * middle);
    w_B += kDt * slope(middle);
    p_cm += kDt * v + 0.5 * kDt * kDt * gravity;
    v += kDt * gravity;
  }
  const FlightStart found = fit_free_flight(times, poses, inertia, gravity);
  // The integration of the fit: steps of 5 ms.
  EXPECT_LE((found.X_WB.p - start.p).norm(), 1e-6);
  EXPECT_LE(angle_between(found.X_WB.R, start.R), 1e-5);
  EXPECT_LE((found.V_WB.angular - w0).norm(), 1e-3);
  EXPECT_LE((found.V_WB.linear - (v0 - w0.cross(start.R * inertia.com))).norm(), 1e-4);
}

}  // namespace
}  // namespace snug::identification
