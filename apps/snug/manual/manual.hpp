// manual: the manual page, made from what `--help` of each verb says.
#pragma once

#include <string>
#include <vector>

#include "apps/snug/command_line/command_list.hpp"
#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

void add_manual(CLI::App& app, Action& action);

/// In the language of man(7).
[[nodiscard]] std::string format_manual(const std::vector<Command>& commands, const std::string& version);

}  // namespace snug::app
