// check: loads program and scenario, looks at the way, prints what is in it.
#include "apps/snug/check/check.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/common/program_fit.hpp"
#include "apps/snug/common/robot_warnings.hpp"
#include "snug/core/read_file.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/program_check.hpp"

namespace snug::app {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const runs::CheckFinding& finding) {
  return {{"kind", cell::name_of(finding.kind)},
          {"severity", finding.is_error ? "error" : "warning"},
          {"row", finding.row + 1},
          {"waypoint", finding.waypoint},
          {"what", finding.what},
          {"margin", finding.margin},
          {"allowance", finding.allowance},
          {"unit", finding.unit},
          {"time_s", finding.time}};
}

std::string format_json(const runs::CheckResult& result) {
  Json document = {{"ok", result.is_ok},      {"duration_s", result.duration}, {"wall_s", result.wall},
                   {"looks", result.looks},   {"findings", Json::array()},     {"groups", Json::array()},
                   {"margins", Json::array()}};
  for (const runs::CheckFinding& finding : result.findings) document["findings"].push_back(as_json(finding));
  for (const runs::CheckGroup& group : runs::group(result.findings)) {
    Json entry = as_json(group.worst);
    entry["rows"] = Json::array();
    for (const int row : group.rows) entry["rows"].push_back(row + 1);
    document["groups"].push_back(std::move(entry));
  }
  for (const runs::CheckFinding& margin : result.margins) {
    Json entry = as_json(margin);
    entry.erase("severity");
    document["margins"].push_back(std::move(entry));
  }
  return document.dump(2) + "\n";
}

/// "3", "3, 5-9", and of many the first, with their number.
std::string rows_of(const std::vector<int>& rows) {
  constexpr std::size_t kMost = 4;
  std::vector<std::string> runs;
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i + 1;
    while (end < rows.size() && rows[end] == rows[end - 1] + 1) ++end;
    runs.push_back(end - i == 1 ? fmt::format("{}", rows[i] + 1)
                                : fmt::format("{}-{}", rows[i] + 1, rows[end - 1] + 1));
    i = end;
  }
  const bool is_long = runs.size() > kMost;
  if (is_long) runs.resize(kMost);
  return fmt::format("{}{}", fmt::join(runs, ", "), is_long ? fmt::format(", ... ({} rows)", rows.size()) : "");
}

/// One finding as a line; `rows`: all rows that have it, or only its own.
std::string line_of(const runs::CheckFinding& finding, const std::vector<int>& rows) {
  std::string text =
      fmt::format("{:<15} {:<36} {:>9.4f} {:<6} {:>4} {:<20} {:>8.2f}", cell::name_of(finding.kind), finding.what,
                  finding.margin, finding.unit, finding.row + 1, finding.waypoint, finding.time);
  if (finding.allowance > 0.0) text += fmt::format("  {:.3f} {} inside allowed", finding.allowance, finding.unit);
  if (rows.size() > 1) text += "  rows " + rows_of(rows);
  return text + "\n";
}

std::string format_table(const runs::CheckResult& result) {
  const std::string head = fmt::format("{:<15} {:<36} {:>9} {:<6} {:>4} {:<20} {:>8}\n", "", "what", "margin", "",
                                       "row", "waypoint", "time s");
  std::string text;
  const std::vector<runs::CheckGroup> groups = runs::group(result.findings);
  for (const bool is_error : {true, false}) {
    std::string lines;
    for (const runs::CheckGroup& group : groups) {
      if (group.worst.is_error == is_error) lines += line_of(group.worst, group.rows);
    }
    if (!lines.empty()) text += (is_error ? "In the way\n" : "Slower than planned\n") + head + lines + "\n";
  }
  text += "Smallest margins\n" + head;
  for (const runs::CheckFinding& margin : result.margins) text += line_of(margin, {});
  return text + fmt::format("\n{}: {:.1f} s of program, {} poses, in {:.3f} s\n",
                            result.is_ok ? "nothing in the way" : "cannot be done like this", result.duration,
                            result.looks, result.wall);
}

}  // namespace

int run_check(const CheckOptions& options) {
  const model::Scenario scenario = load_changed(options.scenario, options.changes);
  runs::CheckOptions check;
  if (options.sequence) check.sequence = *options.sequence;
  if (options.robot) check.robot = *options.robot;
  const std::string text = read_file(options.program, "a program file (CSV)");
  cell::SimulationOptions how;
  choose_motion(options.motion, text, options.program, how);
  check.tracking = how.tracking;
  print_robot_warnings(scenario);
  const motion::Program read = motion::parse_program(text, options.program);
  if (options.sequence) warn_misfit(scenario, *options.sequence, read);
  const motion::Program program =
      runs::corrected(scenario, read, options.corrections == "none" ? "" : options.corrections);
  const runs::CheckResult result = runs::check_program(scenario, program, check);
  print(options.json ? format_json(result) : format_table(result));
  return result.is_ok ? kSuccess : kRunFailed;
}

}  // namespace snug::app
