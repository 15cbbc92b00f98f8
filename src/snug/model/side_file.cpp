// Side files: what a scenario names beside itself, with a bound on how much of it is read.
#include "snug/model/internal/side_file.hpp"

#include <fstream>
#include <sstream>
#include <system_error>

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
  return path;
}

void check_side_file(const std::filesystem::path& file, std::size_t most, const std::string& what) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw InputError(file.string(), "", "no readable file", what);
  const auto size = std::filesystem::file_size(file, error);
  if (error || size > most)
    throw InputError(file.string(), "", error ? error.message() : std::to_string(size) + " bytes",
                     what + " of at most " + std::to_string(most) + " bytes");
}

std::string read_side_file(const std::filesystem::path& file, std::size_t most, const std::string& what) {
  check_side_file(file, most, what);
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw InputError(file.string(), "", "a file that is empty or cannot be read", what);
  return std::move(text).str();
}

}  // namespace snug::model::internal
