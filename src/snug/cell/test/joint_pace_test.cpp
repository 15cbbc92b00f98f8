// JointPace on the demonstrator's arm: joints keep their speeds and accelerations on every way that it times.
#include "snug/cell/joint_pace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::cell {
namespace {

const std::filesystem::path kScenario = std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/box-demonstrator.yaml";

struct JointPeaks {
  double speed = 0.0, acceleration = 0.0;  ///< of any joint, in units of its limit
  bool is_reached = true;
};

/// Of the arm that follows the segment exactly, by differences.
JointPeaks peaks_on(const motion::PacedSegment& segment, const model::Scenario& scenario) {
  const robot::InverseKinematics inverse(robot::load_arm(scenario));
  const robot::JointVector posture = robot::joint_vector(scenario.robot->posture);
  JointPeaks peaks;
  const auto first = inverse.nearest(segment.start(), posture);
  if (!first) return {0.0, 0.0, false};
  constexpr double kStep = 0.004;  // s
  robot::JointVector q = *first, speed = robot::JointVector::Zero(q.size());
  for (double t = kStep; t < segment.duration() + kStep; t += kStep) {
    const auto next = inverse.refine(segment.sample(t).X_WE, q);
    if (!next) return {0.0, 0.0, false};
    const robot::JointVector now = (*next - q) / kStep;
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const double limit = inverse.arm().joints[static_cast<std::size_t>(j)].max_speed;
      peaks.speed = std::max(peaks.speed, std::abs(now[j]) / limit);
      peaks.acceleration =
          std::max(peaks.acceleration, std::abs(now[j] - speed[j]) / kStep / scenario.robot->max_joint_acceleration);
    }
    speed = now;
    q = *next;
  }
  return peaks;
}

TEST(JointPace, JointsKeepTheirSpeedsAndAccelerations) {
  model::Scenario scenario = model::load_scenario(kScenario);
  scenario.robot->velocity_fraction = 1.0;
  const auto pace = make_joint_pace(scenario, 1.0);
  ASSERT_NE(pace, nullptr);
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
    const JointPeaks paced = peaks_on({way, tool, pace.get()}, scenario);
    if (!paced.is_reached) continue;
    ++reached;
    EXPECT_LE(paced.speed, 1.0);
    EXPECT_LE(paced.acceleration, 1.0);
    around += way.is_straight() ? 0 : 1;
    bound += peaks_on({way, tool, nullptr}, scenario).acceleration > 1.0 ? 1 : 0;
  }
  EXPECT_GT(reached, 30);
  EXPECT_GT(around, 5);
  EXPECT_GT(bound, 5) << "ways on which the tool's own limits alone are too much for the joints";
}

}  // namespace
}  // namespace snug::cell
