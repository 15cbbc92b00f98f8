// plan: one decision of a session once more, from the belief that it was made on.
#pragma once

#include <optional>
#include <string>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct PlanOptions {
  std::string belief;
  std::optional<std::string> item;  ///< absent: the one that was decided on
  std::optional<double> decision_time;
  std::optional<int> threads;  ///< absent: all cores
  bool json = false;
};

void add_plan(CLI::App& app, Action& action);
/// Throws InputError for input that cannot be used.
[[nodiscard]] int run_plan(const PlanOptions& options);

}  // namespace snug::app
