// Manual: the manual page, made from what `--help` of each verb says.
#pragma once

#include "snug/commands/command.hpp"

namespace snug::commands {

/// In the language of man(7). `version`: of the program.
[[nodiscard]] std::string format_manual(const CommandList& commands, const std::string& version);

}  // namespace snug::commands
