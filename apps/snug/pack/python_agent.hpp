// Python agents: `--agent module:Class` as somebody to ask: an interpreter that runs beside, spoken to in lines of
// JSON.
#pragma once

#include <string>

#include "snug/packing/agent.hpp"

namespace snug::app {

/// "module:Class": names of built-in agents have no colon.
[[nodiscard]] bool is_python_agent(const std::string& words);
/// Starts the interpreter, SNUG_PYTHON or /usr/bin/python3, in the folder one is in, whose modules it finds. It ends
/// with the last copy of what is returned. Throws InputError when module or class cannot be had; asking throws
/// packing::AgentError when the interpreter ends.
[[nodiscard]] packing::Ask start_python_agent(const std::string& words);

}  // namespace snug::app
