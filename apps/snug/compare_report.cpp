// The rows of a comparison as text: tables for people, JSON and CSV for programs.
#include "compare_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "snug/core/csv_cell.hpp"
#include "snug/model/reported_agent.hpp"

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

const model::Reported* find_reported(const model::Sequence& sequence, const std::string& agent) {
  const auto found = std::ranges::find(sequence.reported, agent, &model::Reported::agent);
  return found != sequence.reported.end() ? &*found : nullptr;
}

std::string label_of(const std::string& reporter) { return "reported, " + model::split_agent(reporter).name; }

std::string cell_of(int boxes, double percent) { return fmt::format("  {:3} / {:5.2f}", boxes, percent); }

std::string agent_lines(const std::vector<CompareRow>& rows, const std::string& agent, std::size_t width) {
  std::string planned = fmt::format("{:<{}} planned ", agent, width - 9);
  std::string executed = fmt::format("{:<{}} executed", "", width - 9);
  for (const CompareRow& row : rows) {
    if (row.result.agent != agent) continue;
    planned += cell_of(row.result.planned_boxes, row.result.planned_percent);
    executed += cell_of(row.result.executed_boxes, row.result.executed_percent);
  }
  const Means means = means_of(rows, agent);
  return fmt::format("{}   {:5.2f}\n{}   {:5.2f}\n", planned, means.planned, executed, means.executed);
}

/// What others packed of every one of these sequences, as the scenario says, in the order of the first: percent of the
/// scenario's container.
std::vector<std::string> reporters_of(const model::Scenario& scenario, const std::vector<std::string>& sequences) {
  std::vector<std::string> agents;
  for (const model::Reported& one : model::find_sequence(scenario, sequences.front())->reported) {
    if (std::ranges::all_of(sequences, [&](const std::string& name) {
          const model::Reported* found = find_reported(*model::find_sequence(scenario, name), one.agent);
          return found != nullptr && found->packed_count.has_value();
        })) {
      agents.push_back(one.agent);
    }
  }
  return agents;
}

std::string reporter_line(const model::Scenario& scenario, const std::vector<std::string>& sequences,
                          const std::string& agent, std::size_t width) {
  const model::Container& container = *model::find_container(scenario, scenario.target);
  std::string line = fmt::format("{:<{}}", label_of(agent), width);
  double sum = 0.0;
  for (const std::string& name : sequences) {
    const model::Sequence& sequence = *model::find_sequence(scenario, name);
    const int boxes = *find_reported(sequence, agent)->packed_count;
    const double percent =
        model::compute_filling_degree_percent(scenario, container, model::first_parcels(sequence, boxes));
    sum += percent;
    line += cell_of(boxes, percent);
  }
  return fmt::format("{}   {:5.2f}\n", line, sum / static_cast<double>(sequences.size()));
}

/// Sequences beside each other, agents below each other.
std::string format_columns(const model::Scenario& scenario, const std::vector<CompareRow>& rows,
                           const std::vector<std::string>& sequences, bool with_references) {
  const std::vector<std::string> reporters =
      with_references ? reporters_of(scenario, sequences) : std::vector<std::string>{};
  std::size_t width = 22;
  for (const std::string& agent : agents_of(rows)) width = std::max(width, agent.size() + 9);
  for (const std::string& agent : reporters) width = std::max(width, label_of(agent).size());
  std::string text = fmt::format("{:<{}}", "boxes / filling, %", width);
  for (const std::string& sequence : sequences) text += fmt::format("  {:>11}", "sequence " + sequence);
  text += "    mean\n";
  for (const std::string& agent : agents_of(rows)) text += agent_lines(rows, agent, width);
  for (const std::string& agent : reporters) text += reporter_line(scenario, sequences, agent, width);
  return text;
}

/// A line for each row: for many sequences, or long names.
std::string format_lines(const std::vector<CompareRow>& rows) {
  std::size_t width = 8, agent_width = 14;
  for (const CompareRow& row : rows) {
    width = std::max(width, row.result.sequence.size());
    agent_width = std::max(agent_width, row.result.agent.size());
  }
  std::string text = fmt::format("{:<{}} {:<{}}  {:>16}  {:>16}  {:>10}\n", "agent", agent_width, "sequence", width,
                                 "planned, boxes %", "executed, boxes %", "decided, s");
  const auto line = [&](const std::string& agent, const std::string& sequence, const std::string& planned,
                        const std::string& executed, double seconds) {
    text += fmt::format("{:<{}} {:<{}}  {:>16}  {:>17}  {:10.2f}\n", agent, agent_width, sequence, width, planned,
                        executed, seconds);
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
