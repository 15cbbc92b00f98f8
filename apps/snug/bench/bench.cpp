// bench: how fast and how accurate the physics is, beside its targets.
#include "apps/snug/command_line/verbs.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/study/study.hpp"
#include "bench/figures/figure_text.hpp"
#include "snug/core/input_error.hpp"
#include "snug/study/factor_runs.hpp"
#include "snug/study/row_values.hpp"

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

/// Each scene by itself in a process of its own, one after the other: none measures what another left behind.
std::vector<bench::Figure> run_scenes(const std::vector<std::string>& scenes, const BenchOptions& options) {
  std::vector<bench::Figure> figures;
  const auto tell = [&](const study::RowResult& result, const std::string& said) {
    std::fputs(said.c_str(), stderr);
    const nlohmann::ordered_json list = study::RowValues(result).list("results");
    if (list.empty() && result.exit_code != kBadInput)  // else there is no such figure here
      throw std::runtime_error("bench " + scenes[result.row] + ": " + result.error);
    for (const auto& json : list) figures.push_back(bench::read_figure(json));
  };
  study::run_factor(
      {.name = "bench",
       .verb = "bench",
       .scenario = {},
       .options = {"--drops", std::to_string(options.drops)},
       .option = "--only",
       .values = scenes,
       .outputs = {{"results"}}},
      [](const std::vector<std::string>& words) { return run_row(words); }, "bench", tell);
  std::erase_if(figures, [&](const auto& figure) { return !figure.name.starts_with(options.only.value_or("")); });
  return figures;
}

int run_bench(const BenchOptions& options) {
  bench::BenchOptions bench = bench::find_inputs(find_scenarios());
  bench.drop_scenes = options.drops;
  bench.only = options.only.value_or("");
  const std::vector<std::string> scenes = bench::bench_scenes(bench.only);
  const std::vector<bench::Figure> figures = scenes.size() > 1 ? run_scenes(scenes, options) : bench::run_bench(bench);
  if (figures.empty())
    throw InputError("command line", "--only", "'" + bench.only + "'", "the start of a figure's name");
  print(options.json ? bench::format_json(figures) : bench::format_table(figures));
  return std::ranges::all_of(figures, &bench::Figure::ok) ? kSuccess : kRunFailed;
}

}  // namespace

void add_bench(CLI::App& app, Action& action) {
  const Verb verb(
      app, action, "bench", "measure speed and accuracy and compare them with their targets",
      "Examples:\n  snug bench\n  snug bench --json --only s1\n  snug bench camera\n  snug bench --only packing\n  "
      "snug bench --only identification\n  snug bench piles\n  snug bench heaps.3000\n  snug bench drops --drops 1000");
  BenchOptions& options = verb.runs(run_bench);
  add_json(verb, options.json);
  verb.option("--only", options.only, "NAME", "only figures whose name starts with this, such as s3");
  verb.option("figures", options.only, "NAME", "the same as --only").excludes({"--only"});
  verb.option("--drops", options.drops, "N", "random drops to run for the figures drops.*; a thousand take minutes",
              whole(4, kMostThings));
}

}  // namespace snug::app
