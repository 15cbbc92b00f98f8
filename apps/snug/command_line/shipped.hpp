// shipped: the files that come with the program, wherever it was put.
#pragma once

#include <filesystem>
#include <string>

namespace snug::app {

/// The folder that holds scenarios/: beside the program as it was built, or in share/snug of where it is installed.
/// Throws InputError when there is none.
[[nodiscard]] std::filesystem::path shipped_folder();

/// What Python agents are run by.
[[nodiscard]] std::filesystem::path agent_script();

/// `file` itself where there is one; else the shipped file of that name, as in `snug simulate scenarios/drop.yaml` from
/// any folder; else `file`, for the reader to complain about.
[[nodiscard]] std::string find_shipped(const std::string& file);

/// Which file a SCENARIO on the command line means: a file, or the name of a shipped one such as `box-demonstrator`.
/// Throws InputError with the nearest name for a name that is neither.
[[nodiscard]] std::string find_scenario(const std::string& words);

}  // namespace snug::app
