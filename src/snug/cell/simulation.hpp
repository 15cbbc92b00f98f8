// Simulation: the cell of a scenario under way, tick by tick; any state of it can be kept, copied and gone back to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snug/cell/cell_arm.hpp"
#include "snug/cell/failure.hpp"
#include "snug/cell/item_event_log.hpp"
#include "snug/cell/joint_pace.hpp"
#include "snug/cell/lost_body.hpp"
#include "snug/cell/solver_summary.hpp"
#include "snug/motion/controller.hpp"

namespace snug::cell {

struct SimulationOptions {
  motion::Tracking tracking = {};
  /// Absent: with phases, in `run` as the corrections were made for (runs::cup_for; docs/decisions/0040).
  std::optional<cup::CupMode> cup = {};
  std::string robot = {};  ///< name of the scenario's robot that moves the tool; empty: the tool moves by itself
};

/// Everything of a cell that changes. A copy is a snapshot: going on from it gives the same bytes.
struct CellState {
  physics::WorldState world;
  motion::ControllerState controller;
  GripperState gripper;
  ItemEventLog event_log;
  int waiting_item = -1;        ///< of the sequence, that stands at the aligner; -1 when none does
  std::optional<ArmState> arm;  ///< with a robot
};

/// Scratch memory and what is gathered on the way; one per thread. It has no influence on what happens.
struct CellWorkspace {
  CellWorkspace(const physics::WorldModel& model, const model::ContactLimits& limits, int threads)
      : physics(model, threads), solver(limits) {}
  physics::Workspace physics;
  SolverMonitor solver;
  GripperStep gripper;
  std::vector<GripperEvent> events;
  control::JointControllerWork joints;
  std::vector<physics::KinematicTarget> targets;
  std::vector<physics::ExternalWrench> wrenches;
  std::vector<LostBody> lost;
  ArmReading arm;  ///< of the last tick, with a robot
};

/// What one controller tick did.
struct CellTick {
  bool has_ended = false;    ///< the last row was found reached at its start
  int row = -1;              ///< aimed at
  motion::ToolState tool;    ///< at its end
  Pose X_WE_reference;       ///< what the tool's task followed
  cup::CupCommand command;   ///< throughout
  physics::StepReport step;  ///< of its last physics step
  Failure failure;           ///< why the run has to stop
};

/// Where a cell is taken up: what somebody who did not watch it from the start believes of it. Nothing is held.
struct CellAnchor {
  struct Box {
    int item = 0;  ///< of the sequence
    Pose X_WP;
    bool operator==(const Box&) const = default;
  };
  std::vector<Box> boxes;  ///< at rest; items that are not named are not in the cell
  Pose X_WE;               ///< of the tool, at rest
  std::vector<double> q;   ///< rad; with a robot these count, if given, and X_WE does not
};

/// The sequence of this name. Throws InputError, with the names that there are.
[[nodiscard]] const model::Sequence& require_sequence(const model::Scenario& scenario, const std::string& name);
/// The program with the limits and gains of scenario and sequence; of `options` the tracking counts. Throws as
/// motion::prepare.
[[nodiscard]] motion::PreparedProgram prepare(const model::Scenario& scenario, const model::Sequence& sequence,
                                              const SimulationOptions& options, motion::Program program);

/// What a controller outside of the cell commands for one tick.
struct OutsideCommand {
  control::DriveCommand joints;
  cup::CupCommand cup;
};

/// Where a tool that moves by itself is at the end of a tick, and what the cup is told throughout.
struct ToolCommand {
  motion::ToolState tool;
  cup::CupCommand cup;
};

class Simulation {
 public:
  /// Throws InputError for a scenario without tool or aligner, an unknown sequence, and a controller tick that is no
  /// multiple of the time step.
  Simulation(model::Scenario scenario, const std::string& sequence, const SimulationOptions& options);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  [[nodiscard]] const model::Scenario& scenario() const { return scenario_; }
  [[nodiscard]] const model::Sequence& sequence() const { return sequence_; }
  [[nodiscard]] const SimulationOptions& options() const { return options_; }
  [[nodiscard]] const CellWorld& world() const { return world_; }
  /// Without a robot: nullptr.
  [[nodiscard]] const CellArm* arm() const { return arm_.get(); }

  /// At time 0: the tool at its start, no box in the cell.
  [[nodiscard]] CellState make_state() const;
  /// At time 0, everything where the anchor says.
  [[nodiscard]] CellState take_up(const CellAnchor& anchor) const;
  /// `threads` share the work of large cells; the bytes do not depend on their number.
  [[nodiscard]] CellWorkspace make_workspace(int threads = 1) const {
    return CellWorkspace(world_.model, scenario_.solver.contact_limits, threads);
  }
  /// cell::prepare of this cell's scenario and sequence. With fast tracking the joints of the scenario's robot
  /// limit the speed, whatever moves the tool; the plan is then good for as long as this simulation.
  [[nodiscard]] motion::PreparedProgram prepare(motion::Program program) const;
  /// What the arm's sensors read in this state, as if it had been still for a tick. With a robot only.
  [[nodiscard]] ArmReading read_still(const CellState& state) const;

  /// One controller tick and its physics steps.
  CellTick advance(const motion::PreparedProgram& plan, CellState& state, CellWorkspace& work) const;
  /// One controller tick, the joints following targets from outside, and its physics steps. With a robot only; every
  /// target is finite and there is one for each joint (checked).
  CellTick advance(const OutsideCommand& command, CellState& state, CellWorkspace& work) const;
  /// One controller tick, the tool on a path from outside, such as a recorded one, and its physics steps. Without a
  /// robot only; the pose is finite (checked).
  CellTick advance(const ToolCommand& command, CellState& state, CellWorkspace& work) const;
  /// The item comes to the aligner as for a program, turned by this many quarter turns where the sequence leaves that
  /// open
  /// (`choose_quarter`); one that waits there and is not held is taken away. False: it came before.
  bool feed(int item, int quarter, CellState& state) const;
  /// The same, standing where it was seen to stand.
  bool feed(int item, const Pose& X_WP, CellState& state) const;
  /// "robot/forearm_link touches tote with 12 N"
  [[nodiscard]] std::string describe_touch(const ArmTouch& touch) const;
  /// To be called when a run ends: touches of the arm that go on become events as if they ended now.
  void end_touches(CellState& state) const;
  /// Whether the coming tick would find the last row reached. A program that goes on instead may be put in the place of
  /// `plan` now: rows appended at this moment are executed as if they had always been there.
  [[nodiscard]] bool is_at_end(const motion::PreparedProgram& plan, const CellState& state) const;

  /// Another program goes on from here: its first row is aimed at next, the tool keeps its speed. Switches stay.
  void begin_motion(CellState& state) const;
  /// The tool, and the arm, are at rest from now on: the brakes are closed.
  void stand(CellState& state) const;
  /// A protective stop, after the tick that `work` is of: CellArm::acknowledge.
  void acknowledge(const CellWorkspace& work, CellState& state) const;
  /// The item comes to the aligner; what stands where it comes, and is not held, is taken away.
  void bring(int item, CellState& state) const;
  /// On the tool, from what it carries and touches, about Eo, in E: what a sensor between arm and tool reads beyond the
  /// tool's own weight.
  [[nodiscard]] Wrench tool_load(const CellState& state, const CellWorkspace& work) const;

  [[nodiscard]] double time(const CellState& state) const { return state.world.time(world_.model); }
  [[nodiscard]] std::vector<BoxResult> boxes(const CellState& state) const;
  [[nodiscard]] std::uint64_t hash(const CellState& state) const;

 private:
  void depart(const motion::PreparedProgram& plan, int row, CellState& state) const;
  void feel(const motion::PreparedProgram& plan, CellState& state, const CellWorkspace& work) const;
  void place(physics::BodyId body, const Pose& X_WB, CellState& state) const;
  [[nodiscard]] motion::ToolState tool_of(const CellState& state) const;
  /// work.targets: where tool and links are at the end of the step. `waypoint`: aimed at, for events.
  void advance_step(const motion::Waypoint* waypoint, const motion::ToolState& tool, CellState& state,
                    CellWorkspace& work, CellTick& tick) const;
  void advance_tool(const motion::Waypoint* waypoint, const motion::ToolState& start, const motion::ToolState& end,
                    CellState& state, CellWorkspace& work, CellTick& tick) const;
  void note_touch(const ArmTouch& touch, bool has_ended, CellState& state) const;
  void advance_arm(const ArmTask& task, const control::JointMotion& start, const control::JointWay& way,
                   CellState& state, CellWorkspace& work, CellTick& tick) const;
  void read_arm(const ArmTask& task, ArmLoads& loads, CellState& state, CellWorkspace& work, CellTick& tick) const;

  model::Scenario scenario_;
  SimulationOptions options_;
  model::Sequence sequence_;
  int substeps_ = 1;
  std::unique_ptr<CellArm> arm_;
  std::unique_ptr<const JointPace> pace_;
  CellWorld world_;
  Gripper gripper_;
};

}  // namespace snug::cell
