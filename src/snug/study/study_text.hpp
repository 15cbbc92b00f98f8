// What became of a study's rows in a call, and how far it is: a few lines for people, JSON for programs.
#pragma once

#include <string>

#include "snug/study/merge.hpp"
#include "snug/study/run.hpp"

namespace snug::study {

/// `wall`: s, of the call; what of it was in no row is overhead, with `processes` rows at a time.
[[nodiscard]] std::string format_run_text(const Folder& folder, const RunSummary& summary, double wall);
[[nodiscard]] std::string format_run_json(const Study& study, const Folder& folder, const RunSummary& summary,
                                          double wall, int processes);
[[nodiscard]] std::string format_status_text(const Status& status);
[[nodiscard]] std::string format_status_json(const Study& study, const Status& status);

}  // namespace snug::study
