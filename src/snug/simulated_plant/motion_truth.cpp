// MotionTruth: how an item was really moved: hold of the cup, swing before contact, how much the joints were asked.
#include "snug/simulated_plant/motion_truth.hpp"

#include <algorithm>
#include <cmath>

#include "snug/motion/fast_settings.hpp"

namespace snug::simulated_plant {
namespace {

constexpr double kStill = 0.003;  ///< m/s and rad/s: a tool that goes straight down

}  // namespace

void MotionWitness::follow(const cell::Simulation& simulation, const cell::CellState& state,
                           const cell::CellWorkspace& work, const motion::Waypoint& row, double dt) {
  truth_.hold_factor = state.gripper.least_hold_factor;
  if (state.arm) follow_joints(simulation, state, dt);
  follow_swing(simulation, state, work, row);
}

void MotionWitness::follow_joints(const cell::Simulation& simulation, const cell::CellState& state, double dt) {
  const model::RobotParams& robot = *simulation.scenario().robot;
  const robot::JointVector& speed = state.arm->machine.joints.qd;
  for (Eigen::Index j = 0; j < speed.size(); ++j) {
    const double most =
        robot.velocity_fraction * simulation.arm()->model().joints[static_cast<std::size_t>(j)].max_speed;
    truth_.joint_speed = std::max(truth_.joint_speed, std::abs(speed[j]) / most);
    if (last_speed_.size() == 0) continue;
    const double acceleration = std::abs(speed[j] - last_speed_[j]) / dt;
    truth_.joint_acceleration = std::max(truth_.joint_acceleration, acceleration / robot.max_joint_acceleration);
  }
  last_speed_ = speed;
}

void MotionWitness::follow_swing(const cell::Simulation& simulation, const cell::CellState& state,
                                 const cell::CellWorkspace& work, const motion::Waypoint& row) {
  const int body = state.gripper.cup.body;
  const motion::ToolState& tool = state.arm ? state.arm->machine.tool : state.controller.command;
  const bool is_straight = tool.V_WE.linear.head<2>().norm() < kStill && tool.V_WE.angular.norm() < kStill;
  const bool is_place =
      row.motion_class == motion::MotionClass::Place || row.motion_class == motion::MotionClass::PlaceSlow;
  if (body < 0 || !row.io.vacuum || !is_place || !is_straight) {
    is_inserting_ = false;
    return;
  }
  const Pose X_EP =
      tool.X_WE.inverse() * physics::pose_of(simulation.world().model, state.world, physics::BodyId{body});
  if (!is_inserting_) {
    is_inserting_ = true;
    has_touched_ = false;
    R_EP_ = X_EP.R;
    low_ = high_ = X_EP.p;
    turn_low_ = turn_high_ = Vector3::Zero();
  }
  has_touched_ = has_touched_ || std::ranges::any_of(work.physics.contacts(), [&](const physics::ContactReport& one) {
                   return one.a.index == body || one.b.index == body;
                 });
  if (has_touched_) return;
  const Vector3 turn = log_rotation(X_EP.R * R_EP_.transpose());
  low_ = low_.cwiseMin(X_EP.p);
  high_ = high_.cwiseMax(X_EP.p);
  turn_low_ = turn_low_.cwiseMin(turn);
  turn_high_ = turn_high_.cwiseMax(turn);
  truth_.swing = std::max(truth_.swing, 0.5 * (high_ - low_).head<2>().norm());
  truth_.swing_angle = std::max(truth_.swing_angle, 0.5 * (turn_high_ - turn_low_).norm());
}

}  // namespace snug::simulated_plant
