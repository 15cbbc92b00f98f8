// ShakeProfile: what a container with its load is driven with: accelerations and tilts over time.
#include "snug/runs/shake_profile.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"

namespace snug::runs {
namespace {

constexpr double kGravity = 9.81;    ///< m/s^2
constexpr double kRest = 0.6;        ///< s, behind each motion: what it set going comes to rest
constexpr double kLongest = 3600.0;  ///< s

struct Direction {
  const char* name;
  Vector3 axis;
};

const std::array<Direction, 4>& sides() {
  static const std::array<Direction, 4> kSides{Direction{"+x", Vector3::UnitX()}, Direction{"-x", -Vector3::UnitX()},
                                               Direction{"+y", Vector3::UnitY()}, Direction{"-y", -Vector3::UnitY()}};
  return kSides;
}

/// Up to `acceleration` in `ramp`, held, and down again; then at rest.
void append_pulse(ShakeMotion& motion, const Vector3& acceleration, double ramp, double hold, double rest) {
  double time = motion.duration();
  if (motion.samples.empty()) motion.samples.emplace_back();
  const auto add = [&](double seconds, const Vector3& value) {
    time += seconds;
    motion.samples.push_back({time, value});
  };
  add(ramp, acceleration);
  add(hold, acceleration);
  add(ramp, Vector3::Zero());
  if (rest > 0.0) add(rest, Vector3::Zero());
}

ShakeMotion make_belt(const Direction& side) {
  ShakeMotion motion{fmt::format("belt along {}", side.name), {}};
  append_pulse(motion, 2.0 * side.axis, 0.02, 0.23, 0.4);
  append_pulse(motion, -2.0 * side.axis, 0.02, 0.23, 0.4);
  append_pulse(motion, 2.0 * side.axis, 0.02, 0.23, 0.4);
  append_pulse(motion, -5.0 * side.axis, 0.02, 0.08, kRest);
  return motion;
}

ShakeMotion make_pulse(const std::string& name, const Vector3& acceleration, double ramp, double hold) {
  ShakeMotion motion{name, {}};
  append_pulse(motion, acceleration, ramp, hold, kRest);
  return motion;
}

/// The load is pushed against the acceleration: a vehicle that brakes accelerates backward.
std::vector<ShakeMotion> make_truck(const Vector3& size) {
  const Vector3 forward = size.x() >= size.y() ? Vector3::UnitX() : Vector3::UnitY();
  const Vector3 left = Vector3::UnitZ().cross(forward);
  return {make_pulse("brake with 0.8 g", -0.8 * kGravity * forward, 0.1, 1.0),
          make_pulse("start with 0.5 g", 0.5 * kGravity * forward, 0.1, 1.0),
          make_pulse("curve to the left with 0.5 g", 0.5 * kGravity * left, 0.1, 1.0),
          make_pulse("curve to the right with 0.5 g", -0.5 * kGravity * left, 0.1, 1.0)};
}

ShakeMotion make_tilt(const Direction& side, double level) {
  const double angle = std::atan(level);
  // Toward +x: about +y.
  const double roll = -angle * side.axis.y(), pitch = angle * side.axis.x();
  return {fmt::format("tilt by {:.1f} degrees toward {}", angle * 180.0 / std::numbers::pi, side.name),
          {{0.0, Vector3::Zero()}, {3.0, Vector3::Zero(), roll, pitch}, {4.0, Vector3::Zero(), roll, pitch}}};
}

/// One line, cell by cell.
std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (;;) {
    const std::size_t comma = line.find(',');
    std::string_view cell = line.substr(0, comma);
    while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.remove_prefix(1);
    while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t' || cell.back() == '\r')) cell.remove_suffix(1);
    cells.push_back(cell);
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

constexpr std::array kColumns{"time_s", "ax", "ay", "az", "roll_deg", "pitch_deg"};

class Parser {
 public:
  explicit Parser(std::string name) : name_(std::move(name)) {}

  void take(std::string_view line) {
    ++line_;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string_view::npos || line[first] == '#') return;
    if (columns_.empty()) {
      take_head(line);
    } else {
      take_row(line);
    }
  }

  std::vector<ShakeMotion> finish() {
    if (motion_.samples.size() < 2) fail("rows", std::to_string(motion_.samples.size()), "two at least");
    motion_.name = std::filesystem::path(name_).filename().string();
    return {std::move(motion_)};
  }

 private:
  [[noreturn]] void fail(const std::string& key, const std::string& got, const std::string& expected) const {
    throw InputError(fmt::format("{}:{}", name_, line_), key, got, expected);
  }

  void take_head(std::string_view line) {
    for (const std::string_view cell : cells_of(line)) {
      const auto known = std::ranges::find(kColumns, cell);
      if (known == kColumns.end()) {
        fail("column", std::string(cell), fmt::format("one of {}", fmt::join(kColumns, ", ")));
      }
      const auto column = static_cast<std::size_t>(known - kColumns.begin());
      if (std::ranges::find(columns_, column) != columns_.end()) fail("column", std::string(cell), "each column once");
      columns_.push_back(column);
    }
    if (std::ranges::find(columns_, std::size_t{0}) == columns_.end()) fail("column", "no time_s", "time_s");
  }

  void take_row(std::string_view line) {
    const auto cells = cells_of(line);
    if (cells.size() != columns_.size()) {
      fail("row", std::to_string(cells.size()) + " cells", std::to_string(columns_.size()) + " as the head has");
    }
    std::array<double, kColumns.size()> values{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      double value = 0.0;
      const auto read = std::from_chars(cells[i].data(), cells[i].data() + cells[i].size(), value);
      const bool is_whole = read.ec == std::errc() && read.ptr == cells[i].data() + cells[i].size();
      if (!is_whole || !std::isfinite(value) || std::abs(value) > kLongest) {
        fail(kColumns[columns_[i]], std::string(cells[i]), "a finite number of at most 3600");
      }
      values[columns_[i]] = value;
    }
    if (motion_.samples.empty() ? values[0] != 0.0 : values[0] <= motion_.samples.back().time) {
      fail("time_s", fmt::format("{}", values[0]), "0 in the first row, then rising");
    }
    constexpr double kDegree = std::numbers::pi / 180.0;
    motion_.samples.push_back({values[0], {values[1], values[2], values[3]}, kDegree * values[4], kDegree * values[5]});
  }

  std::string name_;
  int line_ = 0;
  std::vector<std::size_t> columns_;
  ShakeMotion motion_;
};

}  // namespace

ShakeSample ShakeMotion::at(double time) const {
  const auto after = std::ranges::find_if(samples, [time](const ShakeSample& one) { return one.time > time; });
  if (after == samples.begin() || samples.empty()) return samples.empty() ? ShakeSample{} : samples.front();
  if (after == samples.end()) return samples.back();
  const ShakeSample& before = *(after - 1);
  const double part = (time - before.time) / (after->time - before.time);
  ShakeSample now;
  now.time = time;
  now.acceleration_T = (1.0 - part) * before.acceleration_T + part * after->acceleration_T;
  now.roll = (1.0 - part) * before.roll + part * after->roll;
  now.pitch = (1.0 - part) * before.pitch + part * after->pitch;
  return now;
}

std::vector<std::string> shake_profile_names() { return {"conveyor", "truck", "eumos40509", "tilt"}; }

std::vector<ShakeMotion> make_shake_profile(std::string_view name, const ShakeProfileOptions& options) {
  require_number(options.level > 0.0 && options.level <= 2.0, "profile", "level", options.level,
                 "above 0, at most 2 g");
  std::vector<ShakeMotion> motions;
  if (name == "truck") return make_truck(options.size);
  for (const Direction& side : sides()) {
    if (name == "conveyor") motions.push_back(make_belt(side));
    if (name == "eumos40509") {
      motions.push_back(make_pulse(fmt::format("{:.2f} g toward {}", options.level, side.name),
                                   options.level * kGravity * side.axis, 0.05, 0.3));
    }
    if (name == "tilt") motions.push_back(make_tilt(side, options.level));
  }
  if (!motions.empty()) return motions;
  const std::vector<std::string> names = shake_profile_names();
  std::string expected = fmt::format("one of {}, or a file FILE.csv", fmt::join(names, ", "));
  const std::string_view nearest = find_nearest(name, names);
  if (!nearest.empty()) expected += fmt::format("; did you mean {}?", nearest);
  throw InputError("command line", "--profile", std::string(name), expected);
}

std::vector<ShakeMotion> parse_shake_profile(std::string_view text, const std::string& name) {
  Parser parser(name);
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    parser.take(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return parser.finish();
}

std::vector<ShakeMotion> load_shake_profile(const std::filesystem::path& path) {
  return parse_shake_profile(read_file(path, "accelerations (CSV)"), path.string());
}

}  // namespace snug::runs
