// A comparison as a study of `snug pack`: the words that repeat each session, and the file of --dir.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/snug/compare/compare.hpp"
#include "snug/study/comparison.hpp"

namespace snug::app {

/// Tables of a study are read by people too; `snug study` runs more.
inline constexpr std::size_t kMostSessions = 20000;

/// The recording that --runs leaves of a session: its number, then what it is of.
[[nodiscard]] std::string recording_path(const std::string& folder, std::size_t index,
                                         const study::SessionPoint& point);

/// Its text is a file of a study (docs/studies.md). `seed`: of the planner; 1 to kMostSessions points.
[[nodiscard]] study::Study make_compare_study(const CompareOptions& options, std::uint64_t seed,
                                              const std::vector<study::SessionPoint>& points);

}  // namespace snug::app
