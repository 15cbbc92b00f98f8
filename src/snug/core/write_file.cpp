// write_file: a whole file or none.
#include "snug/core/write_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <system_error>

#include "snug/core/input_error.hpp"

namespace snug {

void write_file(const std::filesystem::path& path, std::string_view bytes) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(path.string(), "", why, "a file that can be written");
  };
  std::error_code error;
  if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) {
    refuse("something that is not a regular file");
  }
  const std::filesystem::path beside = path.string() + ".part" + std::to_string(::getpid());
  std::FILE* file = std::fopen(beside.c_str(), "wb");
  if (file == nullptr) refuse(std::strerror(errno));
  const bool is_written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  const bool is_closed = std::fclose(file) == 0;
  if (is_written && is_closed) std::filesystem::rename(beside, path, error);
  if (is_written && is_closed && !error) return;
  const std::string why = error ? error.message() : std::strerror(errno);
  std::filesystem::remove(beside, error);
  refuse(why);
}

}  // namespace snug
