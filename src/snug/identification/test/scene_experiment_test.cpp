// SceneExperiment: scenarios at values, what does not fit, costs in closed form, jobs that share a simulation.
#include "snug/identification/scene_experiment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "snug/cell/scene.hpp"
#include "snug/core/rng.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/identification/internal/at_rest.hpp"
#include "snug/identification/scene_fit.hpp"
#include "snug/identification/test/helpers.hpp"
#include "snug/model/number_edit.hpp"

namespace snug::identification {
namespace {

/// A box slides over a floor and comes to rest after v^2 / (2 mu g).
constexpr const char* kSlidingBox = R"(name: slides
duration: 1.0
materials: [{name: box}, {name: floor}]
contacts:
  pairs:
    - {between: [box, floor], friction: 0.3, restitution: 0.0}
bodies:
  - {name: floor, kind: static, size: [8, 2, 0.1], material: floor, pose: {position: [0, 0, -0.05]}}
  - {name: pusher, kind: kinematic, size: [0.05, 0.05, 0.05], material: floor, pose: {position: [-3, 0, 0.5]}}
  - name: parcel
    size: [0.2, 0.2, 0.1]
    mass: 0.5
    material: box
    inertia: [0.002, 0.002, 0.003]
    com: [0, 0, 0]
    pose: {position: [0, 0, 0.05]}
    twist: {linear: [1.0, 0, 0]}
)";

constexpr const char* kOneFriction =
    "parameters:\n  - {name: mu, path: \"contacts.pairs[0].friction\", value: 0.3, bounds: [0.05, 0.8]}\n";

class SceneExperimentTest : public ::testing::Test {
 protected:
  void SetUp() override { std::ofstream(folder_ / "scene.yaml") << kSlidingBox; }

  [[nodiscard]] model::SceneTask task(const std::string& more, const std::string& from = "scenario",
                                      const std::string& body = "parcel") const {
    return model::parse_scene_task("scenario: scene.yaml\ntracked_objects: [{body: " + body + "}]\nstart: {from: " +
                                       from + "}\nnoise: {position: 0.001, rotation_deg: 0.5}\n" + more,
                                   folder_ / "task.yaml");
  }

  /// The box in the simulation of the scenario with these numbers, each 10 ms.
  [[nodiscard]] RecordedMotion slide(const std::vector<model::NumberEdit>& numbers, const std::string& name) const {
    cell::Scene scene(model::with_numbers(model::load_scenario(folder_ / "scene.yaml"), numbers));
    const physics::BodyId id = cell::find_body(scene.world(), "parcel");
    RecordedMotion motion;
    motion.name = name;
    motion.tracked.push_back({"parcel", {}, {}, {}});
    for (int i = 0; i <= 400; ++i) {
      if (i % 10 == 0) {
        motion.times.push_back(1e-3 * i);
        motion.tracked[0].poses.emplace_back(physics::pose_of(scene.world().model, scene.state(), id));
      }
      (void)scene.advance();
    }
    return motion;
  }

  [[nodiscard]] SceneExperiment experiment(const std::string& more, int threads = 1) const {
    return {task(more), {slide({}, "first"), slide({{"contacts.pairs[0].friction", 0.4}}, "second")}, threads};
  }

  static std::vector<MotionError> evaluate(const SceneExperiment& experiment, const Eigen::VectorXd& values,
                                           std::vector<SceneExperiment::Job> jobs) {
    const std::vector<Eigen::VectorXd> points{values};
    return experiment.evaluate(points, jobs);
  }

  snug::test::ScratchFolder folder_;
};

TEST_F(SceneExperimentTest, PutsValuesScalesAndOffsetsWhereTheirPathsSay) {
  const SceneExperiment three = experiment(R"(parameters:
  - {name: mu, path: "contacts.pairs[0].friction", value: 0.3, bounds: [0.05, 0.8]}
  - {name: heavier, form: scale, paths: [bodies.parcel.mass, "bodies.parcel.inertia[0]", "bodies.parcel.inertia[1]", "bodies.parcel.inertia[2]"], value: 1, bounds: [0.5, 2]}
  - {name: aside, form: offset, path: "bodies.parcel.com[0]", value: 0, bounds: [-0.01, 0.01]}
)");
  const model::Scenario scenario = three.scenario_at(Eigen::Vector3d(0.25, 1.5, 0.004));
  EXPECT_EQ(scenario.contact_pairs[0].params.friction, 0.25);
  const model::Body& parcel = *model::find_body(scenario, "parcel");
  EXPECT_DOUBLE_EQ(parcel.inertia.mass, 0.75);
  EXPECT_DOUBLE_EQ(parcel.inertia.inertia(2, 2), 0.0045);
  EXPECT_DOUBLE_EQ(parcel.inertia.com.x(), 0.004);
  EXPECT_EQ(three.start(), Eigen::Vector3d(0.3, 1.0, 0.0));
  // Values change the scenario's own numbers, not those of the last call.
  EXPECT_DOUBLE_EQ(model::find_body(three.scenario_at(three.start()), "parcel")->inertia.mass, 0.5);
}

TEST_F(SceneExperimentTest, RefusesBodiesOfAnotherKindWithTheNearestName) {
  const std::vector<RecordedMotion> motions{slide({}, "first")};
  const auto refused = [&](const model::SceneTask& wrong, const std::string& part) {
    test::expect_refused([&] { (void)SceneExperiment(wrong, motions, 1); }, part);
  };
  refused(task(kOneFriction, "scenario", "parcell"), "nearest is 'parcel'");
  refused(task(kOneFriction, "scenario", "floor"), "a dynamic body of the scenario");
  refused(task(std::string("kinematic_bodies: [{body: pushr}]\n") + kOneFriction), "nearest is 'pusher'");
  refused(task(std::string("kinematic_bodies: [{body: parcel, columns: [a, b, c, d, e, f, g]}]\n") + kOneFriction),
          "a kinematic body of the scenario");
  refused(task("parameters: [{name: a, form: scale, path: \"contacts.pairs[0].stiffness\", value: 1, bounds: [0, 2]}]"),
          "one that can be scaled or shifted");
}

TEST_F(SceneExperimentTest, RefusesRecordingsOfWhichNothingIsCompared) {
  RecordedMotion motion = slide({}, "first");
  for (record::PoseSample& pose : motion.tracked[0].poses) pose = record::lost_pose();
  test::expect_refused([&] { (void)SceneExperiment(task(kOneFriction), {motion}, 1); },
                       "no pose of a tracked object in the time simulated");
}

TEST_F(SceneExperimentTest, ReproducesItsOwnSimulation) {
  const SceneExperiment both = experiment(kOneFriction);
  Eigen::VectorXd values(1);
  values << 0.4;
  const std::vector<MotionError> errors = evaluate(both, values, {{0, 0}, {0, 1}});
  EXPECT_GT(errors[0].position, 1e-3);
  EXPECT_LT(errors[1].residuals.norm(), 1e-9);
  EXPECT_EQ(errors[1].right, 1.0);
  // A box of 1 m/s stops after 1 / (2 mu g): 170 mm or 127 mm.
  EXPECT_NEAR(errors[0].end_position, 1.0 / (2.0 * 9.81) * (1.0 / 0.3 - 1.0 / 0.4), 2e-3);
}

TEST_F(SceneExperimentTest, SaysWhyValuesThatNoScenarioHasCannotBeSimulated) {
  const SceneExperiment open =
      experiment("parameters: [{name: mass, path: bodies.parcel.mass, value: 0.5, bounds: [-1, 2]}]\n");
  Eigen::VectorXd negative(1), sound(1);
  negative << -0.5;
  sound << 0.5;
  const std::vector<Eigen::VectorXd> points{negative, sound};
  const std::vector<SceneExperiment::Job> jobs{{0, 0}, {1, 0}, {0, 1}};
  const std::vector<MotionError> errors = open.evaluate(points, jobs);
  EXPECT_NE(errors[0].failure.find("mass"), std::string::npos) << errors[0].failure;
  EXPECT_EQ(errors[0].residuals.size(), 0);
  EXPECT_TRUE(errors[1].failure.empty());
  EXPECT_FALSE(errors[2].failure.empty());
  // In the sum it is a metre and a radian, and counted.
  const SceneError sum = open.summarize(errors);
  EXPECT_EQ(sum.recordings, 3);
  EXPECT_EQ(sum.failed, 2);
  EXPECT_NEAR(sum.position_mm, 2.0 * 1000.0 / 3.0, 1.0);
  EXPECT_NEAR(sum.rotation_deg, 2.0 * 57.29577951308232 / 3.0, 0.1);
}

TEST_F(SceneExperimentTest, CostsAreDistancesOrRootsOfSquaresOfWhatIsUsed) {
  MotionError error;
  error.position = 0.003, error.rotation = 0.02;
  error.position_square = 16e-6, error.rotation_square = 9e-4;
  const auto cost = [&](const std::string& more) { return experiment(more + kOneFriction).cost_of(error); };
  const std::string ratio = "rotation_position_ratio: 0.1\n";
  EXPECT_NEAR(cost(ratio), 1e3 * std::sqrt(16e-6 + 0.01 * 9e-4), 1e-12);
  EXPECT_NEAR(cost(ratio + "loss: distance\n"), 3.0 + 2.0, 1e-12);
  EXPECT_NEAR(cost(ratio + "loss: distance\noptimize_rotation: false\n"), 3.0, 1e-12);
  EXPECT_NEAR(cost(ratio + "optimize_position: false\n"), 3.0, 1e-12);
  error.failure = "lost";
  EXPECT_NEAR(cost(ratio), 1e3 * (1.0 + 0.1), 1e-9);
}

TEST_F(SceneExperimentTest, SumsAreMeansOverRecordings) {
  const SceneExperiment one = experiment("loss: distance\nrotation_position_ratio: 0.1\n" + std::string(kOneFriction));
  MotionError a, b;
  a.position = 0.002, a.end_position = 0.004, a.right = 1.0;
  b.position = 0.004, b.rotation = 0.02, b.end_rotation = 0.2, b.right = 0.5;
  const std::vector<MotionError> errors{a, b};
  const SceneError sum = one.summarize(errors);
  EXPECT_NEAR(sum.position_mm, 3.0, 1e-12);
  EXPECT_NEAR(sum.end_position_mm, 2.0, 1e-12);
  EXPECT_NEAR(sum.end_rotation_deg, 0.1 * 57.29577951308232, 1e-9);
  EXPECT_NEAR(sum.right_orientation_percent, 75.0, 1e-12);
  EXPECT_NEAR(sum.cost, 0.5 * (2.0 + 6.0), 1e-12);
  EXPECT_EQ(one.summarize({}).recordings, 0);
  EXPECT_EQ(one.summarize({}).cost, 0.0);
}

TEST_F(SceneExperimentTest, GivesTheSameBytesAtAnyNumberOfThreadsAndInAnyOrderOfJobs) {
  const std::string own = "own: {velocity: 0.1, bias: 0.01}\n" + std::string(kOneFriction);
  const SceneExperiment one = experiment(own, 1), three = experiment(own, 3);
  Eigen::VectorXd a(1), b(1);
  a << 0.25;
  b << 0.35;
  const std::vector<Eigen::VectorXd> points{a, b};
  std::vector<SceneExperiment::Job> jobs;
  for (const std::size_t point : {0U, 1U})
    for (const std::size_t motion : {0U, 1U})
      for (const double size : {0.0, 0.005}) jobs.push_back({point, motion, Eigen::VectorXd::Constant(6, size)});
  const std::vector<MotionError> errors = one.evaluate(points, jobs);
  std::vector<SceneExperiment::Job> backwards(jobs.rbegin(), jobs.rend());
  const std::vector<MotionError> there = three.evaluate(points, backwards);
  for (std::size_t j = 0; j < jobs.size(); ++j)
    EXPECT_EQ(errors[j].residuals, there[jobs.size() - 1 - j].residuals) << j;
}

TEST_F(SceneExperimentTest, CountsOwnUnknownsAgainstWhatIsExpectedOfThem) {
  const SceneExperiment own = experiment("own: {bias: 0.01}\n" + std::string(kOneFriction));
  ASSERT_EQ(own.own_deviation(), Eigen::Vector3d::Constant(0.01));
  const Eigen::Vector3d moved(0.005, 0.0, -0.02);
  const MotionError error = evaluate(own, own.start(), {{0, 0, moved}})[0];
  EXPECT_EQ(error.residuals.tail(3), Eigen::VectorXd(moved / 0.01));
  // The world is moved, and every position with it.
  EXPECT_NEAR(error.position, moved.norm(), 1e-12);
  EXPECT_EQ(evaluate(own, own.start(), {{0, 0, {}}})[0].residuals.tail(3), Eigen::VectorXd(Eigen::Vector3d::Zero()));
}

TEST_F(SceneExperimentTest, KnowsWhereTheRowsOfABodyAre) {
  const SceneExperiment one = experiment("optimize_rotation: false\n" + std::string(kOneFriction));
  const std::vector<SceneExperiment::BodyRows> rows = one.rows_of(0);
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].each, 3);
  EXPECT_EQ(rows[0].count, 3 * 41);
  EXPECT_EQ(one.samples_of(0), 3 * 41);
  EXPECT_EQ(evaluate(one, one.start(), {{0, 0}})[0].residuals.size(), one.samples_of(0));
  EXPECT_NEAR(one.longest(), 0.4, 1e-12);
  EXPECT_EQ(one.path_unknowns(), 0);
  EXPECT_TRUE(one.driven_of(0).empty());
}

TEST_F(SceneExperimentTest, OfAFastClockHasSlowerMotions) {
  const SceneExperiment one = experiment(kOneFriction);
  // A clock that is 2 % fast shows more time for the same way: what was recorded at 0.4 s is from 0.392 s.
  SceneExperiment::Job fast{0, 0};
  fast.clock_rate = 0.02;
  const MotionError error = evaluate(one, one.start(), {fast})[0];
  // Residuals in mm: the simulation is behind by the speed times 2 % of the time while the box slides.
  const std::vector<double>& times = one.motions()[0].times;
  for (std::size_t k = 0; k < 30; ++k) {
    const double t = times[k], speed = 1.0 - 0.3 * 9.81 * t;
    EXPECT_NEAR(error.residuals[6 * static_cast<Eigen::Index>(k)], -1e3 * speed * 0.02 * t / 1.02, 0.1) << t;
  }
}

TEST_F(SceneExperimentTest, FloorIsWhatTheNoiseOfTheStartSets) {
  // A box thrown so high that half a second is free flight; what the floor predicts grows with the noise of the rows.
  std::string high = kSlidingBox;
  high.replace(high.find("[0, 0, 0.05]"), 12, "[0, 0, 3.05]");
  std::ofstream(folder_ / "scene.yaml") << high;
  const RecordedMotion exact = slide({}, "flight");
  const auto floor_of = [&](double noise) {
    Rng rng = Rng(4).split("floor");
    RecordedMotion motion = exact;
    for (record::PoseSample& pose : motion.tracked[0].poses) pose.p += internal::normal3(rng, noise);
    const SceneExperiment experiment(task(kOneFriction, "free_flight"), {motion}, 1);
    const MotionError error = experiment.evaluate_floor(experiment.start(), 7)[0];
    EXPECT_TRUE(error.failure.empty()) << error.failure;
    EXPECT_EQ(experiment.evaluate_floor(experiment.start(), 7)[0].residuals, error.residuals);
    return error.position;
  };
  const double small = floor_of(1e-4), large = floor_of(1e-3);
  EXPECT_GT(small, 1e-6);
  EXPECT_NEAR(large / small, 10.0, 2.0);
  EXPECT_LT(large, 5e-3);
}

TEST_F(SceneExperimentTest, FloorNeedsFourRowsOfFlight) {
  const SceneExperiment on_floor(task(kOneFriction, "free_flight"), {slide({}, "slides")}, 1);
  EXPECT_EQ(on_floor.evaluate_floor(on_floor.start(), 1)[0].failure, "fewer than four rows of free flight");
  const SceneExperiment other = experiment(kOneFriction);
  test::expect_refused([&] { (void)other.evaluate_floor(other.start(), 1); }, "from: free_flight");
}

TEST_F(SceneExperimentTest, EvaluatesEachRecordingWithWhatItHasOfItsOwn) {
  // Two recordings of one motion, whose worlds are 4 mm apart: each finds its own, and nothing is left but what 0.01 m
  // is expected to be.
  std::vector<RecordedMotion> motions{slide({}, "here"), slide({}, "there")};
  for (record::PoseSample& pose : motions[1].tracked[0].poses) pose.p.y() += 0.004;
  const SceneExperiment own(task("own: {bias: 0.01}\n" + std::string(kOneFriction)), motions, 2);
  const std::vector<MotionError> errors = evaluate_scene(own, own.start());
  EXPECT_LT(errors[0].position, 1e-8);
  EXPECT_LT(errors[1].position, 1e-5);  // 41 samples of 1 mm against one number of 10 mm: 1 / 4100 of 4 mm stay
  EXPECT_NEAR(errors[1].residuals.tail(3)[1], 0.4, 1e-3);
  const SceneExperiment plain(task(kOneFriction), motions, 2);
  EXPECT_NEAR(evaluate_scene(plain, plain.start())[1].position, 0.004, 1e-9);
}

}  // namespace
}  // namespace snug::identification
