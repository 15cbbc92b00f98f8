// ReportedAgent: whose result a scenario reports, taken apart: a name, and in brackets behind it what that is.
#pragma once

#include <string>
#include <string_view>

namespace snug::model {

struct ReportedAgent {
  std::string name;   ///< "I.AM."
  std::string about;  ///< "the report's robot", or empty
};

/// "NAME (ABOUT)" or "NAME".
[[nodiscard]] inline ReportedAgent split_agent(std::string_view agent) {
  const std::size_t at = agent.find(" (");
  if (at == std::string_view::npos || at == 0 || !agent.ends_with(')')) return {std::string(agent), ""};
  return {std::string(agent.substr(0, at)), std::string(agent.substr(at + 2, agent.size() - at - 3))};
}

}  // namespace snug::model
