// JointController: the joint accelerations of one tick: tasks and limits of an arm as one quadratic programme.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "snug/control/clearance.hpp"
#include "snug/control/joint_drive.hpp"
#include "snug/model/robot_params.hpp"
#include "snug/numerics/qp.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::control {

struct JointControllerSettings {
  double tick = 0.008;           ///< s
  double tool_stiffness = 10.0;  ///< 1/s^2, critically damped: the report's end-effector task
  model::RobotParams params;
  std::vector<CarriedShapes> carried;  ///< what the tool frame carries: names that pairs may use besides the links
  std::string where;                   ///< whose parameters, for messages
};

enum class LimitKind : std::uint8_t { LowerPosition, UpperPosition, Speed, Acceleration, Distance };

/// One of the rows: of a joint, or of a pair of self_collision.
struct LimitId {
  LimitKind kind = LimitKind::Speed;
  int index = -1;
  bool operator==(const LimitId&) const = default;
};

/// Everything of the controller that changes: what it commands, and what it remembers. Copying it is a snapshot.
struct JointState : JointMotion {
  /// Damping chosen when a joint came near its lower (even entries) or upper limit; 0: it is not near.
  std::array<double, 2 * robot::kMaxJoints> damping{};
  std::int64_t held_ticks = 0;  ///< in a row, without a solution
  bool operator==(const JointState&) const = default;
};

/// What the tool's task aims at in one tick.
struct ToolTarget {
  Pose X_WE;  ///< reference
  /// Follow exactly instead of with the task's lag: be at X_WE with the twist V_WE at the end of the tick.
  bool is_exact = false;
  Twist V_WE;
};

/// What one tick did.
struct JointTick {
  bool is_holding = false;        ///< no accelerations fulfil all limits: the joints brake and stand
  LimitId worst;                  ///< holding: the limit with the largest part in the contradiction
  double violation = 0.0;         ///< holding: by how much at least it would be missed, rad/s^2 or m/s^2
  std::array<LimitId, 8> active;  ///< limits that shaped the motion, the strongest first
  int active_count = 0;
  Nearest nearest;           ///< of the pairs, at the start of the tick
  double singularity = 0.0;  ///< robot::singularity_measure at the start of the tick
  int rounds = 0;            ///< of the solver
};

/// Scratch memory; one per thread.
struct JointControllerWork {
  numerics::QpSolver solver;
  numerics::QpProblem problem;
  numerics::QpResult result;
  std::vector<LimitId> rows;
};

class JointController {
 public:
  /// Throws InputError for a pair of links that the arm does not have and for a posture of the wrong length.
  JointController(robot::ArmModel arm, JointControllerSettings settings);

  [[nodiscard]] const robot::ArmModel& arm() const { return arm_; }
  [[nodiscard]] const JointControllerSettings& settings() const { return settings_; }
  [[nodiscard]] const JointDrive& drive() const { return drive_; }
  [[nodiscard]] const Clearance& clearance() const { return clearance_; }

  /// At rest at q.
  [[nodiscard]] JointState make_state(const robot::JointVector& q) const;
  /// Chooses the accelerations of the coming tick; the drives follow the speeds that they lead to: state at its end.
  JointTick tick(const ToolTarget& target, JointState& state, JointControllerWork& work) const;

  /// One tick without a task: every joint brakes as hard as it may, then stands.
  void brake(JointState& state) const;

  /// "elbow_joint at its upper limit", "shoulder_link - gripper".
  [[nodiscard]] std::string describe(const LimitId& limit) const;

 private:
  /// Returns the singularity measure.
  [[nodiscard]] double add_tasks(const ToolTarget& target, const JointState& state, const robot::ArmPose& at,
                                 numerics::QpProblem& problem) const;
  void add_joint_limits(JointState& state, JointControllerWork& work) const;
  void add_distances(const JointState& state, const robot::ArmPose& at, JointTick& report,
                     JointControllerWork& work) const;
  void report_active(const JointControllerWork& work, JointTick& report) const;

  robot::ArmModel arm_;
  JointControllerSettings settings_;
  JointDrive drive_;
  Clearance clearance_;
  robot::JointVector posture_;
};

}  // namespace snug::control
