// check_program: whether the arm can do a program, without any contact physics.
#pragma once

#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/motion/controller.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::runs {

enum class CheckKind { Reach, JointLimit, JointSpeed, Singularity, Collision, SelfCollision, Hold };
[[nodiscard]] const char* name_of(CheckKind kind);

/// The worst that was found of one kind, for one thing, on the way to one row.
struct CheckFinding {
  CheckKind kind = CheckKind::Reach;
  bool is_error = true;  ///< false: the controller copes, by being slower
  int row = 0;           ///< of the program, from 0, that the tool was on its way to
  std::string waypoint;
  std::string what;  ///< joint, or "part - body"
  /// To the limit, of collisions to the body; negative: beyond it, inside it. Of a hold: how many times more than it
  /// has to the cup could carry.
  double margin = 0.0;
  double allowance = 0.0;  ///< how far it may be beyond, in the same unit
  std::string unit;
  double time = 0.0;  ///< s, in the timing of the controller
};

/// Findings of one kind and thing, of all rows.
struct CheckGroup {
  CheckFinding worst;
  std::vector<int> rows;  ///< in order
};

struct CheckOptions {
  std::string sequence = {};  ///< whose boxes are held and packed; empty: boxes are not looked at
  std::string robot = {};     ///< name of the scenario's robot; empty: the one that there is
  motion::Tracking tracking = {};
  double path_step = 0.01;  ///< m, and 1 rad counts as 0.3 m: between two looks
  double range = 0.05;      ///< m, up to which distances are measured
  double allowance = 0.03;  ///< m, that cup and held box may press into something; the demonstrator's flips press 20 mm
  /// m, the same into packed boxes, which give way: the demonstrator's programs let boxes go 42 mm inside others.
  double packed_allowance = 0.045;
};

struct CheckResult {
  bool is_ok = true;                   ///< no finding is an error
  double duration = 0.0;               ///< s, of the program
  int looks = 0;                       ///< poses that were looked at
  std::vector<CheckFinding> findings;  ///< in the order of rows
  std::vector<CheckFinding> margins;   ///< smallest margin of each kind over the whole program
  double wall = 0.0;                   ///< s
};

/// Findings of the same kind, thing and severity together, in the order of their first rows.
[[nodiscard]] std::vector<CheckGroup> group(const std::vector<CheckFinding>& findings);

/// Moves the joints with the robot's controller and its limits, as a run does, but with nothing to touch. A row that is
/// not reached is found (Reach), and the next one is aimed at from where the arm stands.
/// Throws InputError as Simulation::prepare and robot::load_arm.
[[nodiscard]] CheckResult check_program(const model::Scenario& scenario, const motion::Program& program,
                                        const CheckOptions& options);

}  // namespace snug::runs
