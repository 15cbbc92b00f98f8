// Completion: a script that lets a shell complete the words of `snug`, made from the list of them.
#pragma once

#include "snug/commands/command.hpp"

namespace snug::commands {

[[nodiscard]] std::string format_bash_completion(const CommandList& commands);
[[nodiscard]] std::string format_zsh_completion(const CommandList& commands);
[[nodiscard]] std::string format_fish_completion(const CommandList& commands);

}  // namespace snug::commands
