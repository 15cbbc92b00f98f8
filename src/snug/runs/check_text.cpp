// The result of checking a program as text.
#include "snug/runs/check_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace snug::runs {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const CheckFinding& finding) {
  return {{"kind", name_of(finding.kind)},  {"severity", finding.is_error ? "error" : "warning"},
          {"row", finding.row + 1},         {"waypoint", finding.waypoint},
          {"what", finding.what},           {"margin", finding.margin},
          {"allowance", finding.allowance}, {"unit", finding.unit},
          {"time_s", finding.time}};
}

/// "3", "3, 5-9", and of many the first, with their number.
std::string rows_of(const std::vector<int>& rows) {
  constexpr std::size_t kMost = 4;
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t end = i + 1;
    while (end < rows.size() && rows[end] == rows[end - 1] + 1) ++end;
    parts.push_back(end - i == 1 ? fmt::format("{}", rows[i] + 1)
                                 : fmt::format("{}-{}", rows[i] + 1, rows[end - 1] + 1));
    i = end;
  }
  const bool is_long = parts.size() > kMost;
  if (is_long) parts.resize(kMost);
  return fmt::format("{}{}", fmt::join(parts, ", "), is_long ? fmt::format(", ... ({} rows)", rows.size()) : "");
}

/// One finding as a line; `rows`: all rows that have it, or only its own.
std::string line_of(const CheckFinding& finding, const std::vector<int>& rows) {
  std::string text =
      fmt::format("{:<15} {:<36} {:>9.4f} {:<6} {:>4} {:<20} {:>8.2f}", name_of(finding.kind), finding.what,
                  finding.margin, finding.unit, finding.row + 1, finding.waypoint, finding.time);
  if (finding.allowance > 0.0) text += fmt::format("  {:.3f} {} inside allowed", finding.allowance, finding.unit);
  if (rows.size() > 1) text += "  rows " + rows_of(rows);
  return text + "\n";
}

}  // namespace

std::string format_json(const CheckResult& result) {
  Json document = {{"ok", result.is_ok},      {"duration_s", result.duration}, {"wall_s", result.wall},
                   {"looks", result.looks},   {"findings", Json::array()},     {"groups", Json::array()},
                   {"margins", Json::array()}};
  for (const CheckFinding& finding : result.findings) document["findings"].push_back(as_json(finding));
  for (const CheckGroup& group : group(result.findings)) {
    Json entry = as_json(group.worst);
    entry["rows"] = Json::array();
    for (const int row : group.rows) entry["rows"].push_back(row + 1);
    document["groups"].push_back(std::move(entry));
  }
  for (const CheckFinding& margin : result.margins) {
    Json entry = as_json(margin);
    entry.erase("severity");
    document["margins"].push_back(std::move(entry));
  }
  return document.dump(2) + "\n";
}

std::string format_table(const CheckResult& result) {
  const std::string head = fmt::format("{:<15} {:<36} {:>9} {:<6} {:>4} {:<20} {:>8}\n", "", "what", "margin", "",
                                       "row", "waypoint", "time s");
  std::string text;
  const std::vector<CheckGroup> groups = group(result.findings);
  for (const bool is_error : {true, false}) {
    std::string lines;
    for (const CheckGroup& group : groups) {
      if (group.worst.is_error == is_error) lines += line_of(group.worst, group.rows);
    }
    if (!lines.empty()) text += (is_error ? "In the way\n" : "Slower than planned\n") + head + lines + "\n";
  }
  text += "Smallest margins\n" + head;
  for (const CheckFinding& margin : result.margins) text += line_of(margin, {});
  return text + fmt::format("\n{}: {:.1f} s of program, {} poses, in {:.3f} s\n",
                            result.is_ok ? "nothing in the way" : "cannot be done like this", result.duration,
                            result.looks, result.wall);
}

}  // namespace snug::runs
