// PosePath: where a body is over time, from a table that another program wrote.
#include "snug/model/pose_path.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "snug/core/csv_fields.hpp"
#include "snug/model/internal/side_file.hpp"

namespace snug::model {
namespace {

using internal::to_text;

constexpr std::size_t kMostBytes = std::size_t{64} << 20;  // about 500 000 points
constexpr double kFewDigits = 1e-3;                        // of the norm of a quaternion written with few digits
constexpr double kLatestTime = 1e6;                        // s
constexpr double kFastest = 1000.0;                        // m/s and rad/s: more is a slip

enum Column { Time, X, Y, Z, Qw, Qx, Qy, Qz, Roll, Pitch, Yaw, kColumnCount };
const std::vector<std::string> kNames = {"time", "x",  "y",        "z",         "qw",     "qx",
                                         "qy",   "qz", "roll_deg", "pitch_deg", "yaw_deg"};
const std::string kExpected = "time,x,y,z,qw,qx,qy,qz or time,x,y,z,roll_deg,pitch_deg,yaw_deg, in any order";

/// The fields of a line one after the other, blanks around them left out.
class Fields {
 public:
  explicit Fields(std::string_view line) : rest_(line) {}
  std::optional<std::string_view> next() {
    if (is_done_) return std::nullopt;
    const std::size_t comma = std::min(rest_.find(','), rest_.size());
    const std::string_view field = rest_.substr(0, comma);
    is_done_ = comma == rest_.size();
    rest_.remove_prefix(is_done_ ? comma : comma + 1);
    const std::size_t first = field.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return std::string_view{};
    return field.substr(first, field.find_last_not_of(" \t\r") - first + 1);
  }

 private:
  std::string_view rest_;
  bool is_done_ = false;
};

/// Which column stands in each place.
std::vector<Column> read_columns(std::string_view line, const std::string& where) {
  std::vector<Column> columns;
  Fields fields(line);
  while (const auto field = fields.next()) {
    const auto found = std::find(kNames.begin(), kNames.end(), *field);
    if (found == kNames.end())
      throw InputError(where, "header", internal::quote(*field), kExpected + internal::nearest_hint(*field, kNames));
    const auto column = static_cast<Column>(found - kNames.begin());
    if (std::find(columns.begin(), columns.end(), column) != columns.end())
      throw InputError(where, *found, "a second time", "each column once");
    columns.push_back(column);
  }
  const auto has = [&](Column column) { return std::find(columns.begin(), columns.end(), column) != columns.end(); };
  const bool has_quaternion = has(Qw) || has(Qx) || has(Qy) || has(Qz);
  const bool has_angles = has(Roll) || has(Pitch) || has(Yaw);
  if (has_quaternion && has_angles)
    throw InputError(where, "header", "a quaternion and angles", "one of the two: " + kExpected);
  for (int i = 0; i < kColumnCount; ++i) {
    const auto column = static_cast<Column>(i);
    const bool is_needed = column <= Z || (column <= Qz ? has_quaternion || !has_angles : has_angles);
    if (is_needed && !has(column))
      throw InputError(where, kNames[static_cast<std::size_t>(i)], "no such column", kExpected);
  }
  return columns;
}

double read_number(std::string_view field, Column column, const std::string& where) {
  const std::string& name = kNames[static_cast<std::size_t>(column)];
  const double bound = column == Time ? kLatestTime
                       : column <= Z  ? internal::kFarthestPosition
                       : column <= Qz ? 1.0 + kFewDigits
                                      : 3600.0;
  const double low = column == Time ? 0.0 : -bound;
  std::string_view digits = field;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || !(value >= low && value <= bound))
    throw InputError(where, name, field.empty() ? "nothing" : internal::quote(field),
                     "a number from " + to_text(low) + " to " + to_text(bound));
  return value;
}

/// Exact for quarter turns, as yaw_deg of a scenario.
Matrix3 turn_about(int axis, double degrees) {
  double c = std::cos(degrees * std::numbers::pi / 180.0), s = std::sin(degrees * std::numbers::pi / 180.0);
  if (std::fmod(degrees, 90.0) == 0.0) c = std::round(c), s = std::round(s);
  const int i = (axis + 1) % 3, j = (axis + 2) % 3;
  Matrix3 R = Matrix3::Identity();
  R(i, i) = c, R(i, j) = -s, R(j, i) = s, R(j, j) = c;
  return R;
}

PathPoint read_point(std::string_view line, const std::vector<Column>& columns, const std::string& where) {
  std::array<double, kColumnCount> values{};
  std::size_t count = 0;
  Fields fields(line);
  while (const auto field = fields.next()) {
    if (count < columns.size()) values[columns[count]] = read_number(*field, columns[count], where);
    ++count;
  }
  if (count != columns.size())
    throw InputError(where, "", std::to_string(count) + " fields",
                     std::to_string(columns.size()) + ", as the header has");
  PathPoint point;
  point.time = values[Time];
  point.X_WB.p = Vector3(values[X], values[Y], values[Z]);
  if (std::find(columns.begin(), columns.end(), Qw) == columns.end()) {
    point.X_WB.R = turn_about(2, values[Yaw]) * turn_about(1, values[Pitch]) * turn_about(0, values[Roll]);
    return point;
  }
  const Quaternion quat(values[Qw], values[Qx], values[Qy], values[Qz]);
  if (!(std::abs(quat.norm() - 1.0) <= kFewDigits))
    throw InputError(where, "qw,qx,qy,qz", "norm " + to_text(quat.norm()), "a quaternion of norm 1");
  point.X_WB.R = quat.normalized().toRotationMatrix();
  return point;
}

void check_follows(const PathPoint& before, const PathPoint& point, const std::string& where) {
  const double dt = point.time - before.time;
  if (!(dt > 0.0))
    throw InputError(where, "time", to_text(point.time), "more than the " + to_text(before.time) + " before");
  const double speed = (point.X_WB.p - before.X_WB.p).norm() / dt;
  const double turn = log_rotation(before.X_WB.R.transpose() * point.X_WB.R).norm() / dt;
  if (!(std::max(speed, turn) <= kFastest))
    throw InputError(where, "", "a move at " + to_text(speed) + " m/s and " + to_text(turn) + " rad/s",
                     "at most " + to_text(kFastest) + " of both: metres, seconds?");
}

}  // namespace

Pose pose_at(const PosePath& path, double time) {
  const auto after = std::upper_bound(path.points.begin(), path.points.end(), time,
                                      [](double t, const PathPoint& point) { return t < point.time; });
  if (after == path.points.begin()) return path.points.front().X_WB;
  const PathPoint& from = *(after - 1);
  if (after == path.points.end() || time == from.time) return from.X_WB;
  const double share = (time - from.time) / (after->time - from.time);
  const Vector3 turn = log_rotation(from.X_WB.R.transpose() * after->X_WB.R);
  return {from.X_WB.R * exp_rotation(share * turn), from.X_WB.p + share * (after->X_WB.p - from.X_WB.p)};
}

PosePath parse_pose_path(std::string_view text, std::string_view name, const Pose& X_WF) {
  text = without_byte_order_mark(text);
  PosePath path;
  std::vector<Column> columns;
  for (int line = 1; !text.empty(); ++line) {
    const std::string where = std::string(name) + ":" + std::to_string(line);
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view row = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (row.find_first_not_of(" \t\r") == std::string_view::npos) continue;
    if (columns.empty()) {
      columns = read_columns(row, where);
      continue;
    }
    PathPoint point = read_point(row, columns, where);
    point.X_WB = X_WF * point.X_WB;
    if (!path.points.empty()) check_follows(path.points.back(), point, where);
    path.points.push_back(point);
  }
  if (path.points.empty()) throw InputError(std::string(name), "", "no points", "a header, then at least one row");
  return path;
}

PosePath load_pose_path(const std::filesystem::path& file, const Pose& X_WF) {
  return parse_pose_path(internal::read_side_file(file, kMostBytes, "a table of poses (CSV)"), file.string(), X_WF);
}

}  // namespace snug::model
