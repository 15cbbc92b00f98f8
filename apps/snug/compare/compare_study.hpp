// A comparison as a study of `snug pack`: the words that repeat each session, and the file of --dir.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/snug/pack/pack.hpp"
#include "snug/study/comparison.hpp"

namespace snug::app {

/// The words of `snug compare`.
struct CompareOptions {
  PackOptions pack;  ///< scenario, seeds, perception, robot, decision time, threads, samples
  int plants = 1;    ///< of the seeds pack.plant_seed and those after it
  std::optional<std::string>
      sequences;               ///< "all", or names, separated by commas; absent: all, or the random ones alone
  std::string agents = "all";  ///< or names, separated by commas
  int random = 0;              ///< so many random sequences beside them
  std::uint64_t random_seed = 1;
  bool json = false;
  bool csv = false;
  std::optional<std::string> page;  ///< HTML file
  std::optional<std::string> runs;  ///< folder for a recording and a report page of every session
  std::optional<std::string> dir;   ///< folder that keeps the rows, so that the same words go on after a kill
};

/// Tables of a study are read by people too; `snug study` runs more.
inline constexpr std::size_t kMostSessions = 20000;

/// The recording that --runs leaves of a session: its number, then what it is of.
[[nodiscard]] std::string recording_path(const std::string& folder, std::size_t index,
                                         const study::SessionPoint& point);

/// Its text is a file of a study (docs/studies.md). `seed`: of the planner; 1 to kMostSessions points.
[[nodiscard]] study::Study make_compare_study(const CompareOptions& options, std::uint64_t seed,
                                              const std::vector<study::SessionPoint>& points);

}  // namespace snug::app
