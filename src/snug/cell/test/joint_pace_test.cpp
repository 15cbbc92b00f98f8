// JointPace on the demonstrator's arm: joints keep their speeds and accelerations on every way that it times.
#include "snug/cell/joint_pace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numbers>

#include "snug/cell/held_swing.hpp"
#include "snug/core/rng.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::cell {
namespace {

const std::filesystem::path kScenario = std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/box-demonstrator.yaml";

struct JointPeaks {
  double speed = 0.0, acceleration = 0.0;  ///< of any joint, in units of its limit
  bool is_reached = true;
  double least_measure = 1.0;  ///< robot::singularity_measure on the way
};

struct Arm {
  robot::InverseKinematics inverse;
  robot::JointVector posture;
  double max_acceleration = 0.0;  ///< rad/s^2
  double least_measure = 0.0;     ///< ways that come nearer to a singularity are left out
};

/// Of the arm that follows the segment exactly, by differences.
JointPeaks peaks_on(const motion::PacedSegment& segment, const Arm& arm) {
  const robot::InverseKinematics& inverse = arm.inverse;
  JointPeaks peaks;
  const auto first = inverse.nearest(segment.start(), arm.posture);
  if (!first) return {.is_reached = false};
  constexpr double kStep = 0.004;  // s
  robot::JointVector q = *first, speed = robot::JointVector::Zero(q.size());
  for (double t = kStep; t < segment.duration() + kStep; t += kStep) {
    const auto next = inverse.refine(segment.sample(t).X_WE, q);
    if (!next) return {.is_reached = false};
    const robot::JointVector now = (*next - q) / kStep;
    const robot::Jacobian J = tool_jacobian(inverse.arm(), forward(inverse.arm(), *next));
    peaks.least_measure = std::min(peaks.least_measure, robot::singularity_measure(J));
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const double limit = inverse.arm().joints[static_cast<std::size_t>(j)].max_speed;
      peaks.speed = std::max(peaks.speed, std::abs(now[j]) / limit);
      peaks.acceleration = std::max(peaks.acceleration, std::abs(now[j] - speed[j]) / kStep / arm.max_acceleration);
    }
    speed = now;
    q = *next;
  }
  return peaks;
}

/// On ways of the demonstrator's cell that are drawn at random.
void expect_limits_kept(const model::Scenario& scenario, const motion::PathLimits& pace, const Arm& arm) {
  const motion::Pace tool{2.0, 8.0, 2.5, 8.0, 0.1};
  Rng rng = Rng(1).split("ways");
  int reached = 0, bound = 0, around = 0;
  for (int i = 0; i < 90; ++i) {
    SCOPED_TRACE(i);
    const auto vector = [&](double size) {
      return Vector3(rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size));
    };
    // From hanging straight down to lying nearly level, as for a pick from the side; near the base and far from it.
    const Matrix3 R_down = exp_rotation(Vector3(std::numbers::pi, 0.0, 0.0));
    const Pose X_WA{exp_rotation(vector(1.2)) * R_down, Vector3(-0.5, -0.5, 0.1) + vector(0.25)};
    Pose X_WB{exp_rotation(vector(0.3)) * X_WA.R, X_WA.p + vector(0.2)};
    std::optional<motion::PanAxis> axis;
    if (i >= 60) {  // long ways around the first axis
      axis = find_pan_axis(scenario);
      ASSERT_TRUE(axis.has_value());
      const Vector3& p_WC = axis->p_WB;
      const Matrix3 R_pan = exp_rotation(Vector3(0.0, 0.0, rng.uniform(0.5, 1.8)));
      X_WB = {exp_rotation(vector(0.3)) * R_pan * X_WA.R, p_WC + R_pan * (X_WB.p - p_WC)};
    }
    const motion::Way way(X_WA, X_WB, axis);
    const JointPeaks paced = peaks_on({way, tool, &pace}, arm);
    if (!paced.is_reached || paced.least_measure < arm.least_measure) continue;
    ++reached;
    EXPECT_LE(paced.speed, 1.0);
    EXPECT_LE(paced.acceleration, 1.0);
    around += way.is_straight() ? 0 : 1;
    bound += peaks_on({way, tool, nullptr}, arm).acceleration > 1.0 ? 1 : 0;
  }
  EXPECT_GT(reached, 30);
  EXPECT_GT(around, 5);
  EXPECT_GT(bound, 5) << "ways on which the tool's own limits alone are too much for the joints";
}

TEST(JointPace, JointsKeepTheirSpeedsAndAccelerations) {
  model::Scenario scenario = model::load_scenario(kScenario);
  scenario.robot->velocity_fraction = 1.0;
  const auto pace = make_joint_pace(scenario, 1.0);
  ASSERT_NE(pace, nullptr);
  expect_limits_kept(scenario, *pace,
                     {robot::InverseKinematics(robot::load_arm(scenario)), robot::joint_vector(scenario.robot->posture),
                      scenario.robot->max_joint_acceleration});
}

TEST(JointPace, SevenJointsToo) {
  const model::Scenario scenario = model::load_scenario(kScenario);
  robot::ArmModel arm = robot::load_arm(scenario);
  robot::Joint roll = arm.joints[2];  // of the upper arm about its length, which is along x
  roll.X_SJ = {};
  roll.axis = Vector3::UnitX();
  arm.joints.insert(arm.joints.begin() + 2, roll);
  arm.segments.insert(arm.segments.begin() + 2, arm.segments[2]);
  const robot::InverseKinematics inverse(arm);
  ASSERT_FALSE(inverse.has_closed_form());
  std::vector<double> values = scenario.robot->posture;
  values.insert(values.begin() + 2, 0.3);
  const robot::JointVector posture = robot::joint_vector(values);
  const double acceleration = scenario.robot->max_joint_acceleration;
  expect_limits_kept(scenario, JointPace(arm, posture, 1.0, acceleration), {inverse, posture, acceleration, 0.06});
}

TEST(LimitJointSpeeds, OfProgramsThatAreNotFastTheControllerLimitsThemToo) {
  const model::Scenario demonstrator = model::load_scenario(kScenario);
  const auto fraction_with = [&](const motion::Tracking& tracking, double robots) {
    model::Scenario scenario = demonstrator;
    scenario.robot->velocity_fraction = robots;
    limit_joint_speeds(scenario, tracking);
    return scenario.robot->velocity_fraction;
  };
  EXPECT_EQ(fraction_with(motion::Tracking{}, 0.97), 0.5);
  EXPECT_EQ(fraction_with(motion::Tracking{}, 0.3), 0.3);
  EXPECT_EQ(fraction_with(motion::FastTracking{}, 0.97), 0.97);
}

TEST(TurnsGently, CartonsOfAPalletDoAndTheDemonstratorsBoxesDoNot) {
  const auto turns = [](const std::filesystem::path& path) {
    const model::Scenario scenario = model::load_scenario(path);
    return turns_gently(scenario, scenario.sequences.front());
  };
  EXPECT_FALSE(turns(kScenario));
  EXPECT_TRUE(turns(kScenario.parent_path() / "pallet-four-cups.yaml"));
}

}  // namespace
}  // namespace snug::cell
