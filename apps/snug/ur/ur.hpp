// ur: what a UR controller says of itself, and whether it fits a scenario's robot. Nothing is moved.
#pragma once

#include <string>

#include "apps/snug/command_line/scenario_options.hpp"

namespace snug::app {

struct UrCheckOptions {
  std::string host;
  std::string scenario = "scenarios/box-demonstrator.yaml";
  ScenarioChanges changes;
  int port_offset = 0;
  double patience = 5.0;
  double tolerance_mm = 1.0;
  bool json = false;
};

void add_ur(CLI::App& app, Action& action);
/// kRunFailed: something does not fit. Throws InputError where no controller answers.
[[nodiscard]] int run_ur_check(const UrCheckOptions& options);

}  // namespace snug::app
