// read_file: a whole text file.
#include "snug/core/read_file.hpp"

#include <fstream>
#include <sstream>
#include <system_error>

#include "snug/core/input_error.hpp"

namespace snug {

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error) || !file || !(text << file.rdbuf()))
    throw InputError(path.string(), "", "a file that cannot be read", "a text file that is not empty");
  return text.str();
}

}  // namespace snug
