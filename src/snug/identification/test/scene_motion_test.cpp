// simulate_scene and what recordings have of their own: starts, delays, flights and samples, in closed form.
#include "snug/identification/internal/scene_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "snug/identification/internal/at_rest.hpp"
#include "snug/record/archive.hpp"

namespace snug::identification::internal {
namespace {

constexpr double kNoEnd = std::numeric_limits<double>::infinity();

/// A box in free flight, far from a floor; gravity is that of the scenario.
constexpr const char* kFlight = R"(name: flight
time_step: 0.001
materials: [{name: any}]
contacts:
  pairs: [{between: [any, any], friction: 0.3, restitution: 0.0}]
bodies:
  - {name: floor, kind: static, size: [20, 20, 0.2], material: any, pose: {position: [0, 0, -0.1]}}
  - name: parcel
    size: [0.2, 0.16, 0.1]
    mass: 0.8
    material: any
    pose: {position: [0, 0, 2.0]}
    twist: {linear: [1.0, 0.5, 1.5], angular: [0, 0, 3.0]}
)";

model::SceneTask flight_task(model::StartFrom from) {
  model::SceneTask task;
  task.start.from = from;
  task.tracked = {{"parcel", {}, {}, {}}};
  return task;
}

/// Where the box is that is thrown like that; it turns about a principal axis.
Pose flight_at(double t) {
  return {exp_rotation(Vector3(0.0, 0.0, 3.0 * t)), Vector3(1.0 * t, 0.5 * t, 2.0 + 1.5 * t - 0.5 * 9.81 * t * t)};
}

RecordedMotion recorded_flight(double first, std::size_t count, double period, double late = 0.0) {
  RecordedMotion motion;
  motion.name = "flight";
  motion.tracked.push_back({"parcel", {}, {}, {}});
  for (std::size_t k = 0; k < count; ++k) {
    const double t = first + period * static_cast<double>(k);
    motion.times.push_back(t + late);
    motion.tracked[0].poses.emplace_back(flight_at(t));
  }
  return motion;
}

SimulatedMotion simulated_flight(const model::SceneTask& task, const RecordedMotion& motion,
                                 const Eigen::VectorXd& own = {}, double until = kNoEnd,
                                 const std::vector<std::size_t>& flights = {}) {
  return simulate_scene(model::parse_scenario(kFlight, "flight.yaml"), task, motion, {}, flights,
                        OwnValues(task, 0, own), until);
}

/// The largest distance from the flight in closed form, m, over samples that were simulated.
double worst_distance(const SimulatedMotion& simulated, const RecordedMotion& motion, double late = 0.0) {
  double worst = 0.0;
  for (std::size_t k = 0; k < motion.times.size(); ++k)
    if (record::is_tracked(simulated.bodies[0][k]))
      worst = std::max(worst, (simulated.bodies[0][k].p - flight_at(motion.times[k] - late).p).norm());
  return worst;
}

// Steps of 1 ms of a semi-implicit integrator end a flight of 0.5 s by g t dt / 2 = 2.5 mm too low or too high.
constexpr double kOfSteps = 3e-3;

TEST(SceneMotion, FliesOnTheParabolaOfTheScenariosStart) {
  const RecordedMotion motion = recorded_flight(0.0, 50, 0.01);
  const SimulatedMotion simulated = simulated_flight(flight_task(model::StartFrom::Scenario), motion);
  EXPECT_TRUE(simulated.failure.empty());
  EXPECT_LT(worst_distance(simulated, motion), kOfSteps);
  for (std::size_t k = 0; k < 50; ++k)
    EXPECT_LT(angle_between(simulated.bodies[0][k].pose().R, flight_at(motion.times[k]).R), 1e-6);
}

TEST(SceneMotion, StartsWhereTheFirstRowIsWithTheVelocityOfTheFirstTwo) {
  // From 0.2 s on, on a clock of its own; between rows 1 ms apart the speed is that of their middle.
  RecordedMotion motion = recorded_flight(0.2, 200, 0.001);
  for (double& time : motion.times) time += 50.0;
  const SimulatedMotion simulated = simulated_flight(flight_task(model::StartFrom::FirstRow), motion);
  EXPECT_LT((simulated.bodies[0][0].p - flight_at(0.2).p).norm(), 1e-12);
  EXPECT_LT(worst_distance(simulated, motion, 50.0), kOfSteps);
  // With twists in the recording those are taken.
  motion.tracked[0].twists.assign(200, Twist{Vector3(1.0, 0.5, 1.5 - 9.81 * 0.2), Vector3(0.0, 0.0, 3.0)});
  motion.tracked[0].poses[1] = record::PoseSample(Pose{});  // and no difference of rows
  EXPECT_LT(worst_distance(simulated_flight(flight_task(model::StartFrom::FirstRow), motion), motion, 50.0), kOfSteps);
}

TEST(SceneMotion, StartsOfAFlightAreBetterThanThoseOfTwoRows) {
  // Two noisy rows 5 ms apart are off by 0.2 mm / 5 ms = 60 mm/s; forty of a flight by a hundredth of that.
  RecordedMotion motion = recorded_flight(0.1, 60, 0.005);
  Rng rng = Rng(8).split("rows");
  for (record::PoseSample& pose : motion.tracked[0].poses) pose.p += normal3(rng, 2e-4);
  const SimulatedMotion flight = simulated_flight(flight_task(model::StartFrom::FreeFlight), motion, {}, kNoEnd, {40});
  EXPECT_LT(worst_distance(flight, motion), kOfSteps);
  const SimulatedMotion rows = simulated_flight(flight_task(model::StartFrom::FirstRow), motion);
  EXPECT_GT(worst_distance(rows, motion), 2.0 * kOfSteps);
}

TEST(SceneMotion, OfARecordingThatIsLateIsThatOfAnEarlierTime) {
  model::SceneTask task = flight_task(model::StartFrom::Scenario);
  task.own.delay = 0.1;
  const RecordedMotion motion = recorded_flight(0.0, 50, 0.01, 0.037);
  const SimulatedMotion simulated = simulated_flight(task, motion, Eigen::VectorXd::Constant(1, 0.037));
  EXPECT_LT(worst_distance(simulated, motion, 0.037), kOfSteps);
}

TEST(SceneMotion, AddsItsOwnVelocityToTheStart) {
  model::SceneTask task = flight_task(model::StartFrom::Scenario);
  task.own.velocity = task.own.angular_velocity = 1.0;
  const RecordedMotion motion = recorded_flight(0.0, 40, 0.01);
  Eigen::VectorXd own(6);
  own << 0.2, -0.1, 0.3, 0.0, 0.0, 1.0;
  const SimulatedMotion plain = simulated_flight(task, motion), thrown = simulated_flight(task, motion, own);
  const double t = motion.times.back();
  EXPECT_LT((thrown.bodies[0][39].p - plain.bodies[0][39].p - t * Vector3(0.2, -0.1, 0.3)).norm(), 1e-9);
  EXPECT_NEAR(angle_between(thrown.bodies[0][39].pose().R, plain.bodies[0][39].pose().R), t, 1e-6);
}

TEST(SceneMotion, IsLostBehindWhatIsAskedFor) {
  const RecordedMotion motion = recorded_flight(0.0, 30, 0.01);
  const SimulatedMotion simulated = simulated_flight(flight_task(model::StartFrom::Scenario), motion, {}, 0.155);
  for (std::size_t k = 0; k < 30; ++k) EXPECT_EQ(record::is_tracked(simulated.bodies[0][k]), k <= 15) << k;
}

TEST(SceneMotion, IsBetweenTwoStepsWhereATimeIs) {
  RecordedMotion motion = recorded_flight(0.0, 3, 0.0004);  // steps are 1 ms
  const SimulatedMotion simulated = simulated_flight(flight_task(model::StartFrom::Scenario), motion);
  const Vector3 a = simulated.bodies[0][0].p, b = simulated.bodies[0][1].p, c = simulated.bodies[0][2].p;
  EXPECT_LT((2.0 * (b - a) - (c - a)).norm(), 1e-12);  // on one line
  EXPECT_NEAR((b - a).x(), 0.0004, 1e-9);
}

TEST(OwnValues, AreTakenInTheOrderOfWhatIsExpectedOfThem) {
  model::SceneTask task = flight_task(model::StartFrom::Scenario);
  task.tracked.push_back({"other", {}, {}, {}});
  task.own = {.velocity = 0.1,
              .angular_velocity = 0.2,
              .delay = 0.01,
              .clock_rate = 0.001,
              .bias = 0.003,
              .bias_rotation = 0.004,
              .frame_position = 0.005,
              .frame_rotation = 0.006};
  const Eigen::VectorXd deviation = own_deviation(task, 2);
  ASSERT_EQ(deviation.size(), 3 + 3 + 1 + 1 + 3 + 3 + 2 * 6 + 2);
  EXPECT_EQ(deviation[5], 0.2);
  EXPECT_EQ(deviation[6], 0.01);
  EXPECT_EQ(deviation[7], 0.001);
  EXPECT_EQ(deviation[11], 0.004);
  EXPECT_EQ(deviation[14], 0.005);
  EXPECT_EQ(deviation[25], 0.006);
  EXPECT_EQ(deviation[27], 1.0);
  Eigen::VectorXd values(28);
  for (Eigen::Index i = 0; i < 28; ++i) values[i] = 0.001 * static_cast<double>(i + 1);
  const OwnValues own(task, 2, values);
  const auto three_from = [&](Eigen::Index at) { return Vector3(values.segment<3>(at)); };
  EXPECT_EQ(own.start.linear, three_from(0));
  EXPECT_EQ(own.start.angular, three_from(3));
  EXPECT_EQ(own.delay, values[6]);
  EXPECT_EQ(own.clock_rate, values[7]);
  EXPECT_EQ(own.bias.p, three_from(8));
  EXPECT_LT((log_rotation(own.bias.R) - three_from(11)).norm(), 1e-15);
  EXPECT_EQ(own.X_BM[0].p, three_from(14));
  EXPECT_EQ(own.X_BM[1].p, three_from(20));
  EXPECT_LT((log_rotation(own.X_BM[1].R) - three_from(23)).norm(), 1e-15);
  EXPECT_EQ(own.path, values.tail(2));
  EXPECT_DOUBLE_EQ(own.late_at(2.0), 0.007 + 2.0 * 0.008);
  // Each change of one is a change of what it is named for and of nothing else.
  const OwnValues none(task, 2, {});
  EXPECT_EQ(none.start, Twist{});
  EXPECT_EQ(none.bias, Pose{});
  EXPECT_EQ(none.path, Eigen::Vector2d(0.0, 0.0));
}

TEST(OwnValues, AreOfTheBodiesThatTheyChange) {
  model::SceneTask task = flight_task(model::StartFrom::Scenario);
  task.tracked.push_back({"other", {}, {}, {}});
  task.own = {.delay = 0.01, .frame_position = 0.005};
  const std::vector<std::optional<std::size_t>> bodies = own_bodies(task, 1);
  ASSERT_EQ(bodies.size(), 8U);
  EXPECT_FALSE(bodies[0]);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(bodies[i], 0U);
  for (std::size_t i = 4; i < 7; ++i) EXPECT_EQ(bodies[i], 1U);
  EXPECT_FALSE(bodies[7]);
  EXPECT_TRUE(own_bodies(flight_task(model::StartFrom::Scenario), 0).empty());
}

TEST(ComparedSamples, LeaveOutTheFirstUnlessTheScenarioSaysWhereBodiesStart) {
  RecordedMotion motion = recorded_flight(0.0, 6, 0.1);
  motion.tracked[0].poses[3] = record::lost_pose();
  EXPECT_EQ(compared_samples(flight_task(model::StartFrom::Scenario), motion)[0],
            (std::vector<std::size_t>{0, 1, 2, 4, 5}));
  EXPECT_EQ(compared_samples(flight_task(model::StartFrom::FirstRow), motion)[0],
            (std::vector<std::size_t>{1, 2, 4, 5}));
  model::SceneTask end = flight_task(model::StartFrom::FirstRow);
  end.only_final_state = true;
  EXPECT_EQ(compared_samples(end, motion)[0], (std::vector<std::size_t>{5}));
  motion.tracked[0].poses[5] = record::lost_pose();
  EXPECT_TRUE(compared_samples(end, motion)[0].empty());
  motion.tracked[0].result = record::PoseSample(flight_at(1.0));
  EXPECT_EQ(compared_samples(end, motion)[0], (std::vector<std::size_t>{5}));
}

TEST(ComparedSamples, EndWithTheTimeSimulated) {
  const RecordedMotion motion = recorded_flight(2.0, 10, 0.1);
  model::SceneTask task = flight_task(model::StartFrom::FirstRow);
  EXPECT_EQ(sample_count(task, motion), 10U);
  task.simulation_time = 0.3;  // from the first sample on: its own end counts
  EXPECT_EQ(sample_count(task, motion), 4U);
  task.start.from = model::StartFrom::Scenario;  // from time 0 of the recording's clock
  EXPECT_EQ(sample_count(task, motion), 1U);     // at least one
  task.simulation_time = 2.5;
  EXPECT_EQ(sample_count(task, motion), 6U);
}

TEST(FlightRows, EndBeforeTheBodyMayTouchSomething) {
  const model::Scenario scenario = model::parse_scenario(kFlight, "flight.yaml");
  RecordedBody falling{"parcel", {}, {}, {}};
  for (int k = 0; k < 20; ++k)  // 50 mm is half of its height
    falling.poses.emplace_back(Pose{Matrix3::Identity(), Vector3(0.0, 0.0, 0.05 + 0.1 - 0.01 * k)});
  model::StartSettings start;
  start.samples = 100;
  start.margin = 0.002;
  EXPECT_EQ(count_flight_rows(scenario, falling, start), 10U);
  start.margin = 0.025;
  EXPECT_EQ(count_flight_rows(scenario, falling, start), 8U);
  start.samples = 5;
  EXPECT_EQ(count_flight_rows(scenario, falling, start), 5U);
  falling.poses[3] = record::lost_pose();
  EXPECT_EQ(count_flight_rows(scenario, falling, start), 3U);
}

}  // namespace
}  // namespace snug::identification::internal
