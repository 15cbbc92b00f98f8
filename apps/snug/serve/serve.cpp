// serve: the cell as a CLICK simulator that controllers in other programs drive.
#include "apps/snug/serve/serve.hpp"

#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <exception>

#include "apps/snug/command_line/stop_signal.hpp"
#include "apps/snug/serve/serve_ur.hpp"
#include "apps/snug/serve/served_runs.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {
namespace {

/// What a run is ended by that its controller begins anew: the first one is not over with that.
constexpr const char* kResetByController = "reset by the controller";

control::DriveKind kind_of(const std::string& word) {
  return word == "position"   ? control::DriveKind::Position
         : word == "velocity" ? control::DriveKind::Speed
                              : control::DriveKind::Torque;
}

/// What is typed on stdin, a line at a time: how many steps may be done.
class StepLines {
 public:
  int read() {
    char bytes[256];
    const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (count == 0) return -1;  // nobody will type any more
    if (count > 0) text_.append(bytes, static_cast<std::size_t>(count));
    int steps = 0;
    for (std::size_t end = text_.find('\n'); end != std::string::npos; end = text_.find('\n')) {
      const std::string line = text_.substr(0, end);
      text_.erase(0, end + 1);
      if (line == "c") return -1;
      if (line == "r") return served_cell::kReset;
      steps += steps_of(line);
    }
    if (text_.size() > 4096) text_.clear();
    return steps;
  }

 private:
  static int steps_of(const std::string& line) {
    if (line.empty()) return 1;
    int steps = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), steps);
    if (error == std::errc() && end == line.data() + line.size() && steps > 0 && steps <= 1000000) return steps;
    std::fprintf(stderr, "snug: '%s': an empty line, a number of steps, c or r is expected\n", line.c_str());
    return 0;
  }
  std::string text_;
};

class Serving {
 public:
  explicit Serving(const ServeOptions& options) : options_(options), runs_(options) {
    if (options.runs_at_once && !options.server.is_async) {
      throw InputError("command line", "--run-at-once", "without --async",
                       "--async: else steps are those that a controller asks for");
    }
    served_cell::SimulatorSettings settings;
    settings.cell = options.cell;
    settings.cell.controls.clear();
    for (const std::string& word : options.controls) settings.cell.controls.push_back(kind_of(word));
    settings.cell.is_plant = options.plant_seed.has_value();
    settings.cell.rpy = *click::parse_rpy_order(options.rpy);
    settings.is_async = options.server.is_async;
    settings.runs_at_once = options.runs_at_once;
    settings.batch = options.batch;
    settings.begin_run = [this](int run) { return runs_.begin(run); };
    settings.end_run = [this](int run, const runs::RunResult& result) {
      runs_.end(run, result);
      has_run_ = true;
      if (options_.once && result.ended_by != kResetByController) server_->stop();
    };
    simulator_.emplace(runs_.simulation(), std::move(settings));
    served_cell::ServerSettings server = options.server;
    if (options.keys) server.keys = click::load_server_keys(*options.keys);
    server.log = [](const std::string& line) { std::fprintf(stderr, "snug: %s\n", line.c_str()); };
    server.controller_left = [this] {
      if (options_.once && has_run_) server_->stop();
    };
    server.steps_fd = STDIN_FILENO;
    server.read_steps = [this] { return lines_.read(); };
    server_.emplace(*simulator_, std::move(server));
  }

  int run() {
    runs_.begin_page();
    const StopSignal signal([this] {
      runs_.release();
      server_->stop();
    });
    std::fprintf(stderr, "snug: serving %s at %s (Ctrl-C ends it)\n", runs_.simulation().scenario().source_name.c_str(),
                 server_->endpoint().c_str());
    server_->run();
    simulator_->end("the server was stopped");
    runs_.end_page();
    report();
    return options_.once && runs_.has_failed() ? kRunFailed : kSuccess;
  }

 private:
  void report() const {
    constexpr double kUs = 1e6;
    const served_cell::ServerTimes& times = server_->times();
    const served_cell::SimulatorCounts& counts = simulator_->counts();
    std::fprintf(
        stderr,
        "snug: %lld steps, %lld answers, %lld of them errors; median of an answer %.0f us, %.0f us without the cell\n",
        static_cast<long long>(counts.steps), static_cast<long long>(counts.replies),
        static_cast<long long>(counts.errors), kUs * times.service.quantile(0.5), kUs * times.own.quantile(0.5));
    print_lateness(server_->pacer());
  }

  const ServeOptions& options_;
  ServedRuns runs_;
  StepLines lines_;
  bool has_run_ = false;
  std::optional<served_cell::Simulator> simulator_;
  std::optional<served_cell::Server> server_;
};

}  // namespace

int run_serve(const ServeOptions& options) {
  if (options.ur.host) return run_serve_ur(options);
  return Serving(options).run();
}

}  // namespace snug::app
