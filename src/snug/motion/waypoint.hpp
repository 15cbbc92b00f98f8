// Waypoint, Program: where the tool goes and what it switches, read from and written to the 13-column CSV.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::motion {

/// The six switches of a row. They act when the tool departs toward the row, not when it arrives.
struct IO {
  bool vacuum = false;
  bool blow_off = false;
  bool conveyor_cw = false;
  bool conveyor_ccw = false;
  bool optitrack = false;
  bool reserved = false;
  bool operator==(const IO&) const = default;
};

struct Waypoint {
  Pose X_WE;         ///< tool frame E (gripper end, z toward the package), m
  std::string name;  ///< its beginning chooses the limits (find_limits)
  IO io;
  int line = 0;  ///< in the file it was read from, from 1; 0: made by the program itself
  bool operator==(const Waypoint&) const = default;
};

struct Program {
  std::string name;  ///< file or label, for messages
  std::vector<Waypoint> waypoints;
  /// Fraction of the speeds with which it was packed to be done (FastSettings::tempo); none: with the lag.
  std::optional<double> tempo = std::nullopt;
  bool operator==(const Program&) const = default;
};

/// "file:line" of a waypoint, or "file row N" (from 1) for one that was not read from a file.
[[nodiscard]] std::string place_of(const Program& program, std::size_t row);

/// Reads rows x, y, z [m], rotation vector [rad, any length below 100], name, six switches (0 or 1); no header.
/// Lines that begin with # are comments; one may say the tempo (program_tempo.hpp). Blank lines, CRLF, spaces around
/// fields and a missing last newline are fine. Throws InputError with file:line and
/// column for anything else, and for a file without rows.
[[nodiscard]] Program load_program(const std::filesystem::path& path);
/// The same from text; `name` stands for the file in messages.
[[nodiscard]] Program parse_program(std::string_view text, std::string_view name);

/// The CSV text: rotation vectors canonical (length in [0, pi]), numbers in the shortest form that reads back exactly.
/// Throws InputError for a name that the format cannot carry (empty, with a comma, a control character or blank ends)
/// and for a pose that is not finite.
[[nodiscard]] std::string format_program(const Program& program);
/// The row, turned by less than 5e-11 rad, so that it reads back from a file exactly as it is: what is done with a
/// program before it is written is then what the written one does. Numbers always read back, but the matrix of a
/// rotation vector need not have that rotation vector.
[[nodiscard]] Waypoint as_written(const Waypoint& row);
/// Writes beside `path`, then renames, so that a file of that name is always whole. Throws InputError if it cannot.
void write_program(const Program& program, const std::filesystem::path& path);

}  // namespace snug::motion
