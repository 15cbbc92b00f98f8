// The 13-column CSV of programs: the one place where poses are rotation vectors.
#include "snug/motion/program_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/core/write_file.hpp"
#include "snug/motion/program_tracking.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::motion {
namespace {

constexpr std::size_t kColumns = 13;
constexpr std::array<const char*, kColumns> kColumnNames = {
    "x",      "y",        "z",           "rx",           "ry",        "rz",      "name",
    "vacuum", "blow-off", "conveyor cw", "conveyor ccw", "optitrack", "reserved"};
constexpr double kLargestPosition = 100.0;       // m; a cell is a few metres, so more means other units
constexpr std::size_t kMostWaypoints = 100'000;  // hours of motion
constexpr double kLargestRotation = 100.0;       // rad; far beyond any sensible rotation vector, still exact to 1e-14

constexpr const char* kInstantEnding = "behind the last '@' seconds from 0 to 7200, such as @7.512";
constexpr const char* kSwingEnding = "behind '~' a swing: two periods from 0.01 to 9.99 s, such as ~0.42+0.31";

/// Where a field stands, for messages.
struct Field {
  std::string_view text;
  std::string_view file;
  int line = 0;
  std::size_t column = 0;  ///< from 0

  [[noreturn]] void fail(std::string expected) const {
    throw InputError(fmt::format("{}:{}", file, line), fmt::format("column {} ({})", column + 1, kColumnNames[column]),
                     text.empty() ? "nothing" : fmt::format("'{}'", text), std::move(expected));
  }
};

double parse_number(const Field& field) {
  std::string_view text = field.text;
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) field.fail("a number that a double can hold");
  if (error != std::errc() || end != text.data() + text.size()) field.fail("a number");
  if (!std::isfinite(value)) field.fail("a finite number");
  return value;
}

bool parse_switch(const Field& field) {
  if (field.text == "0") return false;
  if (field.text == "1") return true;
  field.fail("0 or 1");
}

std::string_view read_name(const Field& field) {
  if (field.text.empty()) field.fail("the waypoint's name");
  if (!is_printable(field.text)) field.fail("a name without control characters");
  return field.text;
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = text.find(',');
    fields.push_back(trim(text.substr(0, comma)));
    if (comma == std::string_view::npos) return fields;
    text.remove_prefix(comma + 1);
  }
}

Waypoint parse_row(std::string_view text, std::string_view file, int line) {
  const std::vector<std::string_view> texts = split(text);
  if (texts.size() != kColumns) {
    throw InputError(fmt::format("{}:{}", file, line), "", fmt::format("{} columns", texts.size()),
                     "13: x, y, z, rx, ry, rz, name, vacuum, blow-off, conveyor cw, conveyor ccw, optitrack, reserved");
  }
  const auto field = [&](std::size_t column) { return Field{texts[column], file, line, column}; };
  std::array<double, 6> number{};
  for (std::size_t i = 0; i < 6; ++i) number[i] = parse_number(field(i));
  for (std::size_t i = 0; i < 3; ++i) {
    if (std::abs(number[i]) > kLargestPosition) field(i).fail("metres, at most 100");
  }
  for (std::size_t i = 3; i < 6; ++i) {
    if (std::abs(number[i]) > kLargestRotation) field(i).fail("radians, at most 100");
  }
  Waypoint waypoint = parse_waypoint_name(read_name(field(6)));
  if (has_malformed_swing(waypoint)) field(6).fail(kSwingEnding);
  if (has_malformed_instant(waypoint)) field(6).fail(kInstantEnding);
  waypoint.X_WE = {exp_rotation({number[3], number[4], number[5]}), {number[0], number[1], number[2]}};
  waypoint.io = {parse_switch(field(7)),  parse_switch(field(8)),  parse_switch(field(9)),
                 parse_switch(field(10)), parse_switch(field(11)), parse_switch(field(12))};
  waypoint.line = line;
  return waypoint;
}

constexpr double kGrid = 0x1p-40;  ///< rad, far above the rounding of log_rotation

Vector3 on_grid(const Vector3& r) { return (r / kGrid).array().round().matrix() * kGrid; }

bool gives(const Vector3& r, const Matrix3& R) { return exp_rotation(r) == R; }

/// Vectors of about this rotation: its logarithm, and those of the quaternion and of its negative, one of which may be
/// longer than pi, as files have them. Near pi the logarithm chooses the sign of the axis; these do not.
std::array<Vector3, 3> vectors_of(const Matrix3& R) {
  const Quaternion quat = Quaternion(R).normalized();
  const double s = quat.vec().norm();
  if (s < 1e-9) return {log_rotation(R), log_rotation(R), log_rotation(R)};  // there both are one, or a whole turn
  const Vector3 one = (2.0 * std::atan2(s, quat.w()) / s) * quat.vec();
  const Vector3 other = (-2.0 * std::atan2(s, -quat.w()) / s) * quat.vec();
  return {log_rotation(R), one, other};
}

/// The vector on the grid that gives R exactly, where there is one. Rounded to the grid, one of length pi may be
/// longer.
std::optional<Vector3> find_on_grid(const Matrix3& R) {
  for (const Vector3& start : vectors_of(R)) {
    const Vector3 grid = on_grid(start);
    if (gives(grid, R)) return grid;
  }
  return std::nullopt;
}

/// 0 stays 0: beside it are numbers that nobody would write.
double step(double value, int ulps) {
  if (value == 0.0) return 0.0;
  const double toward = ulps > 0 ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity();
  for (int i = 0; i < std::abs(ulps); ++i) value = std::nextafter(value, toward);
  return value;
}

/// One of few digits, or near `r`, that gives R exactly.
std::optional<Vector3> find_exact(const Vector3& r, const Matrix3& R) {
  for (double scale = 1.0; scale < 1e13; scale *= 10.0) {
    const Vector3 decimal = (r * scale).array().round().matrix() / scale;
    if (gives(decimal, R)) return decimal;
  }
  constexpr std::array kUlps = {0,  1, -1, 2,
                                -2, 3, -3};  // what logarithm and exponential lose together of most vectors
  for (const int x : kUlps) {
    for (const int y : kUlps) {
      for (const int z : kUlps) {
        const Vector3 near(step(r.x(), x), step(r.y(), y), step(r.z(), z));
        if (gives(near, R)) return near;
      }
    }
  }
  return std::nullopt;
}

/// A vector whose exponential is R to the last bit, where there is one. Logarithm and exponential together do not give
/// a matrix back: it is looked for on the grid of rounded(), among short decimals as people write them, then around.
Vector3 rotation_vector_of(const Matrix3& R) {
  if (const std::optional<Vector3> grid = find_on_grid(R)) return *grid;
  for (const Vector3& start : vectors_of(R)) {
    if (const std::optional<Vector3> found = find_exact(start, R)) return *found;
  }
  return log_rotation(R);
}

void check_writable(const Program& program, std::size_t row) {
  const Waypoint& waypoint = program.waypoints[row];
  const std::string name = name_of(waypoint);
  if (name.empty() || name != trim(name) || name.find(',') != std::string::npos || !is_printable(name)) {
    throw InputError(place_of(program, row), "column 7 (name)", fmt::format("'{}'", name),
                     "a name without commas, control characters and blanks at its ends");
  }
  const Waypoint read = parse_waypoint_name(name);
  if (has_malformed_swing(read) || has_malformed_instant(read)) {
    throw InputError(place_of(program, row), "column 7 (name)", fmt::format("'{}'", name),
                     has_malformed_swing(read) ? kSwingEnding : kInstantEnding);
  }
  if (!waypoint.X_WE.p.allFinite() || !waypoint.X_WE.R.allFinite()) {
    throw InputError(place_of(program, row), name, "a pose that is not finite", "a finite pose");
  }
}

}  // namespace

Program parse_program(std::string_view text, std::string_view name) {
  Program program{std::string(name), {}};
  check_utf8(text, name);
  const std::string_view whole = text;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte-order mark that spreadsheets add
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    const std::string_view row = trim(text.substr(0, end));
    const bool is_comment = row.starts_with('#');
    if (!row.empty() && !is_comment) program.waypoints.push_back(parse_row(row, name, line));
    if (program.waypoints.size() > kMostWaypoints) {
      throw InputError(fmt::format("{}:{}", name, line), "", fmt::format("more than {} waypoints", kMostWaypoints),
                       "fewer");
    }
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  if (program.waypoints.empty()) throw InputError(std::string(name), "", "no rows", "at least one waypoint");
  program.tracking = find_tracking(whole, name);
  program.robot = find_robot(whole, name);
  return program;
}

Waypoint rounded(Waypoint waypoint) {
  if (!find_on_grid(waypoint.X_WE.R)) waypoint.X_WE.R = exp_rotation(on_grid(log_rotation(waypoint.X_WE.R)));
  return waypoint;
}

Program load_program(const std::filesystem::path& path) {
  return parse_program(read_file(path, "a program file (CSV)"), path.string());
}

std::string format_program(const Program& program) {
  std::string text = format_tracking(program.tracking) + format_robot(program.robot);
  for (std::size_t row = 0; row < program.waypoints.size(); ++row) {
    check_writable(program, row);
    const Waypoint& w = program.waypoints[row];
    const Vector3 &p = w.X_WE.p, r = rotation_vector_of(w.X_WE.R);
    text += fmt::format("{}, {}, {}, {}, {}, {},{},{:d},{:d},{:d},{:d},{:d},{:d}\n", p.x(), p.y(), p.z(), r.x(), r.y(),
                        r.z(), name_of(w), w.io.vacuum, w.io.blow_off, w.io.conveyor_cw, w.io.conveyor_ccw,
                        w.io.optitrack, w.io.reserved);
  }
  return text;
}

void write_program(const Program& program, const std::filesystem::path& path) {
  write_file(path, format_program(program));
}

}  // namespace snug::motion
