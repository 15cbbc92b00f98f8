// run: the program's controller and the cell, one period after the other, without a clock.
#include "apps/snug/run/run.hpp"

#include <fmt/format.h>

#include <atomic>
#include <cstdio>

#include "apps/snug/command_line/stop_signal.hpp"
#include "apps/snug/serve/serve_ur.hpp"
#include "apps/snug/serve/served_runs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/served_ur/controller.hpp"
#include "snug/urscript/program.hpp"

namespace snug::app {
namespace {

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

}  // namespace

int run_script(const RunOptions& options) {
  const std::string text = load_program(options.program);
  const ur::Model model = ur_model_of(options.cell.ur.model);
  ServedRuns runs(options.cell, served_ur::Controller::period_of(model));
  served_ur::ControllerSettings settings;
  settings.model = model;
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

}  // namespace snug::app
