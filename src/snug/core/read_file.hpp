// read_file: a whole text file.
#pragma once

#include <filesystem>
#include <string>

namespace snug {

/// Throws InputError that names the path when it cannot be read.
[[nodiscard]] std::string read_file(const std::filesystem::path& path);

}  // namespace snug
