// The 13-column CSV of programs: the one place where poses are rotation vectors.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "snug/motion/waypoint.hpp"

namespace snug::motion {

/// Reads rows x, y, z [m], rotation vector [rad, any length below 100], name, six switches (0 or 1); no header.
/// Lines that begin with # are comments; some say how it is tracked, and by which robot (program_tracking.hpp). Blank
/// lines, CRLF, spaces around fields and a missing last newline are fine. Throws InputError with file:line and column
/// for anything else, and for a file without rows.
[[nodiscard]] Program load_program(const std::filesystem::path& path);
/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Program parse_program(std::string_view text, std::string_view name);

/// The CSV text, numbers in the shortest form that reads back exactly. Poses that were read from a file or are
/// rounded() come back to the last bit, others to the rounding of the exponential (1e-15 in each entry of the matrix).
/// Throws InputError for a name that the format cannot carry (empty, with a comma, a control character or blank ends)
/// and for a pose that is not finite.
[[nodiscard]] std::string format_program(const Program& program);
/// Writes beside `path`, then renames, so that a file of that name is always whole. Throws InputError if it cannot.
void write_program(const Program& program, const std::filesystem::path& path);

/// The waypoint as its file will give it back to the last bit: rotation vector in steps of 2^-40 rad, without digits
/// that rounding alone has made. Rounding it again changes nothing.
[[nodiscard]] Waypoint rounded(Waypoint waypoint);

}  // namespace snug::motion
