// pack: packs a sequence, item by item, and says how that went.
#include "pack.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <span>
#include <thread>

#include "pack_report.hpp"
#include "run_report.hpp"
#include "snug/cell/run.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/task/executions.hpp"

namespace snug::app {
namespace {

/// The finished program once more, recorded.
void record(const PackOptions& options, const model::Scenario& scenario, const task::SessionResult& result,
            const task::SessionOptions& session) {
  cell::RunOptions run;
  run.program = result.program;
  run.program_text = motion::format_program(result.program);
  run.sequence = options.sequence;
  run.simulation = session.simulation;
  run.record_path = *options.record;
  run.version = SNUG_VERSION;
  run.describe = [](const cell::RunResult& one) { return format_json(one); };
  (void)cell::run(scenario, run);
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

}  // namespace

task::SessionOptions make_session_options(const PackOptions& options, const SourcedScenario& loaded,
                                          const std::string& sequence) {
  task::SessionOptions session;
  session.agent = options.agent;
  session.packing.seed = options.seed.value_or(loaded.scenario.seed);
  if (options.future == "own") session.future = own_future(loaded, sequence);
  session.packing.decision_time = options.decision_time;
  session.threads = options.threads.value_or(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  session.packing.threads = session.threads;
  session.samples = options.samples;
  if (options.look == "noisy") session.perception = task::Perception::Noisy;
  if (options.look == "dead-reckoning") session.perception = task::Perception::DeadReckoning;
  session.simulation.robot = options.robot.value_or("");
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
  if (options.program && has_program) motion::write_program(result.program, *options.program);
  if (options.plan) write_file(*options.plan, format_plan(result));
  if (options.record && has_program) record(options, scenario, result, session);
  const bool is_missing = !has_program && (options.program || options.record);
  if (is_missing) std::fputs("snug: nothing was packed: no program, no recording\n", stderr);
  const std::string text = options.json ? format_json(result, executions) : format_table(result, executions);
  std::fputs(text.c_str(), stdout);
  return is_missing ? kRunFailed : kSuccess;
}

}  // namespace snug::app
