// compare: the agents side by side on the sequences of a scenario, planned and executed.
#include "compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>

#include "snug/core/input_error.hpp"

namespace snug::app {
namespace {

struct Row {
  task::SessionResult result;
  std::uint64_t seed = 0;
};

/// "all" or a list, each checked against what there is.
std::vector<std::string> choose(const std::string& words, const std::vector<std::string>& known, const char* key) {
  if (words == "all") return known;
  std::vector<std::string> chosen;
  std::stringstream text(words);
  for (std::string word; std::getline(text, word, ',');) {
    if (std::ranges::find(known, word) == known.end()) {
      throw InputError("command line", key, "'" + word + "'", fmt::format("all, or of {}", fmt::join(known, ", ")));
    }
    chosen.push_back(word);
  }
  if (chosen.empty()) throw InputError("command line", key, "nothing", "all, or names separated by commas");
  return chosen;
}

std::string format_json(const std::vector<Row>& rows) {
  nlohmann::ordered_json json{{"rows", nlohmann::ordered_json::array()}};
  for (const Row& row : rows) {
    const task::SessionResult& r = row.result;
    json["rows"].push_back({{"agent", r.agent},
                            {"sequence", r.sequence},
                            {"planned_boxes", r.planned_boxes},
                            {"planned_percent", r.planned_percent},
                            {"executed_boxes", r.executed_boxes},
                            {"executed_percent", r.executed_percent},
                            {"decision_seconds_median", r.decision_seconds_median},
                            {"seed", row.seed}});
  }
  return json.dump(2) + "\n";
}

std::string format_csv(const std::vector<Row>& rows) {
  std::string text =
      "agent,sequence,planned_boxes,planned_percent,executed_boxes,executed_percent,decision_seconds_median,seed\n";
  for (const Row& row : rows) {
    const task::SessionResult& r = row.result;
    text += fmt::format("{},{},{},{:.4f},{},{:.4f},{:.4f},{}\n", r.agent, r.sequence, r.planned_boxes,
                        r.planned_percent, r.executed_boxes, r.executed_percent, r.decision_seconds_median, row.seed);
  }
  return text;
}

std::string agent_lines(const std::vector<Row>& rows, const std::string& agent) {
  std::string planned = fmt::format("{:<14} planned ", agent), executed = fmt::format("{:<14} executed", "");
  double planned_sum = 0.0, executed_sum = 0.0;
  int count = 0;
  for (const Row& row : rows) {
    if (row.result.agent != agent) continue;
    planned += fmt::format("  {:3} / {:5.2f}", row.result.planned_boxes, row.result.planned_percent);
    executed += fmt::format("  {:3} / {:5.2f}", row.result.executed_boxes, row.result.executed_percent);
    planned_sum += row.result.planned_percent;
    executed_sum += row.result.executed_percent;
    ++count;
  }
  return fmt::format("{}   {:5.2f}\n{}   {:5.2f}\n", planned, planned_sum / count, executed, executed_sum / count);
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

std::string format_table(const model::Scenario& scenario, const std::vector<Row>& rows,
                         const std::vector<std::string>& agents, const std::vector<std::string>& sequences) {
  std::string text = fmt::format("{:<23}", "boxes / filling, %");
  for (const std::string& sequence : sequences) text += fmt::format("  {:>11}", "sequence " + sequence);
  text += "    mean\n";
  for (const std::string& agent : agents) text += agent_lines(rows, agent);
  return text + reference_lines(scenario, sequences);
}

}  // namespace

int run_compare(const CompareOptions& options) {
  const model::Scenario scenario = load_packing_scenario(options.pack);
  std::vector<std::string> known;
  for (const model::Sequence& sequence : scenario.sequences) known.push_back(sequence.name);
  const std::vector<std::string> sequences = choose(options.sequences, known, "--sequences");
  const std::vector<std::string> agents = choose(options.agents, packing::agent_names(), "--agents");
  std::vector<Row> rows;
  for (const std::string& agent : agents) {
    for (const std::string& sequence : sequences) {
      PackOptions pack = options.pack;
      pack.agent = agent;
      const task::SessionOptions session = make_session_options(pack, scenario);
      rows.push_back({task::pack(scenario, sequence, session, make_progress_line(agent + ", sequence " + sequence)),
                      session.packing.seed});
    }
  }
  const std::string text = options.json  ? format_json(rows)
                           : options.csv ? format_csv(rows)
                                         : format_table(scenario, rows, agents, sequences);
  std::fputs(text.c_str(), stdout);
  return kSuccess;
}

}  // namespace snug::app
