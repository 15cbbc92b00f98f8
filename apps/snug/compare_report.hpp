// The rows of a comparison as text: tables for people, JSON and CSV for programs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snug/task/session.hpp"

namespace snug::app {

/// One agent on one sequence.
struct CompareRow {
  task::SessionResult result;
  std::uint64_t seed = 0;
};

/// Few sequences beside each other, many below each other. `with_references`: what the report's Table 7 counted, where
/// the sequences are its own.
[[nodiscard]] std::string format_compare_table(const model::Scenario& scenario, const std::vector<CompareRow>& rows,
                                               bool with_references);
/// The keys are described in docs/packing-execution.md.
[[nodiscard]] std::string format_compare_json(const std::vector<CompareRow>& rows);
[[nodiscard]] std::string format_compare_csv(const std::vector<CompareRow>& rows);

}  // namespace snug::app
