// The rows of a comparison as text: tables for people, JSON and CSV for programs; each row as soon as it is known.
#pragma once

#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/study/calibration.hpp"

namespace snug::app {

enum class CompareForm { Table, Json, Csv };

/// One agent on one sequence in one plant: what is kept of a session.
struct CompareRow {
  std::string agent, sequence;
  std::uint64_t seed = 0, plant_seed = 0;
  int planned_boxes = 0, executed_boxes = 0;
  double planned_percent = 0.0, executed_percent = 0.0, percent_before_skips = 0.0;
  double decision_seconds_median = 0.0;
  double boxes_per_hour = 0.0, boxes_per_hour_with_planning = 0.0;
  int items_sent = 0, items_as_planned = 0, boxes_lost = 0, recoveries = 0;
  study::Calibration calibration;
  std::string stop_reason;
  std::string failure;  ///< empty, or why the robot did not come home, or the session broke off

  /// By who started it: what it has packed is less than its agent would have.
  [[nodiscard]] bool is_interrupted() const;
};

/// The text in pieces: what was printed when a run is killed is whole rows.
[[nodiscard]] std::string format_compare_head(CompareForm form);
[[nodiscard]] std::string format_compare_row(CompareForm form, const CompareRow& row, bool is_first);
/// Mean, standard deviation and range of each agent, over sessions that were not interrupted; in tables what the report
/// counted, where the sequences are its own (`with_references`).
[[nodiscard]] std::string format_compare_end(CompareForm form, const model::Scenario& scenario,
                                             const std::vector<CompareRow>& rows, bool with_references);

}  // namespace snug::app
