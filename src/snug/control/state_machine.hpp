// StateMachine: which state of the robot's controller runs, and what the states do with their tick.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "snug/control/joint_controller.hpp"
#include "snug/motion/controller.hpp"

namespace snug::control {

/// Everything of program, states and joints that changes from tick to tick. Copying it is a snapshot.
struct MachineState {
  int state = -1;                ///< index of the state that runs; -1: none was started yet
  std::int64_t state_ticks = 0;  ///< since it was started
  motion::ControllerState program;
  JointState joints;
  motion::ToolState tool;  ///< measured: where the joints put the tool
  bool operator==(const MachineState&) const = default;
};

/// Where joints like this put the tool.
[[nodiscard]] motion::ToolState tool_at(const robot::ArmModel& arm, const JointMotion& joints);

/// What a state has come to.
enum class Outcome {
  GoesOn,
  Ok,     ///< it is done
  Stuck,  ///< a row of the program was not reached in time
};

/// What one tick did.
struct MachineTick {
  motion::ControllerOutput program;
  JointTick joints;
  int state = -1;                     ///< that commanded the joints
  Outcome outcome = Outcome::GoesOn;  ///< of the state
  bool has_commanded = false;
};

/// What a state sees of the rest.
struct StateContext {
  const motion::PreparedProgram& plan;
  const JointController& controller;
  MachineState& machine;
  MachineTick& tick;
  JointControllerWork& work;

  /// Moves the joints one tick toward the target. To be called once a tick by a state that does not pass on at once.
  void follow(const ToolTarget& target);
  /// Brakes all joints and keeps them where they come to rest.
  void stand();
};

struct StateSettings {
  double patience = 10.0;  ///< s that a row may take beyond the duration of its motion before the robot counts as stuck
};

/// A state: a small file with what is to be done in it. It remembers nothing between ticks: MachineState does.
class State {
 public:
  virtual ~State() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// Once, before anything runs.
  virtual void configure(const StateSettings&) {}
  /// When the machine comes to this state.
  virtual void start(StateContext&) const {}
  /// Every tick; the outcome that ends the state, or that it goes on.
  [[nodiscard]] virtual Outcome run(StateContext&) const = 0;
  /// When the machine leaves this state.
  virtual void teardown(StateContext&) const {}
};

/// From a state and its outcome to the next state. All are taken at once, without asking ("Auto" in mc_rtc).
struct Transition {
  std::string from;
  Outcome outcome = Outcome::Ok;
  std::string to;
};

class StateMachine {
 public:
  /// The first state is the one that starts. Transitions must name states (checked).
  StateMachine(std::vector<std::unique_ptr<State>> states, std::vector<Transition> transitions,
               const StateSettings& settings);

  /// Before the first tick, joints at rest at q.
  [[nodiscard]] MachineState make_state(const JointController& controller, const robot::JointVector& q) const;
  /// One tick. A state that ends without having moved the joints passes on within the tick; one whose outcome leads
  /// nowhere goes on running.
  [[nodiscard]] MachineTick tick(const motion::PreparedProgram& plan, const JointController& controller,
                                 MachineState& machine, JointControllerWork& work) const;
  [[nodiscard]] std::string_view name_of(int state) const;

 private:
  [[nodiscard]] int next(int state, Outcome outcome) const;

  std::vector<std::unique_ptr<State>> states_;
  std::vector<Transition> transitions_;
};

/// The demonstrator's: Initial -Ok-> Operation; and one more, Operation -Stuck-> Hold.
[[nodiscard]] StateMachine make_demonstrator_machine(const StateSettings& settings = {});

}  // namespace snug::control
