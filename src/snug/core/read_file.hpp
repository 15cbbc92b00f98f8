// read_file: a whole text file, if it is one of a sensible size.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace snug {

inline constexpr std::size_t kLargestText = std::size_t{64} << 20U;

/// The bytes of a regular file of at most `most` bytes. Throws InputError for anything else: what does not exist, a
/// folder, a pipe or device (which might never end), a file that is larger. `expected`: what the file should be, for
/// the message.
[[nodiscard]] std::string read_file(const std::filesystem::path& path, const std::string& expected,
                                    std::size_t most = kLargestText);

/// Throws as read_file would, without reading: for libraries that open files by name.
void check_readable(const std::filesystem::path& path, const std::string& expected, std::size_t most);

}  // namespace snug
