// Repeated runs: what became of each, and how far they spread.
#include "snug/study/repeated_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "snug/study/factor_runs.hpp"
#include "snug/study/row_values.hpp"

namespace snug::study {

RepeatedRun read_repeated_run(const RowResult& result) {
  const RowValues values(result);
  RepeatedRun run;
  for (const auto& box : values.list("boxes")) {
    ++run.boxes;
    run.packed += box.at("state") == "packed" ? 1 : 0;
  }
  run.filling_degree_percent = values.number("filling_degree_percent");
  run.worst_repick_mm = values.number("repick_offset_worst_mm");
  run.state_hash = values.word("state_hash");
  run.failure = run.state_hash.empty() ? result.error : values.word("failure");
  return run;
}

std::vector<RepeatedRun> repeat_runs(const std::string& scenario, const std::vector<std::string>& options, int count,
                                     int processes, const Verb& verb) {
  FactorRuns factor{
      .name = "--monte-carlo",
      .verb = "simulate",
      .scenario = scenario,
      .options = options,
      .option = "--draw",
      .values = {},
      .outputs = {{"filling_degree_percent"}, {"boxes"}, {"repick_offset_worst_mm"}, {"state_hash"}, {"failure"}},
      .processes = std::min(processes, count)};
  for (int draw = 1; draw <= count; ++draw) factor.values.push_back(std::to_string(draw));
  std::vector<RepeatedRun> runs;
  run_factor(factor, verb, "runs",
             [&](const RowResult& result, const std::string& /*said*/) { runs.push_back(read_repeated_run(result)); });
  return runs;
}

PackedSpread find_spread(const std::vector<RepeatedRun>& runs) {
  PackedSpread spread;
  if (runs.empty()) return {0.0, 0.0, 0.0, 0};
  double sum = 0.0, square = 0.0;
  for (const RepeatedRun& run : runs) {
    const double percent = run.boxes > 0 ? 100.0 * run.packed / run.boxes : 0.0;
    spread.failed += run.failure.empty() ? 0 : 1;
    sum += percent;
    square += percent * percent;
    spread.lowest = std::min(spread.lowest, percent);
  }
  const double count = static_cast<double>(runs.size());
  spread.mean = sum / count;
  spread.deviation = std::sqrt(std::max(0.0, square / count - spread.mean * spread.mean));
  return spread;
}

std::string format_table(const std::vector<RepeatedRun>& runs) {
  std::string text = fmt::format("{:>4} {:>7} {:>10} {:>10}  {:<16} {}\n", "run", "packed", "filling %", "re-pick mm",
                                 "state hash", "failure");
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const RepeatedRun& run = runs[i];
    text += fmt::format("{:>4} {:>4}/{:<2} {:>10.2f} {:>10.1f}  {} {}\n", i + 1, run.packed, run.boxes,
                        run.filling_degree_percent, run.worst_repick_mm, run.state_hash, run.failure);
  }
  const PackedSpread spread = find_spread(runs);
  return text + fmt::format("\npacked             mean {:.1f} %, standard deviation {:.1f} %, lowest {:.1f} %\n",
                            spread.mean, spread.deviation, spread.lowest);
}

std::string format_json(const std::vector<RepeatedRun>& runs) {
  const PackedSpread spread = find_spread(runs);
  nlohmann::ordered_json document = {{"mean_packed_percent", spread.mean},
                                     {"standard_deviation_percent", spread.deviation},
                                     {"lowest_packed_percent", spread.lowest},
                                     {"failed_runs", spread.failed},
                                     {"runs", nlohmann::ordered_json::array()}};
  for (const RepeatedRun& run : runs) {
    document["runs"].push_back({{"packed", run.packed},
                                {"boxes", run.boxes},
                                {"filling_degree_percent", run.filling_degree_percent},
                                {"repick_offset_worst_mm", run.worst_repick_mm},
                                {"state_hash", run.state_hash},
                                {"failure", run.failure}});
  }
  return document.dump(2) + "\n";
}

}  // namespace snug::study
