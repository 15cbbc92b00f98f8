// A comparison as a study of `snug pack`: a row for each session.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/snug/compare/compare.hpp"
#include "apps/snug/compare/compare_page.hpp"
#include "snug/study/table.hpp"

namespace snug::app {

/// What one session is of.
struct SessionPoint {
  std::string agent, sequence;
  std::uint64_t plant_seed = 0;
  bool is_random = false;  ///< the sequence is drawn
};

/// The file of a study has at most 100 000 values.
inline constexpr std::size_t kMostSessions = 20000;

/// The recording that --runs leaves of a session: its number, then what it is of.
[[nodiscard]] std::string recording_of(const CompareOptions& options, std::size_t index, const SessionPoint& point);

/// Its text is a file of a study (docs/studies.md). `seed`: of the planner; at most kMostSessions points.
[[nodiscard]] study::Study make_compare_study(const CompareOptions& options, std::uint64_t seed,
                                              const std::vector<SessionPoint>& points);

/// What a row gave; one that broke off has its last words as failure.
[[nodiscard]] CompareSession read_session(const model::Scenario& scenario, const study::Study& study,
                                          const SessionPoint& point, std::uint64_t seed,
                                          const study::RowResult& result);

}  // namespace snug::app
