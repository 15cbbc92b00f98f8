// list_commands: verbs and options as the parser knows them.
#pragma once

#include "apps/snug/command_line/verb.hpp"
#include "snug/commands/command.hpp"

namespace snug::app {

[[nodiscard]] commands::CommandList list_commands(CLI::App& app);

}  // namespace snug::app
