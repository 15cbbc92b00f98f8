// program: turns a list of placements into a program of plain pick-and-place waypoints.
#pragma once

#include <optional>
#include <string>

#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct ProgramOptions {
  std::string scenario;
  ScenarioChanges changes;
  std::string placements;
  std::optional<std::string> sequence;  ///< required: how each box stands at the aligner
  std::optional<std::string> output;    ///< absent: stdout
};

void add_program(CLI::App& app, Action& action);
[[nodiscard]] int run_program(const ProgramOptions& options);

}  // namespace snug::app
