// completion: a script that lets a shell complete the words of `snug`, made from the parser's own list of them.
#pragma once

#include <string>
#include <vector>

#include "apps/snug/command_line/command_list.hpp"
#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

void add_completion(CLI::App& app, Action& action);

[[nodiscard]] std::string format_bash(const std::vector<Command>& commands);
[[nodiscard]] std::string format_zsh(const std::vector<Command>& commands);
[[nodiscard]] std::string format_fish(const std::vector<Command>& commands);

}  // namespace snug::app
