// Waypoint, Program: where the tool goes and what it switches, read from and written to the 13-column CSV.
#include "snug/motion/waypoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/core/write_file.hpp"
#include "snug/motion/program_tempo.hpp"

namespace snug::motion {
namespace {

constexpr std::size_t kColumns = 13;
constexpr std::array<const char*, kColumns> kColumnNames = {
    "x",      "y",        "z",           "rx",           "ry",        "rz",      "name",
    "vacuum", "blow-off", "conveyor cw", "conveyor ccw", "optitrack", "reserved"};
constexpr double kLargestPosition = 100.0;       // m; a cell is a few metres, so more means other units
constexpr std::size_t kMostWaypoints = 100'000;  // hours of motion
constexpr double kLargestRotation = 100.0;       // rad; far beyond any sensible rotation vector, still exact to 1e-14

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

std::string parse_name(const Field& field) {
  if (field.text.empty()) field.fail("the waypoint's name");
  if (!is_printable(field.text)) field.fail("a name without control characters");
  return std::string(field.text);
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
  const Vector3 rotation(number[3], number[4], number[5]);
  for (std::size_t i = 3; i < 6; ++i) {
    if (std::abs(number[i]) > kLargestRotation) field(i).fail("radians, at most 100");
  }
  Waypoint waypoint;
  waypoint.X_WE = {exp_rotation(rotation), Vector3(number[0], number[1], number[2])};
  waypoint.name = parse_name(field(6));
  waypoint.io = {parse_switch(field(7)),  parse_switch(field(8)),  parse_switch(field(9)),
                 parse_switch(field(10)), parse_switch(field(11)), parse_switch(field(12))};
  waypoint.line = line;
  return waypoint;
}

constexpr double kGrid = 0x1p-40;  ///< rad, far above the rounding of log_rotation

Vector3 on_grid(const Vector3& r) { return (r / kGrid).array().round().matrix() * kGrid; }

/// Logarithm and exponential together do not give a matrix back to the last bit. Where a vector on the grid does, it is
/// that one.
Vector3 rotation_vector(const Matrix3& R) {
  const Vector3 r = log_rotation(R), rounded = on_grid(r);
  return exp_rotation(rounded) == R ? rounded : r;
}

void check_writable(const Program& program, std::size_t row) {
  const Waypoint& waypoint = program.waypoints[row];
  const std::string& name = waypoint.name;
  if (name.empty() || name != trim(name) || name.find(',') != std::string::npos || !is_printable(name)) {
    throw InputError(place_of(program, row), "column 7 (name)", fmt::format("'{}'", name),
                     "a name without commas, control characters and blanks at its ends");
  }
  if (!waypoint.X_WE.p.allFinite() || !waypoint.X_WE.R.allFinite()) {
    throw InputError(place_of(program, row), name, "a pose that is not finite", "a finite pose");
  }
}

}  // namespace

std::string place_of(const Program& program, std::size_t row) {
  const int line = program.waypoints[row].line;
  return line > 0 ? fmt::format("{}:{}", program.name, line) : fmt::format("{} row {}", program.name, row + 1);
}

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
  program.tempo = find_tempo(whole, name);
  return program;
}

Program load_program(const std::filesystem::path& path) {
  return parse_program(read_file(path, "a program file (CSV)"), path.string());
}

std::string format_program(const Program& program) {
  std::string text = program.tempo ? format_tempo(*program.tempo) : std::string();
  for (std::size_t row = 0; row < program.waypoints.size(); ++row) {
    check_writable(program, row);
    const Waypoint& w = program.waypoints[row];
    const Vector3 r = rotation_vector(w.X_WE.R);
    const Vector3& p = w.X_WE.p;
    text += fmt::format("{}, {}, {}, {}, {}, {},{},{:d},{:d},{:d},{:d},{:d},{:d}\n", p.x(), p.y(), p.z(), r.x(), r.y(),
                        r.z(), w.name, w.io.vacuum, w.io.blow_off, w.io.conveyor_cw, w.io.conveyor_ccw, w.io.optitrack,
                        w.io.reserved);
  }
  return text;
}

Waypoint as_written(const Waypoint& row) {
  constexpr int kNudges = 16;
  Waypoint written = row;
  const Vector3 r = log_rotation(row.X_WE.R);
  // Within rounding of half a turn a rotation vector may come back with the other sign: then a little less of a turn.
  for (int nudge = 0; nudge < kNudges; ++nudge) {
    written.X_WE.R = exp_rotation(on_grid((1.0 - kGrid * nudge) * r));
    if (exp_rotation(rotation_vector(written.X_WE.R)) == written.X_WE.R) break;
  }
  return written;
}

void write_program(const Program& program, const std::filesystem::path& path) {
  write_file(path, format_program(program));
}

}  // namespace snug::motion
