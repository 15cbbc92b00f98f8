// Controller: the simulated cell as what a UR controller makes of it, one period after the other.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/model/robot_io.hpp"
#include "snug/runs/outside_run.hpp"
#include "snug/served_cell/feeder.hpp"
#include "snug/served_ur/ur_arm.hpp"
#include "snug/ur/robot_data.hpp"

namespace snug::served_ur {

namespace internal {
class Programs;
}

struct ControllerSettings {
  ur::Model model = ur::Model::Ur10;
  bool feeds_on_request = false;  ///< a box comes only when it is asked for, where robot.io has next_part
  /// Boxes that come by themselves wait until the one before is over the container, or gone: it may be put down at the
  /// aligner to be grasped anew.
  bool feeds_when_placed = false;
  bool programs_reach_others = false;  ///< programs may open sockets to other machines
  /// Folder of the programs that the dashboard may load: NAME.script for NAME.urp; empty: there are none.
  std::string programs = {};
  /// What is to be done with each run, from 1; asked for when it begins.
  std::function<runs::OutsideRunOptions(int run)> begin_run = {};
  std::function<void(int run, const runs::RunResult& result)> end_run = {};
};

/// Outputs and inputs are wired as `robot.io` of the scenario says.
/// No sockets and no clock: the same calls in the same periods give the same cell, bit by bit.
///
/// The controller starts with the robot ready: power on, brakes released. A run of the cell begins with the first
/// output that is switched, and with the first program; before, the cell is at time 0. It ends with end(), and when the
/// cell fails (a box that leaves it): then the controller is in a fault until restart_safety(), which begins a new
/// cell. After a protective stop the arm stands, a program pauses, and the cell goes on.
class Controller {
 public:
  /// The simulation's tick is the period of the model (checked). Throws as UrArm. The simulation outlives the
  /// controller.
  Controller(const cell::Simulation& simulation, ControllerSettings settings);
  ~Controller();
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  /// s, of a controller of this model.
  [[nodiscard]] static double period_of(ur::Model model) { return 1.0 / ur::facts_of(model).rate; }

  /// One period. Throws OutputError when a recording cannot be written.
  void step();
  /// Periods so far.
  [[nodiscard]] std::int64_t period() const { return period_; }
  [[nodiscard]] const ur::RobotData& data() const { return data_; }
  [[nodiscard]] const ur::RobotFacts& robot() const { return arm_.facts(); }
  [[nodiscard]] const ur::ModelFacts& model() const { return ur::facts_of(settings_.model); }
  /// Messages for the primary and secondary ports since they were taken last, as packets.
  [[nodiscard]] std::vector<std::string> take_messages();

  /// What clients of RTDE set; acts in the next period.
  [[nodiscard]] ur::RobotInputs& inputs() { return inputs_; }

  void power_on();
  void power_off();
  /// With power, if that is off.
  void release_brakes();
  /// False: there is no protective stop, or it is younger than 5 s.
  bool unlock_protective_stop() { return release_stop(kUnlockAfter); }
  /// After a fault: the controller starts again without power, with a new cell. It does nothing else.
  void restart_safety();

  /// Starts a program (urscript::parse); clients hear what becomes of it. It ends the one that runs; a secondary one
  /// runs beside it.
  void run_program(std::string_view text);
  void stop_program();
  /// Reads the program of this file, for play(): its folders do not count, NAME.urp is NAME.script. The program that
  /// runs ends. False: ControllerSettings::programs has no such file, or one above kLongestProgram.
  bool load_program(std::string_view file);
  /// Goes on with the program that is paused, or begins the one that was loaded. False: there is none, it is no
  /// program, or one runs.
  bool play();
  /// False: no program runs.
  bool pause_program();
  void close_popup();
  /// Of the program that runs or ran last, or was loaded since; empty before the first.
  [[nodiscard]] const std::string& program_name() const;
  /// The file that was loaded last, without its folders; empty: none.
  [[nodiscard]] const std::string& loaded_program() const { return loaded_name_; }
  static constexpr std::size_t kLongestProgram = 5'000'000;  ///< bytes
  /// Line, column and what was wrong with the program that failed last; empty: none since run_program().
  [[nodiscard]] const std::string& program_error() const { return program_error_; }

  /// A line of the script ports that is a command of its own: `power on`, `power off`, `set robotmode run`,
  /// `set unlock protective stop` (as soon as it may be), `stop program`. False: it is none.
  bool obey(std::string_view line);

  /// Ends the run, if there is one.
  void end(const std::string& why);
  [[nodiscard]] int runs() const { return run_count_; }
  [[nodiscard]] const cell::Simulation& simulation() const { return simulation_; }
  /// The cell as it is, for who looks on: state, what the arm reads, the load on the tool (Simulation::tool_load).
  [[nodiscard]] const cell::CellState& state() const { return run_ ? run_->state() : initial_; }
  [[nodiscard]] const cell::ArmReading& reading() const { return run_ ? run_->reading() : initial_reading_; }
  [[nodiscard]] Wrench tool_load() const { return run_ ? run_->tool_load() : Wrench{}; }
  /// s of the clock that the last period took.
  [[nodiscard]] double step_seconds() const { return data_.execution_time; }

 private:
  static constexpr double kUnlockAfter = 5.0;  ///< s, that a protective stop lasts at least
  /// What a script port asks for is done as soon as it may be. The maker's client waits 5 s for it, from when it asks.
  static constexpr double kUnlockAskedAfter = 4.5;

  /// False: there is no protective stop, or it is younger than `after`, s.
  bool release_stop(double after);
  void take_inputs();
  void advance_mode();
  void set_mode(ur::RobotMode mode);
  void set_safety(ur::SafetyMode mode);
  [[nodiscard]] bool may_move() const;
  void hold();
  void stand();
  void stop_for_protection(const std::string& why, int code);
  void run_programs();
  void tell(std::string packet);
  void begin_run();
  void advance_cell();
  void take_next_part();
  void fail(const cell::Failure& failure);
  void read_cell();
  void read_force(const cell::CellState& state, const Pose& X_WT);
  [[nodiscard]] std::uint64_t read_inputs(const cell::CellState& state) const;
  void read_gauge(const cell::CellState& state);

  const cell::Simulation& simulation_;
  ControllerSettings settings_;
  model::RobotIo io_;
  std::uint64_t outputs_off_;  ///< digital outputs with nothing switched on
  UrArm arm_;
  cell::CellState initial_;
  cell::ArmReading initial_reading_;
  std::unique_ptr<runs::OutsideRun> run_;
  bool is_ended_ = false;  ///< the run, by a failure
  int run_count_ = 0;
  served_cell::Feeder feeder_;
  int moving_out_ = 0;           ///< periods of motion after a stop in which the arm may leave what stopped it
  bool was_asked_ = false;       ///< for the next part, in the last period
  std::int64_t part_since_ = 0;  ///< period from which a part that was asked for is told of
  std::unique_ptr<internal::Programs> programs_;
  std::string program_error_;
  std::string loaded_name_, loaded_text_;
  bool is_loaded_last_ = false;  ///< since another program was sent
  ur::RobotData data_;
  ur::RobotInputs inputs_;
  std::int64_t period_ = 0;
  std::int64_t mode_since_ = 0;         ///< period
  std::int64_t stopped_since_ = 0;      ///< period of the last protective stop
  bool is_unlock_wanted_ = false;       ///< by a script port, as soon as it may be
  bool wants_brakes_released_ = false;  ///< once it is idle
  std::vector<std::string> messages_;
};

}  // namespace snug::served_ur
