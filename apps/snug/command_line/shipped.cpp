// shipped: the files that come with the program, wherever it was put.
#include "apps/snug/command_line/shipped.hpp"

#include <array>
#include <system_error>

#include "snug/core/input_error.hpp"
#include "snug/model/scenario_names.hpp"

namespace snug::app {
namespace {

namespace fs = std::filesystem;

/// Empty when the program has been separated from its files.
fs::path look_for_folder() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) return {};
  const std::array<fs::path, 2> folders = {program.parent_path() / "share/snug",
                                           program.parent_path().parent_path() / "share/snug"};
  for (const fs::path& folder : folders) {
    // Through links: beside a program that was just built, scenarios/ is one.
    const fs::path scenarios = fs::canonical(folder / "scenarios", error);
    if (!error) return scenarios.parent_path();
  }
  return {};
}

}  // namespace

fs::path shipped_folder() {
  const fs::path folder = look_for_folder();
  if (folder.empty())
    throw InputError("snug", "scenarios", "a program without the files that come with it",
                     "share/snug/scenarios beside it or beside the folder it is in");
  return folder;
}

fs::path agent_script() { return shipped_folder() / "python" / "snug" / "agent.py"; }

std::string find_shipped(const std::string& file) {
  std::error_code error;
  const fs::path path(file);
  if (path.empty() || path.is_absolute() || fs::exists(path, error)) return file;
  const fs::path folder = look_for_folder();
  if (folder.empty() || !fs::is_regular_file(folder / path, error)) return file;
  return (folder / path).string();
}

std::string find_scenario(const std::string& words) {
  const fs::path folder = look_for_folder();
  return model::find_scenario_file(words, folder.empty() ? fs::path{} : folder / "scenarios").string();
}

}  // namespace snug::app
