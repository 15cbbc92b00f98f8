// compare: what a shift, a turn, a weight, an end and a lost sample are worth, in closed form.
#include "snug/identification/internal/motion_error.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "snug/core/rng.hpp"
#include "snug/identification/internal/at_rest.hpp"
#include "snug/record/archive.hpp"

namespace snug::identification::internal {
namespace {

constexpr double kEver = std::numeric_limits<double>::infinity();

/// Recorded and simulated poses of bodies, the same at first.
struct Compared {
  explicit Compared(std::size_t bodies, std::size_t count) {
    Rng rng = Rng(3).split("compared");
    task.start.from = model::StartFrom::Scenario;
    task.position_noise = 1e-3;
    task.rotation_position_ratio = 0.1;
    for (std::size_t k = 0; k < count; ++k) motion.times.push_back(0.1 * static_cast<double>(k));
    for (std::size_t b = 0; b < bodies; ++b) {
      task.tracked.push_back({"body", {}, {}, {}});
      motion.tracked.push_back({"body", {}, {}, {}});
      simulated.bodies.emplace_back();
      for (std::size_t k = 0; k < count; ++k) {
        const auto any = [&] { return normal3(rng, 0.7); };
        const Pose X{exp_rotation(any()), any()};
        motion.tracked[b].poses.emplace_back(X);
        simulated.bodies[b].emplace_back(X);
      }
    }
  }
  void shift(std::size_t body, std::size_t sample, const Vector3& by) { simulated.bodies[body][sample].p += by; }
  void turn(std::size_t body, std::size_t sample, const Vector3& by) {
    record::PoseSample& pose = simulated.bodies[body][sample];
    pose = Pose{pose.pose().R * exp_rotation(by), pose.p};
  }
  [[nodiscard]] MotionError error(double until = kEver, const Eigen::VectorXd& own = {}) const {
    return compare(task, motion, compared_samples(task, motion), simulated, OwnValues(task, 0, own), until);
  }
  model::SceneTask task;
  RecordedMotion motion;
  SimulatedMotion simulated;
};

TEST(MotionError, OfTheSameMotionIsNone) {
  const MotionError error = Compared(2, 5).error();
  EXPECT_EQ(error.residuals.size(), 2 * 5 * 6);
  EXPECT_LT(error.residuals.norm(), 1e-11);
  EXPECT_LT(error.position + error.end_position, 1e-14);
  EXPECT_EQ(error.right, 1.0);
  EXPECT_TRUE(error.failure.empty());
}

TEST(MotionError, OfAShiftIsItsLengthOverTheSamples) {
  Compared compared(1, 4);
  compared.shift(0, 1, Vector3(0.003, 0.0, -0.004));
  const MotionError error = compared.error();
  EXPECT_NEAR(error.position, 0.005 / 4.0, 1e-15);
  EXPECT_NEAR(error.position_square, 25e-6 / 4.0, 1e-18);
  EXPECT_NEAR(error.rotation, 0.0, 1e-14);
  EXPECT_EQ(error.end_position, 0.0);  // the last sample is another one
  // In the axes of the world, simulated less recorded, in deviations of 1 mm.
  EXPECT_LT((error.residuals.segment<3>(6) - Vector3(3.0, 0.0, -4.0)).norm(), 1e-10);
}

TEST(MotionError, OfATurnIsItsAngleTimesTheRatio) {
  Compared compared(1, 3);
  compared.turn(0, 2, Vector3(0.0, 0.02, 0.0));
  const MotionError error = compared.error();
  EXPECT_NEAR(error.rotation, 0.02 / 3.0, 1e-12);
  EXPECT_NEAR(error.end_rotation, 0.02, 1e-12);
  // 0.1 m a radian over 1 mm: a deviation of turns is 10 mrad; about the axes of the recorded body.
  EXPECT_LT((error.residuals.tail<3>() - Vector3(0.0, 2.0, 0.0)).norm(), 1e-9);
}

TEST(MotionError, HoldsWhatTheTaskUsesOnly) {
  Compared compared(1, 3);
  compared.shift(0, 1, Vector3(0.001, 0.0, 0.0));
  compared.turn(0, 1, Vector3(0.03, 0.0, 0.0));
  compared.task.use_rotation = false;
  EXPECT_EQ(numbers_of(compared.task), 3);
  EXPECT_EQ(compared.error().residuals.size(), 9);
  EXPECT_NEAR(compared.error().residuals[3], 1.0, 1e-10);
  compared.task.use_rotation = true;
  compared.task.use_position = false;
  EXPECT_EQ(compared.error().residuals.size(), 9);
  EXPECT_NEAR(compared.error().residuals[3], 3.0, 1e-9);
  // What is told beside the fit is told of both.
  EXPECT_GT(compared.error().position, 0.0);
}

TEST(MotionError, CountsAMeanOfSamplesAsSoMany) {
  Compared compared(1, 2);
  compared.motion.tracked[0].averaged = {9, 1};
  compared.shift(0, 0, Vector3(0.001, 0.0, 0.0));
  const MotionError error = compared.error();
  EXPECT_NEAR(error.residuals[0], 3.0, 1e-10);      // known three times as well
  EXPECT_NEAR(error.position, 0.9 * 0.001, 1e-15);  // nine of ten samples
}

TEST(MotionError, EndsWhereItIsAskedTo) {
  Compared compared(1, 5);
  for (std::size_t k = 0; k < 5; ++k) compared.shift(0, k, Vector3(0.001 * static_cast<double>(k + 1), 0.0, 0.0));
  const MotionError error = compared.error(0.25);
  EXPECT_EQ(error.residuals.size(), 30);  // rows stay where they are
  EXPECT_EQ(error.residuals.tail<12>().norm(), 0.0);
  EXPECT_NEAR(error.position, 0.002, 1e-15);  // of three samples
  EXPECT_NEAR(error.end_position, 0.003, 1e-15);
}

TEST(MotionError, OfASimulationThatBrokeOffIsAMetreFromThereOn) {
  Compared compared(1, 4);
  compared.simulated.end = 0.15;
  const MotionError error = compared.error();
  EXPECT_NEAR(error.position, 0.5 * kLost, 1e-14);
  EXPECT_NEAR(error.end_position, kLost, 1e-14);
  EXPECT_NEAR(error.end_rotation, kLost, 1e-14);
  EXPECT_EQ(error.right, 0.0);  // a radian is more than 30 degrees
  EXPECT_LT(error.residuals.head<12>().norm(), 1e-11);
}

TEST(MotionError, LeavesOutWhatTheSimulationDoesNotHave) {
  Compared compared(1, 4);
  compared.shift(0, 1, Vector3(0.002, 0.0, 0.0));
  compared.simulated.bodies[0][2] = record::lost_pose();  // a box that is not there
  const MotionError error = compared.error();
  EXPECT_EQ(error.residuals.segment<6>(12).norm(), 0.0);
  EXPECT_NEAR(error.position, 0.002 / 3.0, 1e-15);
}

TEST(MotionError, SaysWhyThereIsNone) {
  Compared compared(1, 4);
  compared.simulated.failure = "the simulation lost a body";
  const MotionError error = compared.error();
  EXPECT_EQ(error.failure, "the simulation lost a body");
  EXPECT_EQ(error.residuals.size(), 0);
}

TEST(MotionError, CountsBodiesThatEndTheRightWayUp) {
  Compared compared(4, 2);
  compared.task.right_within = 0.5;
  compared.turn(1, 1, Vector3(0.0, 0.0, 0.49));
  compared.turn(2, 1, Vector3(0.0, 0.51, 0.0));
  compared.turn(3, 0, Vector3(1.5, 0.0, 0.0));  // before the end
  EXPECT_DOUBLE_EQ(compared.error().right, 0.75);
}

TEST(MotionError, OfTheEndAloneTakesTheResultThatTheRecordingStates) {
  Compared compared(1, 6);
  compared.task.only_final_state = true;
  EXPECT_EQ(compared.error().residuals.size(), 6);
  compared.motion.tracked[0].result = compared.motion.tracked[0].poses[5];
  compared.motion.tracked[0].result->p.x() -= 0.004;
  compared.motion.tracked[0].averaged.assign(6, 16);
  compared.shift(0, 2, Vector3(1.0, 0.0, 0.0));
  const MotionError error = compared.error();
  EXPECT_NEAR(error.residuals[0], 4.0, 1e-10);  // a result is one number, not the mean of sixteen
  EXPECT_NEAR(error.end_position, 0.004, 1e-15);
}

TEST(MotionError, BringsTheSimulationToTheRecordedWorldAndFrame) {
  // What was recorded: another world's origin, another frame of the body. With these as own unknowns nothing is left.
  Compared compared(2, 3);
  compared.task.own.bias = compared.task.own.bias_rotation = 1.0;
  compared.task.own.frame_position = compared.task.own.frame_rotation = 1.0;
  Eigen::VectorXd own(18);
  own << 0.01, -0.02, 0.03, 0.1, 0.2, -0.1, 0.004, 0.005, -0.006, 0.3, 0.0, 0.1, -0.004, 0.0, 0.01, 0.0, 0.2, 0.0;
  const Pose world{exp_rotation(own.segment<3>(3)), own.head<3>()};
  for (std::size_t b = 0; b < 2; ++b) {
    const auto at = static_cast<Eigen::Index>(6 + 6 * b);
    const Pose X_BM{exp_rotation(own.segment<3>(at + 3)), own.segment<3>(at)};
    for (record::PoseSample& pose : compared.motion.tracked[b].poses) pose = world * pose.pose() * X_BM;
  }
  const MotionError error = compared.error(kEver, own);
  ASSERT_EQ(error.residuals.size(), 36 + 18);
  EXPECT_LT(error.residuals.head<36>().norm(), 1e-9);
  EXPECT_EQ(error.residuals.tail<18>().norm(), 0.0);  // room for what is expected of them
  EXPECT_GT(compared.error().residuals.norm(), 10.0);
}

TEST(MotionError, IsTheSameInAnyWorldThatBothAreSeenFrom) {
  Compared compared(1, 5);
  compared.shift(0, 2, Vector3(0.002, 0.001, 0.0));
  compared.turn(0, 3, Vector3(0.02, 0.0, 0.01));
  const MotionError here = compared.error();
  const Pose X{exp_rotation(Vector3(0.4, -1.0, 2.0)), Vector3(3.0, -2.0, 1.0)};
  for (record::PoseSample& pose : compared.motion.tracked[0].poses) pose = X * pose.pose();
  for (record::PoseSample& pose : compared.simulated.bodies[0]) pose = X * pose.pose();
  const MotionError there = compared.error();
  EXPECT_NEAR(there.residuals.norm(), here.residuals.norm(), 1e-9);
  EXPECT_NEAR(there.position, here.position, 1e-14);
  EXPECT_NEAR(there.rotation, here.rotation, 1e-13);
}

}  // namespace
}  // namespace snug::identification::internal
