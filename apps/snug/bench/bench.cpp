// bench: how fast and how accurate the physics is, beside its targets.
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "apps/bench/bench.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "apps/snug/study/study.hpp"
#include "snug/core/input_error.hpp"
#include "snug/study/row_values.hpp"
#include "snug/study/run.hpp"

namespace snug::app {
namespace {

struct BenchOptions {
  bool json = false;
  std::optional<std::string> only;  ///< run the scenes whose figures start with this
  int drops = 40;                   ///< random drops
};

/// Where the scenario files are: under the present folder, or with the program.
std::filesystem::path find_scenarios() {
  return std::filesystem::is_directory("scenarios/bench") ? "scenarios" : shipped_folder() / "scenarios";
}

std::string as_json(const std::vector<bench::Figure>& figures) {
  nlohmann::ordered_json document = {{"results", nlohmann::ordered_json::array()}};
  for (const bench::Figure& figure : figures) {
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

bench::Figure read_figure(const nlohmann::ordered_json& json) {
  return {
      json.at("name").get<std::string>(), json.at("value").is_null() ? std::nan("") : json.at("value").get<double>(),
      json.at("unit").get<std::string>(), json.at("target").get<std::string>(),
      json.at("ok").get<bool>(),          json.value("skipped", std::string())};
}

std::string as_table(const std::vector<bench::Figure>& figures) {
  std::string text = fmt::format("{:<34} {:>12} {:<6} {:<10} {}\n", "figure", "value", "unit", "target", "met");
  for (const bench::Figure& figure : figures) {
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

/// Each scene by itself in a process of its own, one after the other: none measures what another left behind.
std::vector<bench::Figure> run_scenes(const std::vector<std::string>& scenes, const BenchOptions& options) {
  study::Study study;
  study.name = study.source = study.verb = "bench";
  study.options = {"--drops", std::to_string(options.drops)};
  study.seed_option.clear();
  study.factors = {{.name = "scene", .option = "--only", .key = {}, .values = scenes}};
  study.point_count = scenes.size();
  study.outputs = {{"results"}};
  study.chunk = static_cast<int>(scenes.size());
  std::vector<bench::Figure> figures;
  study::RunSettings settings;
  settings.tell = [&](const study::RowResult& result, const std::string& said) {
    std::fputs(said.c_str(), stderr);
    const std::string& scene = scenes[result.row];
    const nlohmann::ordered_json list = study::RowValues(result).list("results");
    if (list.empty() && result.exit_code != kBadInput)  // else there is no such figure here
      throw std::runtime_error("bench " + scene + ": " + result.error);
    for (const auto& json : list) figures.push_back(read_figure(json));
  };
  const study::RunSummary summary = study::run_study(
      study, [](const std::vector<std::string>& words) { return run_row(words); }, settings);
  if (summary.left_out > 0) throw std::runtime_error("processes of the bench were killed");
  const std::string only = options.only.value_or("");
  std::erase_if(figures, [&](const auto& figure) { return !figure.name.starts_with(only); });
  return figures;
}

int run_bench(const BenchOptions& options) {
  bench::BenchOptions bench;
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
  const std::vector<std::string> scenes = bench::bench_scenes(bench.only);
  const std::vector<bench::Figure> figures = scenes.size() > 1 ? run_scenes(scenes, options) : bench::run_bench(bench);
  if (figures.empty())
    throw InputError("command line", "--only", "'" + bench.only + "'", "the start of a figure's name");
  print(options.json ? as_json(figures) : as_table(figures));
  const bool all_met = std::all_of(figures.begin(), figures.end(), [](const auto& figure) { return figure.ok; });
  return all_met ? kSuccess : kRunFailed;
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
  const Verb verb(
      app, action, "bench", "measure speed and accuracy, beside their targets",
      "Examples:\n  snug bench\n  snug bench --json --only s1\n  snug bench camera\n  snug bench --only packing\n  "
      "snug bench --only identification\n  snug bench piles\n  snug bench heaps.3000\n  snug bench drops --drops 1000");
  BenchOptions& options = verb.runs(run_bench);
  add_json(verb, options.json);
  verb.option("--only", options.only, "NAME", "only figures whose name starts so, such as s3");
  verb.option("figures", options.only, "NAME", "the same as --only").excludes({"--only"});
  verb.option("--drops", options.drops, "N", "random drops to run for the figures drops.*; a thousand take minutes",
              whole(4, kMostThings));
}

}  // namespace snug::app
