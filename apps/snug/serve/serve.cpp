// serve: the cell as a CLICK simulator that controllers in other programs drive.
#include "apps/snug/serve/serve.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/snug/command_line/stop_signal.hpp"
#include "apps/snug/command_line/version.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "apps/snug/common/robot_warnings.hpp"
#include "apps/snug/view/view.hpp"
#include "snug/core/input_error.hpp"
#include "snug/model/spin.hpp"
#include "snug/record/writer.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/runs/run_table.hpp"
#include "snug/simulated_plant/simulated_plant.hpp"

namespace snug::app {
namespace {

control::DriveKind kind_of(const std::string& word) {
  return word == "position"   ? control::DriveKind::Position
         : word == "velocity" ? control::DriveKind::Speed
                              : control::DriveKind::Torque;
}

std::string sequence_of(const ServeOptions& options, const model::Scenario& scenario) {
  return options.sequence.value_or(scenario.sequences.front().name);
}

model::Scenario load(const ServeOptions& options) {
  model::Scenario scenario = load_changed(options.scenario, options.changes);
  if (options.dt) scenario.time_step = *options.dt;
  model::check_spins(scenario);
  if (options.seed) scenario.seed = *options.seed;
  if (options.record_period) scenario.record_period = *options.record_period;
  if (!scenario.robot) throw InputError(scenario.source_name, "robot", "", "a robot, to be driven");
  if (scenario.sequences.empty()) throw InputError(scenario.source_name, "sequences", "", "a sequence of boxes");
  print_robot_warnings(scenario);
  if (!options.plant_seed) return scenario;
  const std::string sequence = sequence_of(options, scenario);
  (void)cell::require_sequence(scenario, sequence);
  return simulated_plant::draw_plant(scenario, sequence, *options.plant_seed);
}

cell::SimulationOptions simulation_options(const ServeOptions& options, const model::Scenario& scenario) {
  cell::SimulationOptions simulation;
  simulation.robot = options.robot.value_or(scenario.robot->name);
  if (options.cup) simulation.cup = cup::cup_mode_of(*options.cup, "command line");
  return simulation;
}

/// "run.h5", "run-2.h5", ...
std::string name_of_run(const std::string& path, int run) {
  if (run == 1) return path;
  const std::filesystem::path file(path);
  return (file.parent_path() / (file.stem().string() + fmt::format("-{}", run) + file.extension().string())).string();
}

/// Shows one run after the other; lets them go on when there is nobody, or no room, to show them any more.
class ShownRun : public runs::RunObserver {
 public:
  explicit ShownRun(serve::LiveRun& live) : live_(live) {}
  void begin(const record::RecordingHeader& header) override {
    is_shown_ = true;
    live_.begin(header);
  }
  bool add(const record::Frame& frame) override {
    is_shown_ = is_shown_ && live_.add(frame);
    return true;
  }
  void add(const record::Event& event) override {
    if (is_shown_) live_.add(event);
  }

 private:
  serve::LiveRun& live_;
  bool is_shown_ = true;
};

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
  explicit Serving(const ServeOptions& options)
      : options_(options),
        scenario_(load(options)),
        simulation_(scenario_, sequence_of(options, scenario_), simulation_options(options, scenario_)) {
    if (options.record) {
      expect_distinct(files_of(options.scenario, options.changes, scenario_), {{"-o", *options.record}});
      record_ = reserve_recording(options.record);
    }
    served_cell::SimulatorSettings settings;
    settings.cell = options.cell;
    settings.cell.controls.clear();
    for (const std::string& word : options.controls) settings.cell.controls.push_back(kind_of(word));
    settings.cell.is_plant = options.plant_seed.has_value();
    settings.cell.rpy = *click::parse_rpy_order(options.rpy);
    settings.is_async = options.server.is_async;
    settings.batch = options.batch;
    settings.begin_run = [this](int run) { return begin(run); };
    settings.end_run = [this](int run, const runs::RunResult& result) { end(run, result); };
    simulator_.emplace(simulation_, std::move(settings));
    served_cell::ServerSettings server = options.server;
    if (options.keys) server.keys = click::load_server_keys(*options.keys);
    server.log = [](const std::string& line) { std::fprintf(stderr, "snug: %s\n", line.c_str()); };
    server.steps_fd = STDIN_FILENO;
    server.read_steps = [this] { return lines_.read(); };
    server_.emplace(*simulator_, std::move(server));
    if (!options.shows) return;
    live_.emplace(std::filesystem::path(options.scenario).stem().string(), 0.0);
    shown_.emplace(*live_);
    page_.emplace(options.page, serve::Content{std::string(viewer_page()), {}, &*live_, true});
  }

  int run() {
    const StopSignal signal([this] { stop(); });
    std::thread page_thread;
    if (page_) {
      announce(*page_, options_.opens_browser);
      page_thread = std::thread([this] { page_->run(); });
    }
    std::fprintf(stderr, "snug: serving %s at %s (Ctrl-C ends it)\n", simulation_.scenario().source_name.c_str(),
                 server_->endpoint().c_str());
    std::exception_ptr trouble;
    try {
      server_->run();
      simulator_->end("the server was stopped");
    } catch (...) {
      trouble = std::current_exception();
    }
    if (page_) {
      page_->stop();
      page_thread.join();
    }
    if (trouble) std::rethrow_exception(trouble);
    report();
    return options_.once && has_failed_ ? kRunFailed : kSuccess;
  }

 private:
  void stop() {
    if (live_) live_->stop();  // it may be paused
    server_->stop();
  }

  runs::OutsideRunOptions begin(int run) {
    runs::OutsideRunOptions run_options;
    run_options.version = version_text();
    run_options.describe = [](const runs::RunResult& result) { return runs::format_result(result); };
    if (options_.record) {
      if (run > 1) record_ = record::reserve_recording(name_of_run(*options_.record, run));
      run_options.record_file = &*record_;
    }
    if (shown_) run_options.observer = &*shown_;
    return run_options;
  }

  void end(int run, const runs::RunResult& result) {
    const std::string json = runs::format_result(result);
    if (options_.json) {
      print(nlohmann::ordered_json::parse(json).dump() + "\n");
    } else {
      print(fmt::format("run {}, ended: {}\n{}", run, result.ended_by, format_table(result)));
    }
    std::fflush(stdout);
    if (live_) live_->finish(json, result.failure.text);
    has_failed_ = static_cast<bool>(result.failure);
    if (options_.once) server_->stop();
  }

  void report() const {
    constexpr double kUs = 1e6;
    const served_cell::ServerTimes& times = server_->times();
    const served_cell::SimulatorCounts& counts = simulator_->counts();
    std::fprintf(
        stderr,
        "snug: %lld steps, %lld answers, %lld of them errors; median of an answer %.0f us, %.0f us without the cell\n",
        static_cast<long long>(counts.steps), static_cast<long long>(counts.replies),
        static_cast<long long>(counts.errors), kUs * times.service.quantile(0.5), kUs * times.own.quantile(0.5));
    const served_cell::Histogram& late = server_->pacer().lateness();
    if (late.count() == 0) return;
    std::fprintf(stderr,
                 "snug: real time: %lld steps; late by %.0f us (median), %.0f us (99 %%), %.0f us (worst); %lld by "
                 "more than a step\n",
                 static_cast<long long>(late.count()), kUs * late.quantile(0.5), kUs * late.quantile(0.99),
                 kUs * late.worst(), static_cast<long long>(server_->pacer().missed()));
  }

  const ServeOptions& options_;
  model::Scenario scenario_;
  cell::Simulation simulation_;
  std::optional<OutputFile> record_;
  std::optional<serve::LiveRun> live_;
  std::optional<ShownRun> shown_;
  std::optional<serve::Server> page_;
  StepLines lines_;
  bool has_failed_ = false;
  std::optional<served_cell::Simulator> simulator_;
  std::optional<served_cell::Server> server_;
};

}  // namespace

int run_serve(const ServeOptions& options) { return Serving(options).run(); }

}  // namespace snug::app
