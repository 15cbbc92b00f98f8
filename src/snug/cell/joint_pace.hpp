// JointPace: how fast the joints of the scenario's robot let the tool go, and gain speed, along a way.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "snug/model/scenario.hpp"
#include "snug/motion/paced_segment.hpp"
#include "snug/motion/tracking.hpp"
#include "snug/robot/inverse.hpp"

namespace snug::cell {

class JointPace final : public motion::PathLimits {
 public:
  /// `share`: of the joints' largest speeds. `acceleration`: of every joint, rad/s^2 (m/s^2).
  JointPace(robot::ArmModel arm, robot::JointVector posture, double share, double acceleration)
      : inverse_(arm), posture_(std::move(posture)), share_(share), acceleration_(acceleration) {}
  /// Along the branch of the inverse that begins nearest to the robot's posture. Parts that the arm does not reach are
  /// left as they are: whether it reaches them is not asked here.
  void limit(const motion::Way& way, std::span<double> rates, std::span<double> accelerations) const noexcept override;

 private:
  robot::InverseKinematics inverse_;
  robot::JointVector posture_;
  double share_, acceleration_;
};

/// The robot's first axis. None without a robot, and where it does not stand upright.
[[nodiscard]] std::optional<motion::PanAxis> find_pan_axis(const model::Scenario& scenario);

/// Programs that are not fast have the controller's share of the joints' speeds, if that is less than the robot's.
void limit_joint_speeds(model::Scenario& scenario, const motion::Tracking& tracking);

/// With the share of the scenario (velocity_fraction) and the tempo. None without a robot and where its file is not
/// there.
[[nodiscard]] std::unique_ptr<const JointPace> make_joint_pace(const model::Scenario& scenario, double tempo);

}  // namespace snug::cell
