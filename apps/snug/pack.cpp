// pack: packs a sequence, item by item, and says how that went.
#include "pack.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <thread>

#include "pack_report.hpp"
#include "robot_warnings.hpp"
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

}  // namespace

task::SessionOptions make_session_options(const PackOptions& options, const model::Scenario& scenario) {
  task::SessionOptions session;
  session.agent = options.agent;
  session.packing.seed = options.seed.value_or(scenario.seed);
  session.packing.decision_time = options.decision_time;
  session.threads = options.threads.value_or(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  session.packing.threads = session.threads;
  session.samples = options.samples;
  if (options.look == "noisy") session.perception = task::Perception::Noisy;
  if (options.look == "dead-reckoning") session.perception = task::Perception::DeadReckoning;
  session.simulation.robot = options.robot.value_or("");
  if (options.robot) print_robot_warnings(scenario);
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
  const model::Scenario scenario = load_changed(options.scenario, options.changes);
  const task::SessionOptions session = make_session_options(options, scenario);
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
  if (!has_program && (options.program || options.record)) {
    std::fputs("snug: nothing was packed: no program, no recording\n", stderr);
  }
  const std::string text = options.json ? format_json(result, executions) : format_table(result, executions);
  std::fputs(text.c_str(), stdout);
  return kSuccess;
}

}  // namespace snug::app
