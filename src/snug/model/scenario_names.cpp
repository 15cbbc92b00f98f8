// Scenario names: the scenarios that come with snug, and which file a name means.
#include "snug/model/scenario_names.hpp"

#include <algorithm>
#include <fstream>
#include <string_view>
#include <system_error>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::model {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".yaml";

bool has_bodies(const fs::path& file) {
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("bodies:")) return true;
  return false;
}

/// Pipes and devices are read as files are; only a folder is none.
bool is_readable_kind(const fs::path& path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  return fs::exists(status) && !fs::is_directory(status);
}

[[noreturn]] void refuse(const std::string& words, const fs::path& folder) {
  constexpr std::size_t kRoomForName = 60;
  const std::vector<std::string> names = list_scenarios(folder);
  const std::string got = "'" + printable(words, kRoomForName) + "': no such file";
  if (names.empty()) throw InputError("scenario", "", got, "a scenario file (YAML); none came with this snug");
  std::string expected = "a scenario file (YAML) or ";
  const std::string_view nearest = find_nearest(words, names);
  if (!nearest.empty()) {
    expected += "'" + std::string(nearest) + "'";
  } else {
    expected += "one that comes with snug:";
    for (const std::string& name : names)
      if (name.find('/') == std::string::npos) expected += " " + name;
  }
  throw InputError("scenario", "", got + " and no scenario that comes with snug", expected);
}

}  // namespace

std::vector<std::string> list_scenarios(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().extension() != kEnding || !it->is_regular_file(error) || !has_bodies(it->path())) continue;
    names.push_back(it->path().lexically_relative(folder).replace_extension().generic_string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

fs::path find_scenario_file(const std::string& words, const fs::path& folder) {
  const fs::path path(words);
  if (path.empty() || is_readable_kind(path)) return path;
  const fs::path with_ending = words + std::string(kEnding);
  if (is_readable_kind(with_ending)) return with_ending;
  if (path.is_absolute()) return path;
  if (!folder.empty()) {
    for (const fs::path& shipped : {folder.parent_path() / path, folder / path, folder / with_ending}) {
      if (is_readable_kind(shipped)) return shipped;
    }
  }
  if (path.extension() == kEnding || path.extension() == ".yml") return path;
  refuse(words, folder);
}

}  // namespace snug::model
