// What the readers of measurements share: cells, names, times.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "snug/archive_import/internal/readers.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/core/units.hpp"

namespace snug::archive_import::internal {
std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

double read_cell(std::string_view cell, const std::string& where, const std::string& column) {
  cell = trim(cell);
  if (cell.empty() || cell == "nan" || cell == "NaN" || cell == "-nan") return kNaN;
  double value = 0.0;
  const char* begin = cell.data() + (cell.front() == '+' ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
  if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
    throw InputError(where, printable(column, 60), "'" + printable(cell, 40) + "'", "a number, or nothing");
  return value;
}

std::string body_name(std::string_view body, const Hints& hints) {
  const auto renamed = hints.names.find(std::string(body));
  std::string name(renamed == hints.names.end() ? body : std::string_view(renamed->second));
  for (char& c : name)
    if (c == '/' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '_';
  if (name.empty() || name == "." || name == "..") name = "_" + name;
  return record::archive_name(name);
}

Quaternion read_quaternion(double w, double x, double y, double z, const std::string& where,
                           const std::string& column) {
  const Quaternion quat(w, x, y, z);
  if (!(std::abs(quat.norm() - 1.0) <= kUnitTolerance))
    throw InputError(where, printable(column, 60), fmt::format("a quaternion of length {:.4g}", quat.norm()),
                     "a rotation: length 1");
  return quat.normalized();
}

std::string begin_at_zero(record::ArchiveRecording& recording) {
  std::vector<double>* const sources[] = {&recording.motion_capture.times, &recording.force_torque.times,
                                          &recording.robot.times};
  double first = std::numeric_limits<double>::infinity();
  for (const std::vector<double>* times : sources)
    if (!times->empty()) first = std::min(first, times->front());
  first = std::floor(first);
  if (!std::isfinite(first) || first == 0.0) return "";
  for (std::vector<double>* times : sources)
    for (double& time : *times) time -= first;
  return fmt::format("{:.0f} s", first);
}

void require_two_rows(std::size_t rows, const std::string& name) {
  if (rows >= 2) return;
  throw InputError(name, "", rows == 0 ? "no row of numbers" : "one row of numbers", "two or more: a recording");
}

double rate_of(const std::vector<double>& times) {
  return static_cast<double>(times.size() - 1) / (times.back() - times.front());
}

void require_growth(const std::vector<double>& times, double next, const std::string& where) {
  if (!std::isfinite(next)) throw InputError(where, "time", "nothing", "a time in s");
  if (!times.empty() && !(next > times.back()))
    throw InputError(where, "time", fmt::format("{} s after {} s", next, times.back()), "times that grow");
}

void order_bodies(record::MotionCaptureLog& log, const std::string& where) {
  std::sort(log.bodies.begin(), log.bodies.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  for (std::size_t i = 1; i < log.bodies.size(); ++i)
    if (log.bodies[i].name == log.bodies[i - 1].name)
      throw InputError(where, "", "two bodies '" + printable(log.bodies[i].name, 60) + "'",
                       "each name once; --rename gives another");
}

void turn_wrenches(record::ArchiveRecording& recording, const Hints& hints) {
  if (!hints.turns_wrench) return;
  for (Wrench& wrench : recording.force_torque.wrenches) {
    wrench.force = -wrench.force;
    wrench.torque = -wrench.torque;
  }
}

}  // namespace snug::archive_import::internal
