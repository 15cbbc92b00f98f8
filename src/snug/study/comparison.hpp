// Comparison: sessions of agents x sequences x plants: what each is of, what is kept of it, and what all say together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "snug/study/calibration.hpp"
#include "snug/study/table.hpp"

namespace snug::study {

/// What one session is of: a row of the design.
struct SessionPoint {
  std::string agent, sequence;
  std::uint64_t plant_seed = 0;
  bool is_random = false;  ///< the sequence is drawn
  std::string recording;   ///< file; empty: none
};

/// A box where it is in the end, by the plant's truth.
struct PackedBox {
  std::string id;
  Pose X_TP;  ///< in the container
};

/// What is kept of a session.
struct SessionRow {
  SessionPoint point;
  std::uint64_t seed = 0;
  int planned_boxes = 0, executed_boxes = 0;
  double planned_percent = 0.0, executed_percent = 0.0, percent_before_skips = 0.0;
  double decision_seconds_median = 0.0;  ///< s
  double boxes_per_hour = 0.0, boxes_per_hour_with_planning = 0.0;
  int items_sent = 0, items_as_planned = 0, boxes_lost = 0, recoveries = 0;
  Calibration calibration;
  std::vector<PackedBox> packed;
  std::optional<session::StopReason> stop_reason;  ///< none: it broke off
  std::string failure;  ///< empty, or why the robot did not come home, or the session broke off

  /// What is written into a row's JSON and read from its table, once: `a(name, value)`. The point is not: the design
  /// has it.
  template <class Archive>
  void fields(Archive& a) {
    a("executed_percent", executed_percent);
    a("executed_boxes", executed_boxes);
    a("planned_percent", planned_percent);
    a("planned_boxes", planned_boxes);
    a("items_sent", items_sent);
    a("items_as_planned", items_as_planned);
    a("percent_before_skips", percent_before_skips);
    a("boxes_lost", boxes_lost);
    a("recoveries", recoveries);
    a("boxes_per_hour", boxes_per_hour);
    a("stop_reason", stop_reason);
    a("failure", failure);
    a("calibration", calibration);
    a("boxes", packed);
    a("decision_seconds_median", decision_seconds_median);
    a("boxes_per_hour_with_planning", boxes_per_hour_with_planning);
  }
  /// By who started it: what it has packed is less than its agent would have.
  [[nodiscard]] bool is_interrupted() const { return stop_reason == session::StopReason::Interrupted; }
  [[nodiscard]] std::string stop_name() const;  ///< empty where it broke off
};

/// The outputs of a study that keeps such rows.
[[nodiscard]] std::vector<Output> session_outputs();
[[nodiscard]] SessionRow make_row(const Trial& trial, const SessionPoint& point);
/// As the process of a row prints it, and as the study's runner gives it back. A row without a result has the last
/// words of its process as failure.
[[nodiscard]] std::string format_row(SessionRow row);
[[nodiscard]] SessionRow read_row(const RowResult& result, const SessionPoint& point, std::uint64_t seed);

/// Over the rows of one agent.
struct AgentSummary {
  int count = 0, sent = 0, as_planned = 0, lost = 0, recoveries = 0;
  double planned = 0.0, executed = 0.0, before_skips = 0.0;  ///< means, %
  double deviation = 0.0, lowest = 0.0, highest = 0.0;       ///< of executed, %; the deviation is that of the sample
  double decision_seconds = 0.0;                             ///< s, mean of the medians
  double boxes_per_hour = 0.0, boxes_per_hour_with_planning = 0.0;
  Calibration calibration;
};
/// `sequence`: of that one only; empty: of all.
[[nodiscard]] AgentSummary summarize(const std::vector<SessionRow>& rows, const std::string& agent,
                                     const std::string& sequence = {});

enum class CompareForm { Table, Json, Csv };

/// The text in pieces: what was printed when a run is killed is whole rows.
[[nodiscard]] std::string format_compare_head(CompareForm form);
[[nodiscard]] std::string format_compare_row(CompareForm form, const SessionRow& row, bool is_first);
/// Mean, standard deviation and range of each agent, over sessions that were not interrupted; in tables what others
/// reported of these sequences, where they are the scenario's own (`with_references`).
[[nodiscard]] std::string format_compare_end(CompareForm form, const model::Scenario& scenario,
                                             const std::vector<SessionRow>& rows, bool with_references);

/// A session on the page: its row, the `snug pack` that repeats it, its report page.
struct ComparedSession {
  SessionRow row;
  std::string command;
  std::string report;  ///< file; empty: none was made
};
/// One file without scripts. `page`: the file that it will be; links to reports start at its folder.
[[nodiscard]] std::string format_compare_page(const model::Scenario& scenario,
                                              const std::vector<ComparedSession>& sessions,
                                              const std::filesystem::path& page);

}  // namespace snug::study
