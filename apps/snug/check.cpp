// check: loads program and scenario, looks at the way, prints what is in it.
#include "check.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "outputs.hpp"
#include "snug/cell/corrected.hpp"
#include "snug/cell/program_check.hpp"

namespace snug::app {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const cell::CheckFinding& finding) {
  return {{"kind", cell::name_of(finding.kind)},
          {"severity", finding.is_error ? "error" : "warning"},
          {"row", finding.row + 1},
          {"waypoint", finding.waypoint},
          {"what", finding.what},
          {"margin", finding.margin},
          {"unit", finding.unit},
          {"time_s", finding.time}};
}

std::string format_json(const cell::CheckResult& result) {
  Json document = {{"ok", result.is_ok},    {"duration_s", result.duration}, {"wall_s", result.wall},
                   {"looks", result.looks}, {"findings", Json::array()},     {"margins", Json::array()}};
  for (const cell::CheckFinding& finding : result.findings) document["findings"].push_back(as_json(finding));
  for (const cell::CheckFinding& margin : result.margins) {
    Json entry = as_json(margin);
    entry.erase("severity");
    document["margins"].push_back(std::move(entry));
  }
  return document.dump(2) + "\n";
}

std::string line_of(const cell::CheckFinding& finding) {
  return fmt::format("{:<15} {:>4} {:<20} {:>8.2f}  {:<32} {:>9.4f} {}\n", cell::name_of(finding.kind), finding.row + 1,
                     finding.waypoint, finding.time, finding.what, finding.margin, finding.unit);
}

std::string format_table(const cell::CheckResult& result) {
  const std::string head =
      fmt::format("{:<15} {:>4} {:<20} {:>8}  {:<32} {:>9}\n", "", "row", "waypoint", "time s", "what", "margin");
  std::string text;
  for (const bool is_error : {true, false}) {
    std::string lines;
    for (const cell::CheckFinding& finding : result.findings) {
      if (finding.is_error == is_error) lines += line_of(finding);
    }
    if (!lines.empty()) text += (is_error ? "In the way\n" : "Slower than planned\n") + head + lines + "\n";
  }
  text += "Smallest margins\n" + head;
  for (const cell::CheckFinding& margin : result.margins) text += line_of(margin);
  return text + fmt::format("\n{}: {:.1f} s of program, {} poses, in {:.3f} s\n",
                            result.is_ok ? "nothing in the way" : "cannot be done like this", result.duration,
                            result.looks, result.wall);
}

}  // namespace

int run_check(const CheckOptions& options) {
  const model::Scenario scenario = load_changed(options.scenario, options.changes);
  cell::CheckOptions check;
  if (options.sequence) check.sequence = *options.sequence;
  if (options.robot) check.robot = *options.robot;
  const motion::Program program = cell::corrected(scenario, motion::load_program(options.program),
                                                  options.corrections == "none" ? "" : options.corrections);
  const cell::CheckResult result = cell::check_program(scenario, program, check);
  print(options.json ? format_json(result) : format_table(result));
  return result.is_ok ? kSuccess : kRunFailed;
}

}  // namespace snug::app
