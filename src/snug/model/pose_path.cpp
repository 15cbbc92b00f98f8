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
constexpr double kSamePlace = 1e-12;                       // m and rad: rows between which a body rests
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

/// From one row to the next.
struct Chord {
  double dt = 0.0;                   ///< s
  Vector3 linear = Vector3::Zero();  ///< m/s, mean, in W
  Vector3 turn = Vector3::Zero();    ///< rad, rotation vector, the same in the frames of both rows
  [[nodiscard]] bool rests() const { return linear.norm() * dt <= kSamePlace && turn.norm() <= kSamePlace; }
};

Chord chord_of(const PathPoint& from, const PathPoint& to) {
  const double dt = to.time - from.time;
  return {dt, (to.X_WB.p - from.X_WB.p) / dt, log_rotation(from.X_WB.R.transpose() * to.X_WB.R)};
}

/// Rate of the rotation vector for an angular velocity in the turned frame: the inverse right Jacobian of exp
/// (Chirikjian 2011, section 10.7).
Vector3 rate_of_vector(const Vector3& turn, const Vector3& w_B) {
  const double angle = turn.norm();
  const double half = 0.5 * angle;
  const double c = angle > 1e-4 ? (1.0 - half / std::tan(half)) / (angle * angle) : 1.0 / 12.0;
  return w_B + 0.5 * turn.cross(w_B) + c * turn.cross(turn.cross(w_B));
}

/// Angular velocity in the turned frame for a rate of the rotation vector.
Vector3 velocity_of_vector(const Vector3& turn, const Vector3& rate) {
  const double angle = turn.norm(), square = angle * angle;
  const bool is_large = angle > 1e-4;
  const double a = is_large ? (1.0 - std::cos(angle)) / square : 0.5;
  const double b = is_large ? (angle - std::sin(angle)) / (square * angle) : 1.0 / 6.0;
  return rate - a * turn.cross(rate) + b * turn.cross(turn.cross(rate));
}

/// Of a parabola at the middle of two chords, or at the free end of the first of them.
Vector3 slope_between(const Vector3& before, const Vector3& after, double dt_before, double dt_after) {
  return (dt_after * before + dt_before * after) / (dt_before + dt_after);
}
Vector3 slope_at_end(const Vector3& first, const Vector3& second, double dt_first, double dt_second) {
  const Vector3 slope = first + (first - second) * dt_first / (dt_first + dt_second);
  return slope.dot(first) > 0.0 ? slope : Vector3(Vector3::Zero());
}

/// Velocity at a row: linear in W, angular in the frame of the row.
Twist velocity_at(const std::vector<PathPoint>& points, std::size_t i) {
  const bool is_first = i == 0, is_last = i + 1 == points.size();
  if (points.size() == 1) return {};
  if (!is_first && !is_last) {
    const Chord before = chord_of(points[i - 1], points[i]), after = chord_of(points[i], points[i + 1]);
    if (before.rests() || after.rests()) return {};
    return {slope_between(before.linear, after.linear, before.dt, after.dt),
            slope_between(before.turn / before.dt, after.turn / after.dt, before.dt, after.dt)};
  }
  const Chord near = is_first ? chord_of(points[0], points[1]) : chord_of(points[i - 1], points[i]);
  if (near.rests()) return {};
  if (points.size() == 2) return {near.linear, near.turn / near.dt};
  const Chord far = is_first ? chord_of(points[1], points[2]) : chord_of(points[i - 2], points[i - 1]);
  return {slope_at_end(near.linear, far.linear, near.dt, far.dt),
          slope_at_end(near.turn / near.dt, far.turn / far.dt, near.dt, far.dt)};
}

/// Cubic Hermite polynomial from 0 to `whole` within `dt`, with these slopes: value and slope at the share s of dt.
struct Hermite {
  Vector3 value, slope;
};
Hermite hermite(const Vector3& whole, const Vector3& slope_0, const Vector3& slope_1, double dt, double s) {
  const double t = 1.0 - s;
  return {s * s * (3.0 - 2.0 * s) * whole + dt * s * t * (t * slope_0 - s * slope_1),
          6.0 * s * t / dt * whole + t * (1.0 - 3.0 * s) * slope_0 + s * (3.0 * s - 2.0) * slope_1};
}

struct PathMotion {
  Pose X_WB;
  Twist V_WB;
};

PathMotion motion_at(const PosePath& path, double time) {
  const std::vector<PathPoint>& points = path.points;
  const auto after = std::lower_bound(points.begin(), points.end(), time,
                                      [](const PathPoint& point, double t) { return point.time < t; });
  if (after == points.begin()) return {points.front().X_WB, {}};
  if (after == points.end()) return {points.back().X_WB, {}};
  const auto to = static_cast<std::size_t>(after - points.begin());
  const PathPoint &A = points[to - 1], &E = points[to];
  const Chord chord = chord_of(A, E);
  if (chord.rests()) return {time == E.time ? E.X_WB : A.X_WB, {}};
  const double s = (time - A.time) / chord.dt;
  const Twist V_A = velocity_at(points, to - 1), V_E = velocity_at(points, to);
  const Hermite place = hermite(E.X_WB.p - A.X_WB.p, V_A.linear, V_E.linear, chord.dt, s);
  const Hermite turn = hermite(chord.turn, V_A.angular, rate_of_vector(chord.turn, V_E.angular), chord.dt, s);
  const Pose X_WB = time == E.time ? E.X_WB : Pose{A.X_WB.R * exp_rotation(turn.value), A.X_WB.p + place.value};
  return {X_WB, {place.slope, X_WB.R * velocity_of_vector(turn.value, turn.slope)}};
}

}  // namespace

Pose pose_at(const PosePath& path, double time) { return motion_at(path, time).X_WB; }

Twist twist_at(const PosePath& path, double time) { return motion_at(path, time).V_WB; }

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
