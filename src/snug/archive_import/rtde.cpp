// What a UR's controller said over RTDE, as CSV: record.py of the maker's client, ur_rtde's recorder.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "snug/archive_import/internal/readers.hpp"
#include "snug/core/csv_fields.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::archive_import::internal {
namespace {

constexpr std::string_view kTimeName = "timestamp";
constexpr std::string_view kToolName = "actual_TCP_pose";

std::optional<char> separator_of(std::string_view header) {
  for (const char separator : {',', ';', '\t', ' '})
    if (header.find(separator) != std::string_view::npos) return separator;
  return std::nullopt;
}

/// Cells without quotes around; neither a comma nor a blank stands in them.
std::vector<std::string_view> split_cells(std::string_view line, char separator, const std::string& where) {
  std::vector<std::string_view> cells;
  while (true) {
    if (cells.size() == kMostCsvFields)
      throw InputError(where, "", "more than " + std::to_string(kMostCsvFields) + " cells", "fewer");
    const std::size_t end = std::min(line.find(separator), line.size());
    std::string_view cell = trim(line.substr(0, end));
    if (cell.size() > 1 && cell.starts_with('"') && cell.ends_with('"')) cell = cell.substr(1, cell.size() - 2);
    cells.push_back(cell);
    if (end == line.size()) return cells;
    line.remove_prefix(end + 1);
  }
}

/// Where NAME_0 .. NAME_5 stand, if all are there.
std::optional<std::array<std::size_t, 6>> find_six(const std::vector<std::string>& names, std::string_view name) {
  std::array<std::size_t, 6> at{};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto found = std::find(names.begin(), names.end(), fmt::format("{}_{}", name, k));
    if (found == names.end()) return std::nullopt;
    at[k] = static_cast<std::size_t>(found - names.begin());
  }
  return at;
}

class RtdeReader {
 public:
  RtdeReader(std::string_view text, const std::string& name, const Hints& hints)
      : rest_(text), name_(name), hints_(hints) {}

  Imported read() {
    read_header(trim(take_line(rest_)));
    for (line_ = 2; !rest_.empty(); ++line_) {
      const std::string_view line = trim(take_line(rest_));
      if (!line.empty()) read_row(split_cells(line, separator_, where()));
    }
    return finish();
  }

 private:
  [[nodiscard]] std::string where() const { return name_ + ":" + std::to_string(line_); }
  [[noreturn]] void fail(const std::string& column, const std::string& got, const std::string& expected) const {
    throw InputError(where(), printable(column, 60), got, expected);
  }

  void read_header(std::string_view line) {
    const std::optional<char> separator = separator_of(line);
    if (!separator) fail("", "one column", "timestamp and others, such as actual_q_0");
    separator_ = *separator;
    std::set<std::string_view> seen;
    for (const std::string_view name : split_cells(line, separator_, where())) {
      if (name.empty() || !is_printable(name)) fail("", "a column without a printable name", "a name");
      if (!seen.insert(name).second) fail(std::string(name), "the column twice", "each column once");
      if (name == kTimeName) time_ = all_.size();
      all_.emplace_back(name);
    }
    if (all_.size() > kMostColumns)
      fail("", std::to_string(all_.size()) + " columns", std::to_string(kMostColumns) + " or fewer");
    if (all_.size() < 2) fail("", "no column beside the time", "such as actual_q_0");
    columns_.resize(all_.size());
    tool_ = find_six(all_, kToolName);
    if (!hints_.wrench.empty()) {
      wrench_ = find_six(all_, hints_.wrench);
      if (!wrench_) fail("--wrench", "'" + printable(hints_.wrench, 60) + "'", "columns of this name with _0 to _5");
    }
  }

  void read_row(const std::vector<std::string_view>& cells) {
    if (cells.size() != all_.size())
      fail("", std::to_string(cells.size()) + " cells", std::to_string(all_.size()) + ", one for each column");
    const double time = read_cell(cells[time_], where(), std::string(kTimeName));
    if (!times_.empty() && time == times_.back()) {  // a package that was written twice
      ++repeated_;
      return;
    }
    require_growth(times_, time, where());
    times_.push_back(time);
    for (std::size_t i = 0; i < all_.size(); ++i) {
      const std::string_view cell = cells[i];
      const double value = cell == "True" ? 1.0 : cell == "False" ? 0.0 : read_cell(cell, where(), all_[i]);
      columns_[i].push_back(value);
    }
    if (tool_) read_tool();
    if (wrench_) read_wrench();
  }

  [[nodiscard]] Vector3 last_three(const std::array<std::size_t, 6>& at, std::size_t first) const {
    Vector3 v;
    for (std::size_t k = 0; k < 3; ++k) v[static_cast<int>(k)] = columns_[at[first + k]].back();
    return v;
  }

  /// Position [m] and rotation vector, of the TCP in Base.
  void read_tool() {
    const Vector3 p = last_three(*tool_, 0), turn = last_three(*tool_, 3);
    if (!p.allFinite() || !turn.allFinite()) {
      tool_poses_.push_back(record::lost_pose());
      return;
    }
    if (!(p.cwiseAbs().maxCoeff() <= 1000.0 && turn.norm() <= 100.0))
      fail(std::string(kToolName), "a pose out of reach", "metres, and a rotation vector in rad");
    tool_poses_.push_back({p, Quaternion(exp_rotation(turn)).normalized()});
  }

  void read_wrench() {
    const Wrench wrench{last_three(*wrench_, 0), last_three(*wrench_, 3)};
    if (!wrench.force.allFinite() || !wrench.torque.allFinite()) return;
    wrench_times_.push_back(times_.back());
    wrenches_.push_back(wrench);
  }

  Imported finish() {
    if (times_.size() < 2)
      throw InputError(name_, "", std::to_string(times_.size()) + " rows", "two rows of numbers or more");
    Imported imported;
    record::RobotLog& robot = imported.recording.robot;
    robot.times = std::move(times_);
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (i == time_ || all_[i] == "Frame" || all_[i] == "Time(s)") continue;
      robot.names.push_back(all_[i]);
      robot.columns.push_back(std::move(columns_[i]));
    }
    robot.tool = std::move(tool_poses_);
    if (tool_)
      imported.remarks.emplace_back("the tool is the TCP of the controller: check that this is E, the gripper's end");
    if (repeated_ > 0) imported.remarks.push_back(fmt::format("{} rows with the time of the row before", repeated_));
    if (wrench_) imported.recording.force_torque = {std::move(wrench_times_), std::move(wrenches_), {}};
    if (!wrench_ && find_six(all_, "ft_raw_wrench"))
      imported.remarks.emplace_back("--wrench ft_raw_wrench takes that for the force sensor, as it is");
    turn_wrenches(imported.recording, hints_);
    return imported;
  }

  std::string_view rest_;
  std::string name_;
  const Hints& hints_;
  char separator_ = ' ';
  int line_ = 1;
  std::size_t time_ = 0;
  std::vector<std::string> all_;  ///< names of columns, with the time
  std::vector<std::vector<double>> columns_;
  std::optional<std::array<std::size_t, 6>> tool_, wrench_;
  std::vector<double> times_, wrench_times_;
  std::vector<record::PoseSample> tool_poses_;
  std::vector<Wrench> wrenches_;
  int repeated_ = 0;
};

}  // namespace

bool is_rtde(std::string_view text) {
  const std::string_view header = trim(take_line(text));
  const std::optional<char> separator = separator_of(header);
  if (!separator) return false;
  for (std::size_t begin = 0; begin < header.size();) {
    const std::size_t end = std::min(header.find(*separator, begin), header.size());
    std::string_view cell = trim(header.substr(begin, end - begin));
    if (cell.size() > 1 && cell.starts_with('"') && cell.ends_with('"')) cell = cell.substr(1, cell.size() - 2);
    if (cell == kTimeName) return true;
    begin = end + 1;
  }
  return false;
}

Imported read_rtde(std::string_view text, const std::string& name, const Hints& hints) {
  return RtdeReader(text, name, hints).read();
}

}  // namespace snug::archive_import::internal
