// RobotExport: a program for the controller of a real robot, tried in its cell before.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/control/robot_program.hpp"
#include "snug/control/urscript.hpp"
#include "snug/runs/program_trial.hpp"

namespace snug::runs {

/// What a program is written from besides scenario and waypoints.
struct RobotExportSettings {
  std::string program_name = {};                      ///< file, for comments
  std::string version = {};                           ///< of this program, for comments
  std::string corrections = {};                       ///< layer of the scenario; empty: none
  bool is_unchecked = false;                          ///< not tried in the cell
  std::function<void(const std::string&)> warn = {};  ///< told from which waypoint on the load is not known
};

/// Standard inputs and outputs, in the place of those of the scenario.
struct StandardWiring {
  std::optional<int> vacuum_output = {}, blow_off_output = {}, vacuum_input = {}, part_input = {};
};
/// Throws InputError where two outputs or two inputs are one.
[[nodiscard]] model::RobotIo with_wiring(model::RobotIo io, const StandardWiring& wiring);

/// What is written, or why not.
struct RobotText {
  std::string text;
  std::string summary;  ///< a line: how much, how long
  std::string refusal;  ///< not empty: the program does not succeed, and nothing is to be written
};

class RobotExport {
 public:
  /// Throws InputError for a scenario without a robot and as Simulation and motion::prepare do.
  RobotExport(const model::Scenario& scenario, const std::string& sequence, const motion::Program& program,
              cell::SimulationOptions how, RobotExportSettings settings);

  [[nodiscard]] const model::Scenario& scenario() const { return simulation_.scenario(); }

  /// Waypoints as straight moves, for a robot that follows them exactly; of a fast program that is no dry run the
  /// joints in time. It begins with the box `from`, or where that is empty with the program. Throws InputError for a
  /// box that is not picked and for a robot that is no UR.
  [[nodiscard]] RobotText urscript(control::UrScriptOptions script, const std::string& from) const;
  /// `period`: s between points at most. Throws as control::format_ros_trajectory.
  [[nodiscard]] RobotText ros_trajectory(double period) const;
  [[nodiscard]] RobotText log_csv() const;
  [[nodiscard]] RobotText log_flat() const;

 private:
  struct Run {
    std::optional<control::JointRun> joints;
    std::string refusal;
  };
  [[nodiscard]] bool is_fast() const { return motion::is_fast(plan_.settings.tracking); }
  [[nodiscard]] const Pose& X_WE_start() const { return simulation_.scenario().controller.X_WE_start; }
  [[nodiscard]] control::RobotProgram for_robot(const motion::PreparedProgram& done, bool is_ur) const;
  [[nodiscard]] motion::PreparedProgram fitted() const;
  [[nodiscard]] std::vector<std::optional<control::CarriedLoad>> find_loads() const;
  [[nodiscard]] std::string find_refusal() const;
  [[nodiscard]] std::string find_refusal_of(const motion::PreparedProgram& fitted) const;
  [[nodiscard]] Run find_run() const;
  [[nodiscard]] std::size_t find_first_row(const std::string& from) const;
  [[nodiscard]] RobotText moves(const control::UrScriptOptions& script) const;
  [[nodiscard]] RobotText targets(const control::UrScriptOptions& script) const;
  [[nodiscard]] RobotText of_run(const std::function<std::string(const control::JointRun&)>& format) const;

  RobotExportSettings settings_;
  cell::Simulation simulation_;
  motion::PreparedProgram plan_;  ///< as it is simulated: with the tool that lags behind, or fast
  /// Done in the cell, with contact: of a fast program what is written, since contact ends its waypoints and its waits.
  std::optional<MotionTrial> trial_;
};

}  // namespace snug::runs
