// What became of a study's rows in a call, and how far it is: a few lines for people, JSON for programs.
#include "snug/study/study_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace snug::study {
namespace {

double seconds_left(const Status& status) {
  return status.mean_seconds * static_cast<double>(status.rows - status.done);
}

}  // namespace

std::string format_run_text(const Folder& folder, const RunSummary& summary, double wall) {
  return fmt::format(
      "rows done now      {}, {} failed\nfolder             {}\nwall clock         {:.1f} s, {:.1f} s in rows\n",
      summary.done, summary.failed, folder.path().string(), wall, summary.row_seconds);
}

std::string format_run_json(const Study& study, const Folder& folder, const RunSummary& summary, double wall,
                            int processes) {
  const double rows = static_cast<double>(std::max<std::uint64_t>(1, summary.done));
  const double busy = wall * std::min<double>(processes, rows);
  const double overhead = summary.row_seconds > 0.0 ? 100.0 * (busy - summary.row_seconds) / summary.row_seconds : 0.0;
  const nlohmann::ordered_json json{{"study", study.name},          {"folder", folder.path().string()},
                                    {"done", summary.done},         {"failed", summary.failed},
                                    {"left_out", summary.left_out}, {"row_seconds", summary.row_seconds},
                                    {"wall_seconds", wall},         {"overhead_percent", overhead}};
  return json.dump(2) + "\n";
}

std::string format_status_text(const Status& status) {
  return fmt::format(
      "rows               {} of {} done, {} failed\nchunks             {} of {} done\n"
      "a row              {:.2f} s on average, {:.0f} s left on one core\n",
      status.done, status.rows, status.failed, status.chunks_done, status.chunks, status.mean_seconds,
      seconds_left(status));
}

std::string format_status_json(const Study& study, const Status& status) {
  const nlohmann::ordered_json json{{"study", study.name},
                                    {"rows", status.rows},
                                    {"done", status.done},
                                    {"failed", status.failed},
                                    {"chunks", status.chunks},
                                    {"chunks_done", status.chunks_done},
                                    {"mean_seconds", status.mean_seconds},
                                    {"seconds_left_on_one_core", seconds_left(status)}};
  return json.dump(2) + "\n";
}

}  // namespace snug::study
