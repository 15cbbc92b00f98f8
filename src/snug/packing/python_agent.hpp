// Python agents: `--agent module:Class` as somebody to ask: an interpreter that runs beside, spoken to in lines of
// JSON.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "snug/packing/agent.hpp"

namespace snug::packing {

/// How long a program that was asked may take.
struct AgentLimits {
  double patience = 600.0;                    ///< s, to start, and for each answer
  std::function<bool()> is_interrupted = {};  ///< asked ten times a second: the user ends the program
};

/// "module:Class": names of built-in agents have no colon.
[[nodiscard]] bool is_python_agent(const std::string& words);
/// Starts the interpreter, SNUG_PYTHON or /usr/bin/python3, in the folder one is in, whose modules it finds. It ends
/// with the last copy of what is returned, also when it hangs. `script`: python/snug/agent.py of the project. Throws
/// InputError when module or class cannot be had; asking throws AgentError when the interpreter ends, does not answer
/// in time, or the program is interrupted meanwhile.
[[nodiscard]] Ask start_python_agent(const std::string& words, const std::filesystem::path& script,
                                     const AgentLimits& limits = {});

}  // namespace snug::packing
