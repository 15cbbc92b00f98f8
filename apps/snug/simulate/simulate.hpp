// simulate: runs a scenario, with or without a program, and says what became of every box.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "snug/model/scenario.hpp"
#include "snug/runs/run.hpp"

namespace snug::app {

/// The words of `snug simulate`. An absent option leaves the choice to the scenario or to the cell.
struct SimulateOptions {
  std::string scenario;
  ScenarioChanges changes;
  std::optional<std::string> program;
  std::optional<std::string> sequence;
  std::optional<double> until;  ///< s
  PhysicsWords physics;
  MotionWords motion;
  std::optional<std::string> robot;   ///< name of the scenario's robot
  std::string corrections = "none";   ///< none, or the name of a correction layer of the scenario
  std::optional<std::string> record;  ///< HDF5 file to write
  std::optional<std::string> csv;     ///< table to write
  std::optional<std::string> resume;  ///< recording to go on from
  std::optional<double> resume_at;    ///< s, instant of it
  std::optional<int> monte_carlo;     ///< run this many times in cells drawn from the scenario's uncertainty
  std::optional<int> draw;            ///< the run of this number, from 1, of those
  std::optional<int> threads;         ///< absent: all cores
  bool json = false;
};

/// What both `simulate` and `view --live` have: the program and the physics.
void add_program_options(const Verb& verb, SimulateOptions& options);
void add_physics_options(const Verb& verb, SimulateOptions& options);

/// The scenario that the options name, with what they change in it.
[[nodiscard]] model::Scenario load_with_overrides(const SimulateOptions& options);
[[nodiscard]] runs::RunOptions make_run_options(const SimulateOptions& options, const model::Scenario& scenario);

/// What both read.
[[nodiscard]] NamedFiles files_of(const SimulateOptions& options, const model::Scenario& scenario);

}  // namespace snug::app
