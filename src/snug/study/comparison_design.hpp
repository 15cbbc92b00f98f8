// comparison_design: what a comparison runs: agents x sequences x plants, and the study of `snug pack` that says the
// same.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "snug/study/comparison.hpp"
#include "snug/study/design.hpp"

namespace snug::study {

/// Tables of a study are read by people too; `snug study` runs more.
inline constexpr std::size_t kMostSessions = 20000;

struct ComparisonChoice {
  int plants = 1;  ///< of the seeds plant_seed and those after it
  std::uint64_t plant_seed = 1;
  std::optional<std::string>
      sequences;               ///< "all", or names, separated by commas; absent: all, or the random ones alone
  std::string agents = "all";  ///< or names, separated by commas, module:Class of Python among them
  int random = 0;              ///< so many random sequences beside them, in plants of their own
  std::uint64_t random_seed = 1;
  std::optional<std::string> recordings;  ///< folder for a recording of every session
};

struct ComparisonDesign {
  std::vector<std::string> agents, sequences;
  std::vector<SessionPoint> points;  ///< by agent, then sequence, then plant
};

/// Every agent packs every sequence in every plant. Adds the random sequences, every box in random order, to the
/// scenario. Throws InputError for names that there are not and for more than kMostSessions.
[[nodiscard]] ComparisonDesign design_comparison(const ComparisonChoice& choice, model::Scenario& scenario);

/// The recording of a session: its number, then what it is of.
[[nodiscard]] std::string recording_path(const std::string& folder, std::size_t index, const SessionPoint& point);

/// Its text is a file of a study (docs/studies.md). `options`: of `snug pack`, that all sessions have.
[[nodiscard]] Study make_comparison_study(const ComparisonChoice& choice, const std::string& scenario_file,
                                          const std::vector<std::pair<std::string, std::string>>& options,
                                          const std::vector<SessionPoint>& points);

}  // namespace snug::study
