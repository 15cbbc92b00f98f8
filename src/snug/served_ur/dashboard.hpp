// answer_dashboard: what the dashboard answers to a line, and what the line does.
#pragma once

#include <string>
#include <string_view>

#include "snug/served_ur/controller.hpp"

namespace snug::served_ur {

struct DashboardAnswer {
  std::string line;          ///< without its end
  bool is_last = false;      ///< the connection is to be closed
  bool is_shutdown = false;  ///< the controller is to be shut down
};

[[nodiscard]] std::string dashboard_greeting();
/// `line` without its end.
[[nodiscard]] DashboardAnswer answer_dashboard(std::string_view line, Controller& controller);

}  // namespace snug::served_ur
