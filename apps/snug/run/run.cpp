// run: a URScript program on the simulated cell, by the interpreter of the served controller, as fast as it goes.
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>
#include <atomic>
#include <cstdio>
#include <string>

#include "apps/snug/serve/serve.hpp"
#include "apps/snug/serve/served_runs.hpp"
#include "snug/commands/stop_signal.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/served_ur/controller.hpp"
#include "snug/urscript/program.hpp"

namespace snug::app {
namespace {

struct RunOptions {
  std::string program;   ///< URScript
  ServeOptions cell;     ///< scenario, sequence, plant, recording, model
  double until = 600.0;  ///< s
};

constexpr double kSettle = 1.0;  // s, behind the program's end: what was let go comes to rest

std::string load_program(const std::string& file) {
  std::string text = read_file(file, "a URScript program");
  const auto program = urscript::parse(text);
  if (!program)
    throw InputError(fmt::format("{}:{}:{}", file, program.error().line, program.error().column), "",
                     program.error().text, "a URScript program");
  if (program->is_secondary()) throw InputError(file, "sec", "a secondary program", "one that may move the robot: def");
  return text;
}

int run_script(const RunOptions& options) {
  const std::string text = load_program(options.program);
  const ur::Model model = ur_model_of(options.cell.ur.model);
  ServedRuns runs(options.cell, served_ur::Controller::period_of(model));
  served_ur::ControllerSettings settings;
  settings.model = model;
  settings.feeds_when_placed = true;
  settings.begin_run = [&](int run) { return runs.begin(run); };
  settings.end_run = [&](int run, const runs::RunResult& result) { runs.end(run, result); };
  served_ur::Controller controller(runs.simulation(), std::move(settings));
  std::atomic<bool> is_stopped = false;
  const StopSignal signal([&] { is_stopped = true; });
  controller.run_program(text);
  std::string end = "the program came to its end";
  double rest = kSettle;
  while (rest > 0.0) {
    controller.step();
    controller.close_popup();
    const ur::RobotData& data = controller.data();
    if (data.safety_mode != ur::SafetyMode::Normal) {
      end = "the robot stopped";
      break;
    }
    if (data.runtime_state == ur::RuntimeState::Paused) {
      end = "the program was paused: no client sets the input that its watchdog is for";
      break;
    }
    if (is_stopped || data.timestamp >= options.until) {
      end = is_stopped ? "stopped by a signal" : fmt::format("stopped at {} s", options.until);
      break;
    }
    if (data.runtime_state == ur::RuntimeState::Stopped) rest -= served_ur::Controller::period_of(model);
  }
  const std::string failure = controller.program_error();
  const bool has_ended = rest <= 0.0 && failure.empty();
  controller.end(failure.empty() ? end : fmt::format("the program failed: {}", failure));
  if (!has_ended) std::fprintf(stderr, "snug: failed: %s\n", (failure.empty() ? end : failure).c_str());
  return has_ended && !runs.has_failed() ? kSuccess : kRunFailed;
}

constexpr const char* kRunExamples =
    R"(Outputs 0 and 1 are vacuum and blow-off. Input 0 is on when the vacuum is reached, input 1 when a box stands at the aligner.
Popups are closed at once. Exit code 0: the program reached its end; 1: it or the cell failed or stopped; 2: the input cannot be used.
Examples:
  snug export program.csv --scenario scenarios/box-demonstrator.yaml --format urscript -o program.script
  snug run program.script scenarios/box-demonstrator.yaml --sequence 1
  snug run program.script scenarios/box-demonstrator.yaml --sequence 1 --skip BOX024,BOX025
  snug run program.script scenarios/box-demonstrator.yaml --sequence 1 --model ur10e -o run.h5 --json)";

}  // namespace

void add_run(CLI::App& app, Action& action) {
  const Verb verb(app, action, "run", "run a URScript program on the simulated cell", kRunExamples);
  RunOptions& options = verb.runs(run_script);
  ServeOptions& cell = options.cell;
  verb.option("program", options.program, "PROGRAM.script", "URScript program").required();
  add_cell(verb, cell);
  verb.option("--skip", cell.skipped, "BOXES",
              "boxes of the sequence that do not come, separated by commas: those that the session left out")
      .delimiter(',');
  verb.option("--until", options.until, "SECONDS", "stop the program at this simulated time", within(0.0, 86400.0));
}

}  // namespace snug::app
