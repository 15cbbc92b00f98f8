// identify scene: loads a task and its recordings, searches, prints what was found and what it is worth.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/identify/identify.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/write_file.hpp"
#include "snug/identification/fitted_scenario.hpp"
#include "snug/identification/scene_fit.hpp"
#include "snug/identification/scene_page.hpp"
#include "snug/identification/scene_text.hpp"

namespace snug::app {
namespace {

struct IdentifySceneOptions {
  std::string task;
  std::vector<std::string> recordings;                        ///< those of the task unless given
  bool floor = false;                                         ///< only the error that noise of the start sets
  bool evaluate = false;                                      ///< only the errors of the task's present values
  std::optional<std::uint64_t> global, local, scatter, seed;  ///< instead of the task's
  std::optional<std::string> log;                             ///< of points tried
  std::optional<std::string> output;                          ///< the task with the values found
  std::optional<std::string> scenario;                        ///< the scenario with the values found
  std::optional<std::string> page;                            ///< what was found and what it improved
  std::optional<int> threads;                                 ///< absent: all cores
  bool profile = false;                                       ///< intervals by the profile of the sum of squares
  bool json = false;
};

using identification::SceneError;
using identification::SceneExperiment;
using identification::SceneFit;

/// A line on a terminal's stderr, a few times a second.
std::function<void(const identification::SceneFitProgress&)> make_progress() {
  if (isatty(STDERR_FILENO) == 0) return {};
  return [last = std::chrono::steady_clock::time_point()](const identification::SceneFitProgress& progress) mutable {
    const auto now = std::chrono::steady_clock::now();
    if (now - last < std::chrono::milliseconds(300)) return;
    last = now;
    std::fprintf(stderr, "\r%s: %d evaluations, best cost %.5g\033[K", progress.phase, progress.evaluations,
                 progress.cost);
  };
}

void apply(const IdentifySceneOptions& options, model::SearchSettings& search) {
  const auto set = [](const std::optional<std::uint64_t>& value, int& field) {
    if (value) field = static_cast<int>(*value);
  };
  set(options.scatter, search.scatter);
  set(options.global, search.global);
  set(options.local, search.local);
  if (options.seed) search.seed = *options.seed;
}

int evaluate(const SceneExperiment& experiment, bool floor, bool json) {
  const SceneError error =
      experiment.summarize(floor ? experiment.evaluate_floor(experiment.start(), experiment.task().search.seed)
                                 : identification::evaluate_scene(experiment, experiment.start()));
  print(json ? format_json(error) : format_table(error));
  return error.failed == error.recordings ? kRunFailed : kSuccess;
}

int run_identify_scene(const IdentifySceneOptions& options) {
  model::SceneTask task = model::load_scene_task(options.task);
  if (!options.recordings.empty()) task.recordings = {options.recordings.begin(), options.recordings.end()};
  if (task.recordings.empty())
    throw InputError(options.task, "recordings", "none, and no --recordings", "at least one file that was recorded");
  NamedFiles inputs = {{"the task", options.task}, {"the scenario", task.scenario}}, outputs;
  for (const std::filesystem::path& file : task.recordings) inputs.push_back({"a recording", file});
  add_file(outputs, "-o", options.output);
  add_file(outputs, "--scenario", options.scenario);
  add_file(outputs, "--page", options.page);
  add_file(outputs, "--log", options.log);
  expect_distinct(inputs, outputs);
  std::optional<OutputFile> output = reserve(options.output), scenario = reserve(options.scenario),
                            page = reserve(options.page);
  apply(options, task.search);
  const int threads = options.threads.value_or(core_count());
  std::vector<identification::RecordedMotion> motions = identification::load_motions(task, task.recordings);
  const SceneExperiment experiment(std::move(task), std::move(motions), threads);
  if (options.evaluate || options.floor) return evaluate(experiment, options.floor, options.json);
  identification::SceneFitOptions fit_options;
  if (options.log) fit_options.log = *options.log;
  fit_options.progress = make_progress();
  fit_options.with_profile = options.profile;
  const SceneFit fit = identification::identify_scene(experiment, fit_options);
  if (fit_options.progress) std::fprintf(stderr, "\r\033[K");
  if (output) {
    const std::vector<double> values(fit.values.data(), fit.values.data() + fit.values.size());
    write_file(std::move(*output), model::text_with_values(experiment.task(), values,
                                                           std::filesystem::path(*options.output).parent_path()));
  }
  if (scenario || page) {
    const identification::FittedScenario found = identification::fitted_scenario(experiment, fit);
    if (scenario) write_file(std::move(*scenario), found.scenario.source_text);
    if (page) write_file(std::move(*page), identification::make_page(experiment, fit, found.changes));
  }
  print(options.json ? format_json(fit) : format_table(fit));
  return fit.is_trusted ? kSuccess : kRunFailed;
}

constexpr const char* kSceneHelp =
    R"(The task names a scenario, the recorded bodies, and the unknown parameters of the scenario, with bounds. scene first shows
what each of them changes; it names combinations that the recordings do not determine, and leaves them unchanged. Then it
searches, and gives standard errors. Each fifth recording is held back and predicted. Task files: docs/identification.md.
Examples:
  snug identify scene scenarios/tosses/task.yaml --recordings scenarios/tosses/example.csv --evaluate --json
  snug identify scene scenarios/tosses/task.yaml --recordings scenarios/tosses/example.csv --local 10 --log points.csv --page found.html)";

}  // namespace

void add_identify_scene(const Verb& verb) {
  const Verb part = verb.part("scene", "estimate parameters of a scenario from recordings of its bodies", kSceneHelp);
  IdentifySceneOptions& options = part.runs(run_identify_scene);
  part.option("task", options.task, "TASK.yaml", "unknown parameters, and what was recorded").required();
  part.option("--recordings", options.recordings, "FILE", "recordings to use instead of those of the task");
  part.flag("--evaluate", options.evaluate, "only report the errors of the task's present values on all recordings");
  part.flag("--floor", options.floor, "only report the error that noise of the start alone causes")
      .excludes({"--evaluate"});
  part.option("--scatter", options.scatter, "N", "points spread over the bounds before the search", whole(0, 1000000));
  part.option("--global", options.global, "N", "evaluations of the global search", whole(0, 1000000));
  part.option("--local", options.local, "N", "evaluations of the local search", whole(0, 1000000));
  part.option("--seed", options.seed, "N", "seed of the searches", whole(0));
  part.option("--log", options.log, "FILE.csv", "file of the points tried; points in it are not computed again");
  add_threads(part, options.threads);
  part.option("-o,--output", options.output, "TASK.yaml", "write the task with the values found");
  part.flag("--profile", options.profile,
            "compute 95 % intervals by the profile likelihood: each value with all others fitted again (takes longer)");
  part.option("--scenario", options.scenario, "SCENARIO.yaml",
              "write the scenario with the values found and their remaining uncertainty");
  part.option("--page", options.page, "FILE.html", "write a page: what was found and improved");
  add_json(part, options.json);
}

}  // namespace snug::app
