// The rows of a comparison as text: tables for people, JSON and CSV for programs; each row as soon as it is known.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "snug/core/csv_cell.hpp"
#include "snug/model/reported_agent.hpp"
#include "snug/study/calibration_json.hpp"
#include "snug/study/comparison.hpp"

namespace snug::study {
namespace {

using Json = nlohmann::ordered_json;

template <class Get>
std::vector<std::string> distinct(const std::vector<SessionRow>& rows, const Get& get) {
  std::vector<std::string> words;
  for (const SessionRow& row : rows) {
    if (std::ranges::find(words, get(row)) == words.end()) words.push_back(get(row));
  }
  return words;
}

/// Of those that were sent, in percent.
std::string percent_as_planned(const AgentSummary& all) {
  return all.sent > 0 ? fmt::format("{:.2f} %", 100.0 * all.as_planned / all.sent) : std::string("-");
}

const model::Reported* find_reported(const model::Sequence& sequence, const std::string& agent) {
  const auto found = std::ranges::find(sequence.reported, agent, &model::Reported::agent);
  return found != sequence.reported.end() ? &*found : nullptr;
}

std::string label_of(const std::string& reporter) { return "reported, " + model::split_agent(reporter).name; }

std::string cell_of(int boxes, double percent) { return fmt::format("  {:3} / {:5.2f}", boxes, percent); }

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

constexpr const char* kRow =
    "{:<14} {:<10} {:>6} {:>6}  {:>4} {:>7}  {:>4} {:>7}  {:>5} {:>10} {:>5} {:>10}  {:>7} {:>9}  {:>7}  {}\n";

std::string summary_line(const std::string& label, const AgentSummary& all) {
  return fmt::format("{:<25} {:4}  {:7.2f} {:7.2f} {:7.2f} - {:5.2f}  {:5} {:>11} {:5} {:10}  {:7.0f} {:9.0f}\n", label,
                     all.count, all.executed, all.deviation, all.lowest, all.highest, all.sent, percent_as_planned(all),
                     all.lost, all.recoveries, all.boxes_per_hour, all.boxes_per_hour_with_planning);
}

/// Predicted success beside what happened.
std::string calibration_lines(const std::string& agent, const Calibration& calibration) {
  std::string text;
  for (std::size_t i = 0; i < calibration.bins.size(); ++i) {
    const CalibrationBin& bin = calibration.bins[i];
    if (bin.motions == 0) continue;
    text += fmt::format("{:<25} {:3} - {:3} %  {:7} {:10.1f} % {:9.1f} %\n", agent, 10 * i, 10 * (i + 1), bin.motions,
                        100.0 * bin.predicted / bin.motions, 100.0 * bin.succeeded / bin.motions);
  }
  return text;
}

/// `rows`: those that count; `interrupted`: how many do not.
std::string format_table_end(const model::Scenario& scenario, const std::vector<SessionRow>& rows,
                             std::size_t interrupted, bool with_references) {
  std::string text =
      "\nexecuted filling, %        runs     mean      sd           range   sent as planned  lost recoveries  "
      "boxes/h  with plan\n";
  const std::vector<std::string> sequences = distinct(rows, [](const SessionRow& row) { return row.point.sequence; });
  for (const std::string& agent : distinct(rows, [](const SessionRow& row) { return row.point.agent; })) {
    const AgentSummary all = summarize(rows, agent);
    const bool has_spread = all.count > static_cast<int>(sequences.size());
    if (has_spread && sequences.size() > 1 && sequences.size() <= 12) {
      for (const std::string& sequence : sequences) {
        text += summary_line(agent + ", sequence " + sequence, summarize(rows, agent, sequence));
      }
    }
    text += summary_line(agent, all);
    if (all.before_skips < all.executed - 1e-9) {
      text += fmt::format("{:<25}       {:7.2f} before the first item was skipped\n", "", all.before_skips);
    }
  }
  if (interrupted > 0) text += fmt::format("not counted: {} that were interrupted\n", interrupted);
  std::string lines;
  for (const std::string& agent : distinct(rows, [](const SessionRow& row) { return row.point.agent; })) {
    lines += calibration_lines(agent, summarize(rows, agent).calibration);
  }
  if (!lines.empty()) text += "\nsuccess of motions         predicted  motions   predicted   observed\n" + lines;
  if (!with_references || sequences.empty()) return text;
  const std::vector<std::string> reporters = reporters_of(scenario, sequences);
  if (reporters.empty()) return text;
  std::size_t width = 22;
  for (const std::string& agent : reporters) width = std::max(width, label_of(agent).size());
  text += fmt::format("\n{:<{}}", "boxes / filling, %", width);
  for (const std::string& sequence : sequences) text += fmt::format("  {:>11}", "sequence " + sequence);
  text += "    mean\n";
  for (const std::string& agent : reporters) text += reporter_line(scenario, sequences, agent, width);
  return text;
}

Json as_json(const SessionRow& row) {
  return {{"agent", row.point.agent},
          {"sequence", row.point.sequence},
          {"planned_boxes", row.planned_boxes},
          {"planned_percent", row.planned_percent},
          {"executed_boxes", row.executed_boxes},
          {"executed_percent", row.executed_percent},
          {"percent_before_skips", row.percent_before_skips},
          {"decision_seconds_median", row.decision_seconds_median},
          {"seed", row.seed},
          {"plant_seed", row.point.plant_seed},
          {"items_sent", row.items_sent},
          {"items_as_planned", row.items_as_planned},
          {"boxes_lost", row.boxes_lost},
          {"recoveries", row.recoveries},
          {"boxes_per_hour", row.boxes_per_hour},
          {"boxes_per_hour_with_planning", row.boxes_per_hour_with_planning},
          {"stop_reason", row.stop_name()},
          {"failure", row.failure}};
}

std::string format_json_end(const std::vector<SessionRow>& rows, std::size_t interrupted) {
  Json means = Json::array();
  for (const std::string& agent : distinct(rows, [](const SessionRow& row) { return row.point.agent; })) {
    const AgentSummary all = summarize(rows, agent);
    means.push_back({{"agent", agent},
                     {"sequences", distinct(rows, [](const SessionRow& row) { return row.point.sequence; }).size()},
                     {"runs", all.count},
                     {"planned_percent", all.planned},
                     {"executed_percent", all.executed},
                     {"executed_percent_sd", all.deviation},
                     {"executed_percent_lowest", all.lowest},
                     {"executed_percent_highest", all.highest},
                     {"percent_before_skips", all.before_skips},
                     {"items_sent", all.sent},
                     {"items_as_planned", all.as_planned},
                     {"boxes_lost", all.lost},
                     {"recoveries", all.recoveries},
                     {"boxes_per_hour", all.boxes_per_hour},
                     {"boxes_per_hour_with_planning", all.boxes_per_hour_with_planning},
                     {"decision_seconds_median", all.decision_seconds},
                     {"calibration", calibration_json(all.calibration)}});
  }
  return fmt::format("\n],\n\"interrupted\": {},\n\"means\": {}}}\n", interrupted, means.dump(2));
}

}  // namespace

std::string format_compare_head(CompareForm form) {
  if (form == CompareForm::Json) return "{\"rows\": [";
  if (form == CompareForm::Csv) {
    return "agent,sequence,planned_boxes,planned_percent,executed_boxes,executed_percent,decision_seconds_median,seed,"
           "plant_seed,items_sent,items_as_planned,boxes_lost,recoveries,percent_before_skips,stop_reason,boxes_per_"
           "hour,failure,boxes_per_hour_with_planning\n";
  }
  return fmt::format(fmt::runtime(kRow), "agent", "sequence", "seed", "plant", "plan", "%", "exec", "%", "sent",
                     "as planned", "lost", "recoveries", "boxes/h", "with plan", "dec., s", "stopped");
}

std::string format_compare_row(CompareForm form, const SessionRow& row, bool is_first) {
  if (form == CompareForm::Json) return (is_first ? "\n" : ",\n") + as_json(row).dump();
  if (form == CompareForm::Csv) {
    return fmt::format("{},{},{},{:.4f},{},{:.4f},{:.4f},{},{},{},{},{},{},{:.4f},{},{:.1f},{},{:.1f}\n",
                       csv_cell(row.point.agent), csv_cell(row.point.sequence), row.planned_boxes, row.planned_percent,
                       row.executed_boxes, row.executed_percent, row.decision_seconds_median, row.seed,
                       row.point.plant_seed, row.items_sent, row.items_as_planned, row.boxes_lost, row.recoveries,
                       row.percent_before_skips, csv_cell(row.stop_name()), row.boxes_per_hour, csv_cell(row.failure),
                       row.boxes_per_hour_with_planning);
  }
  return fmt::format(fmt::runtime(kRow), row.point.agent, row.point.sequence, row.seed, row.point.plant_seed,
                     row.planned_boxes, fmt::format("{:.2f}", row.planned_percent), row.executed_boxes,
                     fmt::format("{:.2f}", row.executed_percent), row.items_sent, row.items_as_planned, row.boxes_lost,
                     row.recoveries, fmt::format("{:.0f}", row.boxes_per_hour),
                     fmt::format("{:.0f}", row.boxes_per_hour_with_planning),
                     fmt::format("{:.2f}", row.decision_seconds_median), row.stop_name());
}

std::string format_compare_end(CompareForm form, const model::Scenario& scenario, const std::vector<SessionRow>& rows,
                               bool with_references) {
  std::vector<SessionRow> whole;
  std::ranges::copy_if(rows, std::back_inserter(whole), [](const SessionRow& row) { return !row.is_interrupted(); });
  const std::size_t interrupted = rows.size() - whole.size();
  if (form == CompareForm::Json) return format_json_end(whole, interrupted);
  return form == CompareForm::Csv ? std::string() : format_table_end(scenario, whole, interrupted, with_references);
}

}  // namespace snug::study
