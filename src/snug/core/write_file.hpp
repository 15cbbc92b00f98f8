// write_file: a whole file or none.
#pragma once

#include <filesystem>
#include <string_view>

namespace snug {

/// Writes beside `path` and renames, so that a file at `path` is always whole. Throws InputError when it cannot.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace snug
