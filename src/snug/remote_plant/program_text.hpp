// What became of a program in a simulator elsewhere, as text: a table for people, JSON for programs.
#pragma once

#include "snug/remote_plant/program_client.hpp"

namespace snug::remote_plant {

/// Where the simulator's objects are in the end, and how long it took.
[[nodiscard]] std::string format_table(const ProgramClientResult& result);
[[nodiscard]] std::string format_json(const ProgramClientResult& result);

}  // namespace snug::remote_plant
