// Words of a command, as they are written on one line.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace snug::frames::internal {

/// Split at blanks. '...' keeps everything, "..." all but \" and \\, and outside of quotes a backslash keeps the next
/// character. Throws InputError for an open quote, a backslash at the end, and words by which only a shell does
/// something (|, >, &&, $(...) and the like).
[[nodiscard]] std::vector<std::string> split_command(const std::string& text);

/// With {frame}, {look} and {time} as they are at that look.
[[nodiscard]] std::vector<std::string> fill_in(std::vector<std::string> words, const std::string& frame,
                                               std::uint64_t look, double time);

/// The file that is run for a command's first word, or empty: no such program.
[[nodiscard]] std::string find_program(const std::string& word);

}  // namespace snug::frames::internal
