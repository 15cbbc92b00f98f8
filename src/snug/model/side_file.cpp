// Side files: what a scenario names beside itself, with a bound on how much of it is read.
#include "snug/model/internal/side_file.hpp"

#include <system_error>

#include "snug/core/read_file.hpp"

namespace snug::model::internal {

std::filesystem::path beside_scenario(const Value& value) {
  const std::filesystem::path named = value.name();
  return named.is_relative() ? std::filesystem::path(value.document().name).parent_path() / named : named;
}

std::filesystem::path find_side_file(const Value& value, const std::string& what) {
  const std::filesystem::path path = beside_scenario(value);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    value.fail(value.describe() + ", which is not there (looked for " + path.string() + ")",
               what + ", path relative to the scenario");
  value.document().side_files.push_back(path);
  return path;
}

void check_side_file(const std::filesystem::path& file, std::size_t most, const std::string& what) {
  check_readable(file, what, most);
}

std::string read_side_file(const std::filesystem::path& file, std::size_t most, const std::string& what) {
  return read_file(file, what, most);
}

}  // namespace snug::model::internal
