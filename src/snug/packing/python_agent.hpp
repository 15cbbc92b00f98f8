// Python agents: `--agent module:Class` as somebody to ask: an interpreter that runs beside, spoken to in lines of
// JSON.
#pragma once

#include <filesystem>
#include <string>

#include "snug/packing/agent.hpp"

namespace snug::packing {

/// "module:Class": names of built-in agents have no colon.
[[nodiscard]] bool is_python_agent(const std::string& words);
/// Starts the interpreter, SNUG_PYTHON or /usr/bin/python3, in the folder one is in, whose modules it finds. It ends
/// with the last copy of what is returned. `script`: python/snug/agent.py of the project. Throws InputError when module
/// or class cannot be had; asking throws packing::AgentError when the interpreter ends.
[[nodiscard]] Ask start_python_agent(const std::string& words, const std::filesystem::path& script);

}  // namespace snug::packing
