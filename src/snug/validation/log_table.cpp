// Log tables: measurements as CSV: a log of mc_rtc read as a recording of an archive, a recording written as tables.
#include "snug/validation/log_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include "snug/core/csv_cell.hpp"
#include "snug/core/csv_fields.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/core/units.hpp"
#include "snug/core/write_file.hpp"

namespace snug::validation {
namespace {

using record::ArchiveRecording;
using record::PoseSample;

constexpr std::size_t kLargestLog = std::size_t{1} << 30U;  // bytes; four minutes of a whole log have 60 MB
constexpr double kUnitTolerance = 1e-3;                     // of a quaternion written with four digits
constexpr std::string_view kPosePart = "_FloatingBase_";
constexpr std::array<const char*, 7> kPoseColumns = {"orientation_w", "orientation_x", "orientation_y", "orientation_z",
                                                     "position_x",    "position_y",    "position_z"};
constexpr std::array<const char*, 6> kWrenchColumns = {"cx", "cy", "cz", "fx", "fy", "fz"};

std::vector<std::string_view> split(std::string_view line, char separator) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0;; ++begin) {
    const std::size_t end = line.find(separator, begin);
    cells.push_back(line.substr(begin, end == std::string_view::npos ? end : end - begin));
    if (end == std::string_view::npos) return cells;
    begin = end;
  }
}

/// "box013" of logs is "Box013" of archives.
std::string body_name(std::string_view prefix) {
  std::string name(prefix);
  if (name.size() > 3 && name.starts_with("box") && name[3] >= '0' && name[3] <= '9') name[0] = 'B';
  return name;
}

/// Where the numbers of one thing stand in a row; -1 where a column is missing.
template <std::size_t kCount>
struct LogColumns {
  LogColumns() { at.fill(-1); }
  int& operator[](std::size_t k) { return at[k]; }
  int operator[](std::size_t k) const { return at[k]; }
  std::array<int, kCount> at;
};

/// Takes the first line from the text, without its end.
std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

class LogReader {
 public:
  explicit LogReader(const std::filesystem::path& path) : path_(path) {}

  ArchiveRecording read() {
    const std::string text = read_file(path_, "a table of measurements (CSV)", kLargestLog);
    check_utf8(text, path_.string());
    std::string_view rest = without_byte_order_mark(text);
    const std::string_view names = next_line(rest);
    if (names.empty()) throw InputError(path_.string(), "", "an empty file", "a row of column names");
    separator_ = names.find(';') != std::string_view::npos ? ';' : ',';
    read_names(names);
    for (line_ = 2; !rest.empty(); ++line_) {
      const std::string_view line = next_line(rest);
      if (!line.empty() && line != "\r") read_row(split_cells(line));
    }
    return finish();
  }

 private:
  [[noreturn]] void fail(const std::string& column, const std::string& got, const std::string& expected) const {
    throw InputError(path_.string() + ":" + std::to_string(line_), column, got, expected);
  }

  /// Counted first: each cell takes many times its own bytes.
  [[nodiscard]] std::vector<std::string_view> split_cells(std::string_view line) const {
    const auto separators = static_cast<std::size_t>(std::count(line.begin(), line.end(), separator_));
    if (separators >= kMostCsvFields)
      fail("", std::to_string(separators + 1) + " columns", std::to_string(kMostCsvFields) + " columns or fewer");
    return split(line, separator_);
  }

  void read_names(std::string_view line) {
    line_ = 1;
    for (const std::string_view name : split_cells(line)) names_.emplace_back(name);
    std::map<std::string, LogColumns<7>> bodies;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::string& name = names_[i];
      if (std::find(names_.begin(), names_.begin() + static_cast<std::ptrdiff_t>(i), name) !=
          names_.begin() + static_cast<std::ptrdiff_t>(i))
        fail(name, "the column twice", "each column once");
      if (name == "t") time_ = static_cast<int>(i);
      if (const std::size_t at = name.find(kPosePart); at != std::string::npos)
        enter(bodies[name.substr(0, at)], kPoseColumns, name.substr(at + kPosePart.size()), i);
      if (name.starts_with("UR10FTSensor_")) enter(wrench_, kWrenchColumns, name.substr(13), i);
      if (name.starts_with("tool_") && !name.starts_with("tool_command") && !name.starts_with("tool_velocity"))
        enter(tool_, kPoseColumns, name.substr(5), i);
    }
    if (time_ < 0) fail("t", "no such column", "the time in s");
    for (const auto& [prefix, columns] : bodies) {
      require_all(prefix + std::string(kPosePart), kPoseColumns, columns);
      bodies_.push_back({prefix, columns, {}});
    }
    if (has_some(wrench_)) require_all("UR10FTSensor_", kWrenchColumns, wrench_);
    if (has_some(tool_)) require_all("tool_", kPoseColumns, tool_);
    if (bodies_.empty() && wrench_[0] == -1)
      fail("", "no pose and no wrench", "columns like box013_FloatingBase_position_x or UR10FTSensor_fx");
  }

  template <std::size_t kCount>
  static void enter(LogColumns<kCount>& columns, const std::array<const char*, kCount>& words, const std::string& word,
                    std::size_t at) {
    for (std::size_t k = 0; k < kCount; ++k) {
      if (word == words[k]) columns[k] = static_cast<int>(at);
    }
  }

  template <std::size_t kCount>
  static bool has_some(const LogColumns<kCount>& columns) {
    return std::any_of(columns.at.begin(), columns.at.end(), [](int column) { return column >= 0; });
  }

  template <std::size_t kCount>
  void require_all(const std::string& prefix, const std::array<const char*, kCount>& words,
                   const LogColumns<kCount>& columns) const {
    for (std::size_t k = 0; k < kCount; ++k)
      if (columns[k] < 0) fail(prefix + words[k], "no such column", "all " + std::to_string(kCount) + " of them");
  }

  /// NaN for an empty cell, and where mc_rtc wrote so.
  double number(const std::vector<std::string_view>& cells, int column) const {
    const std::string_view cell = cells[static_cast<std::size_t>(column)];
    if (cell.empty() || cell == "nan" || cell == "-nan") return kNaN;
    double value = 0.0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    if (error != std::errc() || end != cell.data() + cell.size() || !std::isfinite(value))
      fail(names_[static_cast<std::size_t>(column)], "'" + std::string(cell) + "'", "a number, or nothing");
    return value;
  }

  PoseSample read_pose(const std::vector<std::string_view>& cells, const LogColumns<7>& columns) const {
    std::array<double, 7> v;
    for (std::size_t k = 0; k < 7; ++k) v[k] = number(cells, columns[k]);
    const auto missing = std::count_if(v.begin(), v.end(), [](double x) { return !std::isfinite(x); });
    const std::string& name = names_[static_cast<std::size_t>(columns[0])];
    if (missing == 7) return record::lost_pose();
    if (missing > 0) fail(name, "some of a pose", "all seven numbers, or none where the body was lost");
    const Quaternion quat_BW(v[0], v[1], v[2], v[3]);
    if (std::abs(quat_BW.norm() - 1.0) > kUnitTolerance)
      fail(name, "a quaternion of length " + std::to_string(quat_BW.norm()), "a rotation: length 1");
    return {Vector3(v[4], v[5], v[6]), quat_BW.normalized().conjugate()};
  }

  void read_row(const std::vector<std::string_view>& cells) {
    if (cells.size() != names_.size())
      fail("", std::to_string(cells.size()) + " cells", std::to_string(names_.size()) + ", one for each column");
    const double time = number(cells, time_);
    if (!std::isfinite(time)) fail("t", "nothing", "a time in s");
    if (!times_.empty() && !(time > times_.back()))
      fail("t", std::to_string(time) + " s after " + std::to_string(times_.back()) + " s",
           "times that grow: mc_bin_to_log writes six digits, mc_bin_to_flat all");
    times_.push_back(time);
    for (Body& body : bodies_) body.poses.push_back(read_pose(cells, body.columns));
    if (tool_[0] >= 0) tool_poses_.push_back(read_pose(cells, tool_));
    if (wrench_[0] < 0) return;
    Vector6 v;
    for (std::size_t k = 0; k < 6; ++k) v[static_cast<int>(k)] = number(cells, wrench_[k]);
    if (v.array().isNaN().all()) return;  // not logged then
    if (!v.allFinite())
      fail("UR10FTSensor", "a wrench with empty cells", "six numbers, or none where it was not logged");
    wrench_times_.push_back(time);
    wrenches_.push_back({v.tail<3>(), v.head<3>()});
  }

  ArchiveRecording finish() {
    if (times_.size() < 2)
      throw InputError(path_.string(), "", std::to_string(times_.size()) + " rows", "two rows of numbers or more");
    ArchiveRecording recording;
    recording.name = path_.stem().string();
    recording.remarks = {{"note", "read from the log " + path_.filename().string()}};
    if (!bodies_.empty()) {
      record::MotionCaptureLog& log = recording.motion_capture;
      log.times = times_;
      log.sample_frequency = static_cast<double>(times_.size() - 1) / (times_.back() - times_.front());
      for (Body& body : bodies_) log.bodies.push_back({body_name(body.prefix), std::move(body.poses)});
      std::sort(log.bodies.begin(), log.bodies.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
    }
    if (wrenches_.size() > 1) recording.force_torque = {std::move(wrench_times_), std::move(wrenches_), {}};
    if (!tool_poses_.empty()) recording.robot = {times_, {}, {}, std::move(tool_poses_)};
    return recording;
  }

  struct Body {
    std::string prefix;
    LogColumns<7> columns;
    std::vector<PoseSample> poses;
  };

  std::filesystem::path path_;
  char separator_ = ';';
  int line_ = 1;
  std::vector<std::string> names_;
  int time_ = -1;
  std::vector<Body> bodies_;
  LogColumns<7> tool_;
  LogColumns<6> wrench_;
  std::vector<double> times_, wrench_times_;
  std::vector<PoseSample> tool_poses_;
  std::vector<Wrench> wrenches_;
};

void append_pose(std::string& row, const PoseSample& pose) {
  if (!record::is_tracked(pose)) {
    row += ";;;;;;;";
    return;
  }
  const Quaternion inverse = pose.quat.conjugate();
  row += fmt::format(";{};{};{};{};{};{};{}", inverse.w(), inverse.x(), inverse.y(), inverse.z(), pose.p.x(),
                     pose.p.y(), pose.p.z());
}

std::string pose_names(const std::string& prefix) {
  std::string names;
  for (const char* column : kPoseColumns) names += ';' + prefix + column;
  return names;
}

std::string mocap_table(const record::MotionCaptureLog& log) {
  std::string text = "t";
  for (const record::BodyTrack& body : log.bodies) text += pose_names(csv_cell(body.name) + std::string(kPosePart));
  text += '\n';
  for (std::size_t i = 0; i < log.times.size(); ++i) {
    text += fmt::format("{}", log.times[i]);
    for (const record::BodyTrack& body : log.bodies) append_pose(text, body.poses[i]);
    text += '\n';
  }
  return text;
}

std::string force_table(const record::WrenchLog& log) {
  std::string text = "t";
  for (const char* column : kWrenchColumns) text += std::string(";UR10FTSensor_") + column;
  if (!log.accelerations.empty()) text += ";imu_x;imu_y;imu_z";
  text += '\n';
  for (std::size_t i = 0; i < log.times.size(); ++i) {
    const Vector3 &f = log.wrenches[i].force, &c = log.wrenches[i].torque;
    text += fmt::format("{};{};{};{};{};{};{}", log.times[i], c.x(), c.y(), c.z(), f.x(), f.y(), f.z());
    if (!log.accelerations.empty()) {
      const Vector3& a = log.accelerations[i];
      text += fmt::format(";{};{};{}", a.x(), a.y(), a.z());
    }
    text += '\n';
  }
  return text;
}

std::string robot_table(const record::RobotLog& log) {
  std::string text = "t";
  for (const std::string& name : log.names) text += ';' + csv_cell(name);
  if (!log.tool.empty()) text += pose_names("tool_");
  text += '\n';
  for (std::size_t i = 0; i < log.times.size(); ++i) {
    text += fmt::format("{}", log.times[i]);
    for (const auto& column : log.columns) text += fmt::format(";{}", column[i]);
    if (!log.tool.empty()) append_pose(text, log.tool[i]);
    text += '\n';
  }
  return text;
}

}  // namespace

ArchiveRecording load_log(const std::filesystem::path& path) { return LogReader(path).read(); }

std::vector<std::filesystem::path> save_tables(const ArchiveRecording& recording, const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> written;
  const auto save = [&](const char* source, const std::string& text) {
    written.push_back(folder / (recording.name + '-' + source + ".csv"));
    write_file(written.back(), text);
  };
  if (!recording.motion_capture.times.empty()) save("mocap", mocap_table(recording.motion_capture));
  if (!recording.force_torque.times.empty()) save("ft", force_table(recording.force_torque));
  if (!recording.robot.times.empty()) save("robot", robot_table(recording.robot));
  return written;
}

}  // namespace snug::validation
