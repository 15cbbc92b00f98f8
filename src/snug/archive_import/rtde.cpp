// What a UR's controller said over RTDE, as CSV: record.py of the maker's client, ur_rtde's recorder.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "snug/archive_import/internal/readers.hpp"
#include "snug/core/csv_fields.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::archive_import::internal {
namespace {

constexpr std::string_view kTimeName = "timestamp";
constexpr std::string_view kToolName = "actual_TCP_pose";

/// Beyond any controller's, Hz.
constexpr double kHighestRate = 1e5;

std::optional<char> separator_of(std::string_view header) {
  for (const char separator : {',', ';', '\t', ' '})
    if (header.find(separator) != std::string_view::npos) return separator;
  return std::nullopt;
}

std::string_view unquote(std::string_view cell) {
  cell = trim(cell);
  const bool is_quoted = cell.size() > 1 && cell.starts_with('"') && cell.ends_with('"');
  return is_quoted ? cell.substr(1, cell.size() - 2) : cell;
}

/// Cells without quotes around; neither a comma nor a blank stands in them.
std::vector<std::string_view> split_cells(std::string_view line, char separator, const std::string& where) {
  std::vector<std::string_view> cells;
  while (true) {
    if (cells.size() == kMostCsvFields)
      throw InputError(where, "", "more than " + std::to_string(kMostCsvFields) + " cells", "fewer");
    const std::size_t end = std::min(line.find(separator), line.size());
    cells.push_back(unquote(line.substr(0, end)));
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
    std::map<std::string_view, std::size_t> seen;
    for (const std::string_view name : split_cells(line, separator_, where())) {
      if (name.empty() || !is_printable(name)) fail("", "a column without a printable name", "a name");
      const auto [first, is_new] = seen.emplace(name, all_.size());
      if (is_new && name == kTimeName) time_ = all_.size();
      first_.push_back(first->second);
      all_.emplace_back(name);
    }
    if (seen.size() > kMostColumns)
      fail("", std::to_string(seen.size()) + " columns", std::to_string(kMostColumns) + " or fewer");
    if (seen.size() < 2) fail("", "no column beside the time", "such as actual_q_0");
    require_times();
    columns_.resize(all_.size());
    tool_ = find_six(all_, kToolName);
    if (!hints_.wrench.empty()) {
      wrench_ = find_six(all_, hints_.wrench);
      if (!wrench_) fail("--wrench", "'" + printable(hints_.wrench, 60) + "'", "columns of this name with _0 to _5");
    }
  }

  /// A column of them, or a rate.
  void require_times() const {
    if (time_) return;
    if (hints_.rate == 0.0)
      fail(std::string(kTimeName), "no such column",
           "it, which a recipe of RTDE can have; or --rate HZ where rows came at a fixed rate: 500 on an e-Series, 125 "
           "before");
    if (!(hints_.rate > 0.0 && hints_.rate <= kHighestRate))
      fail("--rate", fmt::format("{}", hints_.rate), fmt::format("rows a second, up to {}", kHighestRate));
  }

  void read_row(const std::vector<std::string_view>& cells) {
    if (cells.size() != all_.size())
      fail("", std::to_string(cells.size()) + " cells", std::to_string(all_.size()) + ", one for each column");
    row_.clear();
    for (std::size_t i = 0; i < all_.size(); ++i) {
      const std::string_view cell = cells[i];
      row_.push_back(cell == "True" ? 1.0 : cell == "False" ? 0.0 : read_cell(cell, where(), all_[i]));
      const double twin = row_[first_[i]];
      if (row_[i] != twin && (std::isfinite(row_[i]) || std::isfinite(twin)))
        fail(all_[i], fmt::format("the column twice, with {} and {}", twin, row_[i]),
             "each once, or the same numbers in both");
    }
    const double time = time_ ? row_[*time_] : static_cast<double>(times_.size()) / hints_.rate;
    if (!times_.empty() && time == times_.back()) {  // a package that was written twice
      ++repeated_;
      if (!is_last_row()) ++repeated_with_others_;
      return;
    }
    require_growth(times_, time, where());
    times_.push_back(time);
    for (std::size_t i = 0; i < all_.size(); ++i)
      if (first_[i] == i) columns_[i].push_back(row_[i]);
    if (tool_) read_tool();
    if (wrench_) read_wrench();
  }

  /// Has the row the numbers of the one that was taken last?
  [[nodiscard]] bool is_last_row() const {
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (first_[i] != i) continue;
      const double last = columns_[i].back();
      if (row_[i] != last && (std::isfinite(row_[i]) || std::isfinite(last))) return false;
    }
    return true;
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
    require_two_rows(times_.size(), name_);
    Imported imported;
    record::RobotLog& robot = imported.recording.robot;
    robot.times = std::move(times_);
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (i == time_ || first_[i] != i || all_[i] == "Frame" || all_[i] == "Time(s)") continue;
      robot.names.push_back(all_[i]);
      robot.columns.push_back(std::move(columns_[i]));
    }
    robot.tool = std::move(tool_poses_);
    if (tool_)
      imported.remarks.emplace_back("the tool is the TCP of the controller: check that this is E, the gripper's end");
    if (repeated_ > 0)
      imported.remarks.push_back(
          fmt::format("rows with the time of the row before are left out: {}; with other numbers: {}", repeated_,
                      repeated_with_others_));
    if (const std::string twins = list_twins(); !twins.empty())
      imported.remarks.push_back("columns that are there twice, with the same numbers, are taken once: " + twins);
    if (!time_)
      imported.remarks.push_back(fmt::format("no times: {} rows a second, as --rate says", hints_.rate));
    else if (hints_.rate != 0.0)
      imported.remarks.emplace_back("--rate does not count: there is a column timestamp");
    if (wrench_) imported.recording.force_torque = {std::move(wrench_times_), std::move(wrenches_), {}};
    if (!wrench_ && find_six(all_, "ft_raw_wrench"))
      imported.remarks.emplace_back("--wrench ft_raw_wrench takes that for the force sensor, as it is");
    turn_wrenches(imported.recording, hints_);
    return imported;
  }

  [[nodiscard]] std::string list_twins() const {
    std::string names;
    for (std::size_t i = 0; i < all_.size(); ++i)
      if (first_[i] != i) names += (names.empty() ? "" : ", ") + all_[i];
    return printable(names, 150);
  }

  std::string_view rest_;
  std::string name_;
  const Hints& hints_;
  char separator_ = ' ';
  int line_ = 1;
  std::optional<std::size_t> time_;
  std::vector<std::string> all_;              ///< names of columns, with the time
  std::vector<std::size_t> first_;            ///< of each column: the first one of its name
  std::vector<std::vector<double>> columns_;  ///< empty where the name was there before
  std::vector<double> row_;
  std::optional<std::array<std::size_t, 6>> tool_, wrench_;
  std::vector<double> times_, wrench_times_;
  std::vector<record::PoseSample> tool_poses_;
  std::vector<Wrench> wrenches_;
  int repeated_ = 0, repeated_with_others_ = 0;
};

}  // namespace

bool is_rtde(std::string_view text) {
  const std::string_view header = trim(take_line(text));
  const std::optional<char> separator = separator_of(header);
  if (!separator) return false;
  bool has_outputs = false;
  for (std::size_t begin = 0; begin < header.size();) {
    const std::size_t end = std::min(header.find(*separator, begin), header.size());
    const std::string_view cell = unquote(header.substr(begin, end - begin));
    if (cell == kTimeName) return true;
    if (cell == "t") return false;  // mc_rtc's, and what an archive became
    has_outputs = has_outputs || cell.starts_with("actual_") || cell.starts_with("target_");
    begin = end + 1;
  }
  return has_outputs;
}

Imported read_rtde(std::string_view text, const std::string& name, const Hints& hints) {
  return RtdeReader(text, name, hints).read();
}

}  // namespace snug::archive_import::internal
