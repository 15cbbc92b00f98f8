// bench: runs the bench scenes, prints every figure beside its target.
#include "bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "outputs.hpp"
#include "shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/experiment/bench.hpp"

namespace snug::app {
namespace {

/// Where the scenario files are: under the present folder, or with the program.
std::filesystem::path find_scenarios() {
  return std::filesystem::is_directory("scenarios/bench") ? "scenarios" : shipped_folder() / "scenarios";
}

std::string as_json(const std::vector<experiment::Figure>& figures) {
  nlohmann::ordered_json document = {{"results", nlohmann::ordered_json::array()}};
  for (const experiment::Figure& figure : figures) {
    document["results"].push_back({{"name", figure.name},
                                   {"value", figure.value},
                                   {"unit", figure.unit},
                                   {"target", figure.target},
                                   {"ok", figure.ok}});
    if (!figure.skipped.empty()) document["results"].back()["skipped"] = figure.skipped;
  }
  const model::SolverSettings solver;
  document["settings"] = {{"tolerance_m_s", solver.tolerance},
                          {"max_sweeps", solver.max_sweeps},
                          {"position_slop_m", solver.position_slop}};
  return document.dump(2) + "\n";
}

std::string as_table(const std::vector<experiment::Figure>& figures) {
  std::string text = fmt::format("{:<34} {:>12} {:<6} {:<10} {}\n", "figure", "value", "unit", "target", "met");
  for (const experiment::Figure& figure : figures) {
    const std::string value = figure.skipped.empty() ? fmt::format("{:.4g}", figure.value) : "-";
    const std::string met = !figure.skipped.empty() ? "skipped: " + figure.skipped
                            : figure.target.empty() ? ""
                            : figure.ok             ? "yes"
                                                    : "NO";
    text += fmt::format("{:<34} {:>12} {:<6} {:<10} {}\n", figure.name, value, figure.unit, figure.target, met);
  }
  const model::SolverSettings solver;
  return text + fmt::format("\nsolver of every scenario: tolerance {} m/s, at most {} sweeps, slop {} m\n",
                            solver.tolerance, solver.max_sweeps, solver.position_slop);
}

}  // namespace

int run_bench(const BenchOptions& options) {
  experiment::BenchOptions bench;
  const std::filesystem::path scenarios = find_scenarios();
  bench.scenes = scenarios / "bench";
  bench.scenario = scenarios / "box-demonstrator.yaml";
  bench.sensors = scenarios / "sensors/demonstrator.yaml";
  bench.program = scenarios.parent_path() / "../shared/data/waypoints/poses1real.csv";
  bench.corrections = "seq1";
  bench.cup_data = scenarios.parent_path() / "../shared/data/cup";
  bench.instances = scenarios.parent_path() / "../shared/data/packing";
  if (!std::filesystem::exists(bench.program)) {
    bench.program = "out/sequence-1.csv";  // what `make demo` leaves
    bench.corrections.clear();
  }
  bench.hard_scenes = scenarios.parent_path() / "../shared/data/scenes";
  bench.drop_scenes = options.drops;
  bench.only = options.only.value_or("");
  const std::vector<experiment::Figure> figures = experiment::run_bench(bench);
  if (figures.empty())
    throw InputError("command line", "--only", "'" + bench.only + "'", "the start of a figure's name");
  print(options.json ? as_json(figures) : as_table(figures));
  const bool all_met = std::all_of(figures.begin(), figures.end(), [](const auto& figure) { return figure.ok; });
  return all_met ? kSuccess : kRunFailed;
}

}  // namespace snug::app
