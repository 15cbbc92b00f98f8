// check: whether the robot can do a program, and where it can stand at all, before anything moves.
#pragma once

#include <optional>
#include <string>

#include "apps/snug/command_line/program_motion.hpp"
#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct CheckOptions {
  std::string scenario;
  ScenarioChanges changes;
  std::string program;  ///< empty with `maps_reach`
  bool maps_reach = false;
  std::optional<std::string> sequence;
  std::optional<std::string> robot;
  MotionWords motion;
  std::string corrections = "none";
  bool json = false;
};

void add_check(CLI::App& app, Action& action);
[[nodiscard]] int run_check(const CheckOptions& options);

}  // namespace snug::app
