// CellArm: a robot's arm in the cell: its links among the bodies, what its sensor reads, when it stops for protection.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "snug/cell/gripper.hpp"
#include "snug/cell/protective_stop.hpp"
#include "snug/control/state_machine.hpp"
#include "snug/core/rng.hpp"
#include "snug/geometry/bounds.hpp"
#include "snug/record/recording.hpp"
#include "snug/robot/dynamics.hpp"

namespace snug::cell {

/// A moving link of the arm (not the gripper) against a box or against what never moves.
struct ArmTouch {
  physics::BodyId link;
  physics::BodyId other;
  double since = 0.0;  ///< s, end of the first tick in which they touched
  double last = 0.0;   ///< s, end of the last one so far
  double force = 0.0;  ///< N, the largest so far
};

/// What a controller outside of the cell has the joints do. Its loads are what acted on the arm last.
struct OutsideDrive {
  robot::JointVector position_before;  ///< JointDrive::follow
  robot::JointVector torques_felt;   ///< at the joints, Nm (N): of contacts and of what the cup holds, in the last step
  robot::JointVector torques_fixed;  ///< likewise: of what never moves, at the end of the last tick
};

/// What pressed on the arm when a stop was acknowledged: it may move out of that load. Zero: nothing.
struct AcknowledgedLoad {
  robot::JointVector torques;  ///< Nm (N), at the joints
  double force = 0.0;          ///< N, at the sensor, beyond the weight
  double torque = 0.0;         ///< Nm, likewise
};

/// Everything of the arm that changes. Copying it is a snapshot.
struct ArmState {
  control::MachineState machine;
  Rng noise{0};                   ///< of the force sensor
  std::vector<ArmTouch> touches;  ///< that have not ended
  OutsideDrive outside;
  AcknowledgedLoad acknowledged;
};

/// What acts on the arm, averaged over a tick.
struct ArmLoads {
  Wrench F_Eo_W;               ///< on the tool, about E's origin
  robot::JointVector torques;  ///< of contacts on the links, at the joints
  int steps = 0;
  double worst_force = 0.0;     ///< N, of the strongest contact
  physics::BodyId worst_part;   ///< link or tool
  physics::BodyId worst_other;  ///< what it touches
  /// Of each pair of a moving link and something else, the largest force of a step, or the spring's against what never
  /// moves.
  std::vector<ArmTouch> touches;
};

/// What the arm is about in a tick: a row of a program, or what it is told from outside.
struct ArmTask {
  int row = -1;                                    ///< of the program, aimed at
  const motion::Waypoint* waypoint = nullptr;      ///< of that row; none: driven from outside
  bool is_stuck = false;                           ///< the row was not reached in time
  control::JointTick control = {};                 ///< of a program
  const control::DriveCommand* outside = nullptr;  ///< not owned
};

/// What the arm does and feels at the end of a tick.
struct ArmReading {
  std::vector<record::JointSample> joints;
  Wrench F_Eo_W;                                 ///< on the tool, about E's origin: mean over the tick
  Wrench F_sensor;                               ///< with noise, bias and drift; in the sensor's frame
  double sensor_force = 0.0;                     ///< N, without those, beyond the weight of the gripper
  double sensor_torque = 0.0;                    ///< Nm, likewise
  std::vector<physics::ContactReport> contacts;  ///< of links and gripper with what never moves
  control::JointTick control;
  std::optional<ProtectiveStop> stop;
  std::vector<ArmTouch> touches_begun;  ///< in this tick
  std::vector<ArmTouch> touches_ended;  ///< a while ago, known now
};

class CellArm {
 public:
  /// The robot of the scenario, at its start. Throws InputError as robot::load_arm, and when the start cannot be
  /// reached.
  CellArm(const model::Scenario& scenario, double task_stiffness);

  [[nodiscard]] const robot::ArmModel& model() const { return controller_.arm(); }
  [[nodiscard]] const control::JointController& controller() const { return controller_; }
  [[nodiscard]] const robot::JointVector& start() const { return start_; }
  /// To be called once, with the world that the arm's bodies are in.
  void attach(const CellWorld& world);

  [[nodiscard]] ArmState make_state(std::uint64_t seed) const { return make_state(seed, start_); }
  /// At rest at q.
  [[nodiscard]] ArmState make_state(std::uint64_t seed, const robot::JointVector& q) const;
  /// At rest where it is; its controller starts anew.
  void stand(ArmState& state) const;
  /// After a stop: the load that `reading` shows stops the arm again only when it grows by half, until it was below
  /// the limit once.
  void acknowledge(const ArmReading& reading, ArmState& state) const;
  /// One tick of the controller. `program` is brought up to date.
  [[nodiscard]] control::MachineTick tick(const motion::PreparedProgram& plan, motion::ControllerState& program,
                                          ArmState& state, control::JointControllerWork& work) const;
  /// Accelerations at `motion` of joints that are driven from outside, those under torque by what acts on the arm.
  [[nodiscard]] robot::JointVector driven_accelerations(const control::DriveCommand& command,
                                                        const control::JointMotion& motion,
                                                        const OutsideDrive& outside) const;
  /// Loads on the tool and on the links, at the joints, Nm (N).
  [[nodiscard]] robot::JointVector torques_of(const robot::ArmPose& at, const ArmLoads& loads) const;
  /// Poses of the tool and of the arm's bodies, in the order of CellWorld: targets for one physics step.
  void aim(const CellWorld& world, const robot::ArmPose& at, std::vector<physics::KinematicTarget>& targets) const;
  /// Adds what acted on tool and links in one physics step.
  void add_loads(const CellWorld& world, const physics::WorldState& state, const physics::Workspace& work,
                 const GripperState& gripper, const robot::ArmPose& at, ArmLoads& loads) const;
  /// Contacts with what never moves, sensor, torques and limits, at the end of a tick.
  void read(const CellWorld& world, const ArmTask& task, double time, ArmLoads& loads, ArmState& state,
            ArmReading& reading) const;

 private:
  struct Obstacle {
    int body = -1;
    geometry::Shape shape;
    Pose X_WG;
    geometry::Aabb bounds;
  };
  struct MovingShape {
    int body = -1;  ///< of the world
    control::ArmShape shape;
  };
  [[nodiscard]] double touch_obstacles(const CellWorld& world, const robot::ArmPose& at, ArmLoads& loads,
                                       ArmReading& reading) const;
  [[nodiscard]] std::optional<ProtectiveStop> find_stop(const ArmState& state, const ArmTask& task,
                                                        const ArmReading& reading, double yielded) const;
  /// A load that is below its limit again is no longer acknowledged.
  void forget_released(const ArmReading& reading, AcknowledgedLoad& acknowledged) const;
  [[nodiscard]] double torque_limit(Eigen::Index joint) const;
  void follow_touches(double time, const ArmLoads& loads, ArmState& state, ArmReading& reading) const;
  void add_force(const robot::ArmPose& at, int segment, const Vector3& p_WQ, const Vector3& force_W, bool is_tool,
                 ArmLoads& loads) const;
  [[nodiscard]] Wrench disturbed(const Wrench& F, double time, Rng& noise) const;

  model::RobotParams params_;
  Vector3 gravity_;
  control::JointController controller_;
  control::StateMachine machine_;
  robot::JointVector start_;
  int sensor_link_ = -1;
  SpatialInertia load_;
  std::vector<Obstacle> obstacles_;
  std::vector<MovingShape> shapes_;
};

}  // namespace snug::cell
