// pack: packs a sequence, item by item, and says how that went.
#include "pack.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <span>

#include "pack_report.hpp"
#include "python_agent.hpp"
#include "robot_warnings.hpp"
#include "run_report.hpp"
#include "snug/cell/run.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/write_file.hpp"
#include "snug/task/executions.hpp"

namespace snug::app {
namespace {

/// The finished program once more, recorded; why that run had to stop, or nothing.
std::string record(const PackOptions& options, const model::Scenario& scenario, const task::SessionResult& result,
                   const task::SessionOptions& session, OutputFile& file) {
  cell::RunOptions run;
  run.program = result.program;
  run.program_text = motion::format_program(result.program);
  run.sequence = options.sequence;
  run.simulation = session.simulation;
  run.record_file = &file;
  run.version = SNUG_VERSION;
  run.describe = [](const cell::RunResult& one) { return format_json(one); };
  return cell::run(scenario, run).failure;
}

/// Any parcel of the files that the sequence's boxes come from.
packing::FutureModel own_future(const SourcedScenario& loaded, const std::string& name) {
  packing::FutureModel future;
  const model::Sequence* sequence = model::find_sequence(loaded.scenario, name);
  if (sequence == nullptr) return future;  // refused later, with the names that there are
  std::size_t begin = 0;
  for (const std::size_t end : loaded.ends) {
    const auto parcels = std::span(loaded.scenario.parcels).subspan(begin, end - begin);
    begin = end;
    const bool is_source = std::ranges::any_of(sequence->items, [&](const model::Item& item) {
      return std::ranges::find(parcels, item.parcel, &model::Parcel::id) != parcels.end();
    });
    if (!is_source) continue;
    packing::FutureModel part = packing::make_future_model(loaded.scenario, parcels);
    std::ranges::move(part.kinds, std::back_inserter(future.kinds));
    std::ranges::move(part.weights, std::back_inserter(future.weights));
  }
  return future;
}
/// The files that were asked for, reserved before the work begins.
struct PackFiles {
  std::optional<OutputFile> program, plan, record;

  PackFiles(const PackOptions& options, const model::Scenario& scenario) {
    NamedFiles outputs;
    add_file(outputs, "--program", options.program);
    add_file(outputs, "--plan", options.plan);
    add_file(outputs, "-o", options.record);
    expect_distinct(files_of(options.scenario, options.changes, scenario), outputs);
    program = reserve(options.program);
    plan = reserve(options.plan);
    record = reserve_recording(options.record);
  }
};

}  // namespace

task::SessionOptions make_session_options(const PackOptions& options, const SourcedScenario& loaded,
                                          const std::string& sequence) {
  task::SessionOptions session;
  session.agent = options.agent;
  if (is_python_agent(options.agent)) session.ask = start_python_agent(options.agent);
  session.packing.seed = options.seed.value_or(loaded.scenario.seed);
  if (options.future == "own") session.future = own_future(loaded, sequence);
  session.packing.decision_time = options.decision_time;
  session.threads = options.threads.value_or(core_count());
  session.packing.threads = session.threads;
  session.samples = options.samples;
  if (options.look == "noisy") session.perception = task::Perception::Noisy;
  if (options.look == "dead-reckoning") session.perception = task::Perception::DeadReckoning;
  session.simulation.robot = options.robot.value_or("");
  if (options.robot) print_robot_warnings(loaded.scenario);
  return session;
}

task::Progress make_progress_line(const std::string& label) {
  if (isatty(STDERR_FILENO) == 0) return {};
  return [label](const task::SessionResult& so_far, int item, int items) {
    const bool is_last = item == items || !so_far.stopped.empty();
    const std::string line = fmt::format("{}: item {} of {}, {} packed, {:.1f} %", label, item, items,
                                         so_far.executed_boxes, so_far.executed_percent);
    std::fprintf(stderr, "\r%-78s%s", line.c_str(), is_last ? "\r\033[K" : "");
    std::fflush(stderr);
  };
}

int run_pack(const PackOptions& options) {
  const SourcedScenario loaded = load_with_sources(options.scenario, options.changes);
  const model::Scenario& scenario = loaded.scenario;
  const task::SessionOptions session = make_session_options(options, loaded, options.sequence);
  PackFiles files(options, scenario);
  const task::SessionResult result =
      task::pack(scenario, options.sequence, session, make_progress_line("sequence " + options.sequence));
  task::ExecutionResult executions;
  if (options.executions) {
    task::ExecutionOptions repeated;
    repeated.count = *options.executions;
    repeated.seed = session.packing.seed;
    repeated.threads = session.threads;
    repeated.simulation = session.simulation;
    executions = task::repeat(scenario, result, repeated);
  }
  const bool has_program = !result.program.waypoints.empty();
  std::string failure = result.failure;
  if (files.program && has_program) write_file(std::move(*files.program), motion::format_program(result.program));
  if (files.plan) write_file(std::move(*files.plan), format_plan(result));
  if (files.record && has_program) {
    const std::string recorded = record(options, scenario, result, session, *files.record);
    if (failure.empty()) failure = recorded;
  }
  const std::string text = options.json ? format_json(result, executions) : format_table(result, executions);
  print(text);
  if (failure.empty() && executions.failed > 0) {
    failure = fmt::format("{} of {} executions did not reach their end", executions.failed, executions.count);
  }
  if (failure.empty() && !has_program && (options.program || options.record)) {
    failure = "nothing was packed: no program, no recording";
  }
  if (failure.empty()) return kSuccess;
  std::fprintf(stderr, "snug: failed: %s\n", failure.c_str());
  return kRunFailed;
}

}  // namespace snug::app
