// The rows of a comparison as text: tables for people, JSON and CSV for programs.
#include "compare_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "snug/core/csv_cell.hpp"

namespace snug::app {
namespace {

constexpr std::size_t kMostColumns = 6;  ///< sequences beside each other

struct Means {
  int count = 0;
  double planned = 0.0, executed = 0.0, seconds = 0.0;
};

/// Over the rows of one agent; seconds: the mean of the medians.
Means means_of(const std::vector<CompareRow>& rows, const std::string& agent) {
  Means means;
  for (const CompareRow& row : rows) {
    if (row.result.agent != agent) continue;
    ++means.count;
    means.planned += row.result.planned_percent;
    means.executed += row.result.executed_percent;
    means.seconds += row.result.decision_seconds_median;
  }
  if (means.count == 0) return means;
  means.planned /= means.count;
  means.executed /= means.count;
  means.seconds /= means.count;
  return means;
}

std::vector<std::string> agents_of(const std::vector<CompareRow>& rows) {
  std::vector<std::string> agents;
  for (const CompareRow& row : rows) {
    if (std::ranges::find(agents, row.result.agent) == agents.end()) agents.push_back(row.result.agent);
  }
  return agents;
}

std::string agent_lines(const std::vector<CompareRow>& rows, const std::string& agent) {
  std::string planned = fmt::format("{:<14} planned ", agent), executed = fmt::format("{:<14} executed", "");
  for (const CompareRow& row : rows) {
    if (row.result.agent != agent) continue;
    planned += fmt::format("  {:3} / {:5.2f}", row.result.planned_boxes, row.result.planned_percent);
    executed += fmt::format("  {:3} / {:5.2f}", row.result.executed_boxes, row.result.executed_percent);
  }
  const Means means = means_of(rows, agent);
  return fmt::format("{}   {:5.2f}\n{}   {:5.2f}\n", planned, means.planned, executed, means.executed);
}

/// What the report's Table 7 counted on its five sequences: boxes, and percent of the scenario's container.
std::string reference_lines(const model::Scenario& scenario, const std::vector<std::string>& sequences) {
  struct Reference {
    const char* name;
    std::array<int, 5> boxes;
  };
  constexpr std::array<Reference, 3> kTable7{{{"report, state of the art", {5, 7, 8, 6, 6}},
                                              {"report, I.AM.", {12, 12, 13, 14, 12}},
                                              {"report, manual operator", {12, 12, 13, 15, 14}}}};
  const model::Container& container = *model::find_container(scenario, scenario.target);
  std::string text;
  for (const Reference& reference : kTable7) {
    std::string line = fmt::format("{:<24}", reference.name).substr(0, 23);
    double sum = 0.0;
    for (const std::string& name : sequences) {
      const model::Sequence& sequence = *model::find_sequence(scenario, name);
      const auto index = static_cast<std::size_t>(name[0] - '1');
      if (name.size() != 1 || index >= 5 || !sequence.packed_count) return {};
      const auto boxes = static_cast<std::size_t>(reference.boxes[index]);
      std::vector<std::string> ids;
      for (std::size_t i = 0; i < std::min(boxes, sequence.items.size()); ++i) ids.push_back(sequence.items[i].parcel);
      const double percent = model::compute_filling_degree_percent(scenario, container, ids);
      sum += percent;
      line += fmt::format("  {:3} / {:5.2f}", boxes, percent);
    }
    text += fmt::format("{}   {:5.2f}\n", line, sum / static_cast<double>(sequences.size()));
  }
  return text;
}

/// Sequences beside each other, agents below each other.
std::string format_columns(const model::Scenario& scenario, const std::vector<CompareRow>& rows,
                           const std::vector<std::string>& sequences, bool with_references) {
  std::string text = fmt::format("{:<23}", "boxes / filling, %");
  for (const std::string& sequence : sequences) text += fmt::format("  {:>11}", "sequence " + sequence);
  text += "    mean\n";
  for (const std::string& agent : agents_of(rows)) text += agent_lines(rows, agent);
  return with_references ? text + reference_lines(scenario, sequences) : text;
}

/// A line for each row: for many sequences, or long names.
std::string format_lines(const std::vector<CompareRow>& rows) {
  std::size_t width = 8;
  for (const CompareRow& row : rows) width = std::max(width, row.result.sequence.size());
  std::string text = fmt::format("{:<14} {:<{}}  {:>16}  {:>16}  {:>10}\n", "agent", "sequence", width,
                                 "planned, boxes %", "executed, boxes %", "decided, s");
  const auto line = [&](const std::string& agent, const std::string& sequence, const std::string& planned,
                        const std::string& executed, double seconds) {
    text +=
        fmt::format("{:<14} {:<{}}  {:>16}  {:>17}  {:10.2f}\n", agent, sequence, width, planned, executed, seconds);
  };
  for (const CompareRow& row : rows) {
    const task::SessionResult& r = row.result;
    line(r.agent, r.sequence, fmt::format("{:3} {:7.2f}", r.planned_boxes, r.planned_percent),
         fmt::format("{:3} {:7.2f}", r.executed_boxes, r.executed_percent), r.decision_seconds_median);
  }
  for (const std::string& agent : agents_of(rows)) {
    const Means means = means_of(rows, agent);
    line(agent, fmt::format("mean {}", means.count), fmt::format("{:7.2f}", means.planned),
         fmt::format("{:7.2f}", means.executed), means.seconds);
  }
  return text;
}

}  // namespace

std::string format_compare_json(const std::vector<CompareRow>& rows) {
  nlohmann::ordered_json json{{"rows", nlohmann::ordered_json::array()}, {"means", nlohmann::ordered_json::array()}};
  for (const CompareRow& row : rows) {
    const task::SessionResult& r = row.result;
    json["rows"].push_back({{"agent", r.agent},
                            {"sequence", r.sequence},
                            {"planned_boxes", r.planned_boxes},
                            {"planned_percent", r.planned_percent},
                            {"executed_boxes", r.executed_boxes},
                            {"executed_percent", r.executed_percent},
                            {"decision_seconds_median", r.decision_seconds_median},
                            {"seed", row.seed},
                            {"failure", r.failure}});
  }
  for (const std::string& agent : agents_of(rows)) {
    const Means means = means_of(rows, agent);
    json["means"].push_back({{"agent", agent},
                             {"sequences", means.count},
                             {"planned_percent", means.planned},
                             {"executed_percent", means.executed},
                             {"decision_seconds_median", means.seconds}});
  }
  return json.dump(2) + "\n";
}

std::string format_compare_csv(const std::vector<CompareRow>& rows) {
  std::string text =
      "agent,sequence,planned_boxes,planned_percent,executed_boxes,executed_percent,decision_seconds_median,seed\n";
  for (const CompareRow& row : rows) {
    const task::SessionResult& r = row.result;
    text +=
        fmt::format("{},{},{},{:.4f},{},{:.4f},{:.4f},{}\n", csv_cell(r.agent), csv_cell(r.sequence), r.planned_boxes,
                    r.planned_percent, r.executed_boxes, r.executed_percent, r.decision_seconds_median, row.seed);
  }
  return text;
}

std::string format_compare_table(const model::Scenario& scenario, const std::vector<CompareRow>& rows,
                                 bool with_references) {
  std::vector<std::string> sequences;
  bool are_short = true;
  for (const CompareRow& row : rows) {
    if (std::ranges::find(sequences, row.result.sequence) == sequences.end()) sequences.push_back(row.result.sequence);
    are_short = are_short && row.result.sequence.size() <= 2;
  }
  if (!are_short || sequences.size() > kMostColumns) return format_lines(rows);
  return format_columns(scenario, rows, sequences, with_references);
}

}  // namespace snug::app
