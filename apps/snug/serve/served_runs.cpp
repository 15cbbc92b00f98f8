// ServedRuns: the cell that is served, and what becomes of each run of it: recording, page, printed result.
#include "apps/snug/serve/served_runs.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/version.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "apps/snug/view/view.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/writer.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/runs/run_table.hpp"
#include "snug/serve/live_simulation.hpp"
#include "snug/simulated_plant/simulated_plant.hpp"

namespace snug::app {
namespace {

std::string sequence_of(const ServeOptions& options, const model::Scenario& scenario) {
  return options.sequence.value_or(scenario.sequences.front().name);
}

model::Scenario load(const ServeOptions& options, std::optional<double> tick) {
  model::Scenario scenario = load_changed(options.scenario, options.changes);
  if (tick) scenario.controller.tick = *tick;
  apply(options.physics, scenario);
  if (!scenario.robot) throw InputError(scenario.source_name, "robot", "", "a robot, to be driven");
  if (scenario.sequences.empty()) throw InputError(scenario.source_name, "sequences", "", "a sequence of boxes");
  print_robot_warnings(scenario);
  model::leave_out(scenario, sequence_of(options, scenario), options.skipped);
  if (!options.plant_seed) return scenario;
  const std::string sequence = sequence_of(options, scenario);
  (void)cell::require_sequence(scenario, sequence);
  return simulated_plant::draw_plant(scenario, sequence, *options.plant_seed);
}

cell::SimulationOptions simulation_options(const ServeOptions& options, const model::Scenario& scenario) {
  cell::SimulationOptions simulation;
  simulation.robot = options.robot.value_or(scenario.robot->name);
  if (options.physics.cup) simulation.cup = cup::cup_mode_of(*options.physics.cup, "command line");
  return simulation;
}

/// "run.h5", "run-2.h5", ...
std::string name_of_run(const std::string& path, int run) {
  if (run == 1) return path;
  const std::filesystem::path file(path);
  return (file.parent_path() / (file.stem().string() + fmt::format("-{}", run) + file.extension().string())).string();
}

}  // namespace

ServedRuns::ServedRuns(const ServeOptions& options, std::optional<double> tick)
    : options_(options),
      scenario_(load(options, tick)),
      simulation_(scenario_, sequence_of(options, scenario_), simulation_options(options, scenario_)) {
  if (options.record) {
    expect_distinct(files_of(options.scenario, options.changes, scenario_), {{"-o", *options.record}});
    record_ = reserve_recording(options.record);
  }
}

ServedRuns::~ServedRuns() { end_page(); }

void ServedRuns::begin_page() {
  if (!options_.shows) return;
  live_.emplace(std::filesystem::path(options_.scenario).stem().string(), 0.0);
  shown_ = std::make_unique<serve::ShownRun>(*live_);
  page_.emplace(options_.page, serve::Content{std::string(viewer_page()), {}, &*live_, true});
  announce(page_->address(), !options_.is_quiet);
  page_thread_ = std::thread([this] { page_->run(); });
}

void ServedRuns::end_page() {
  if (!page_thread_.joinable()) return;
  page_->stop();
  page_thread_.join();
}

void ServedRuns::release() {
  if (live_) live_->stop();
}

runs::OutsideRunOptions ServedRuns::begin(int run) {
  runs::OutsideRunOptions run_options;
  run_options.version = version_text();
  run_options.describe = [](const runs::RunResult& result) { return runs::format_result(result); };
  if (options_.record) {
    if (run > 1) record_ = record::reserve_recording(name_of_run(*options_.record, run));
    run_options.record_file = &*record_;
  }
  run_options.observer = shown_.get();
  return run_options;
}

void ServedRuns::end(int run, const runs::RunResult& result) {
  const std::string json = runs::format_result(result);
  if (options_.json) {
    print(nlohmann::ordered_json::parse(json).dump() + "\n");
  } else {
    print(fmt::format("run {}, ended: {}\n{}", run, result.ended_by, format_table(result)));
  }
  std::fflush(stdout);
  if (live_) live_->finish(json, result.failure.text);
  has_failed_ = static_cast<bool>(result.failure);
}

void print_lateness(const served_cell::Pacer& pacer) {
  constexpr double kUs = 1e6;
  const served_cell::Histogram& late = pacer.lateness();
  if (late.count() == 0) return;
  std::fprintf(stderr,
               "snug: real time: %lld steps; late by %.0f us (median), %.0f us (99 %%), %.0f us (worst); %lld by "
               "more than a step\n",
               static_cast<long long>(late.count()), kUs * late.quantile(0.5), kUs * late.quantile(0.99),
               kUs * late.worst(), static_cast<long long>(pacer.missed()));
}

}  // namespace snug::app
