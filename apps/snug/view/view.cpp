// view: the page of the report, served on this machine: for recordings, or for a simulation that goes on.
#include "apps/snug/view/view.hpp"

#include <spawn.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/snug/command_line/stop_signal.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "apps/snug/common/robot_files.hpp"
#include "apps/snug/view/view_served.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/runs/run_table.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to the program

namespace snug::app {
namespace {

void open_browser(const std::string& address) {
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) return;
  std::string program = "xdg-open", word = address;
  char* words[] = {program.data(), word.data(), nullptr};
  pid_t child = 0;
  if (::posix_spawnp(&child, program.c_str(), nullptr, nullptr, words, environ) == 0) {
    std::thread([child] { ::waitpid(child, nullptr, 0); }).detach();
  }
}

int view_recordings(const ViewOptions& options) {
  serve::Content content;
  content.page = viewer_page();
  for (const std::string& path : options.recordings) {
    record::RecordingReader reader(path);
    const std::string name = std::filesystem::path(path).filename().string();
    const replay::RobotDescription robot = find_robot(reader, path, options.urdf);
    content.recordings.push_back({name, replay::encode_recording(reader, name, options.selection, robot)});
  }
  serve::Server server(options.server, std::move(content));
  const StopSignal signal([&] { server.stop(); });
  announce(server.address(), options.opens_browser);
  server.run();
  return kSuccess;
}

/// The result without how long it took: a run that is watched waits for its watchers.
std::string describe_watched(const runs::RunResult& result) {
  auto json = nlohmann::ordered_json::parse(runs::format_result(result));
  json.erase("wall_s");
  json.erase("real_time_factor");
  return json.dump(2) + "\n";
}

/// The simulation in a thread of its own; what it throws is thrown again by result().
class LiveSimulation {
 public:
  LiveSimulation(const ViewOptions& options, serve::LiveRun& live) : live_(live) {
    scenario_ = load_with_overrides(options.run);
    run_options_ = make_run_options(options.run, scenario_);
    if (options.run.record) expect_distinct(files_of(options.run, scenario_), {{"-o", *options.run.record}});
    record_ = reserve_recording(options.run.record);
    if (record_) run_options_.record_file = &*record_;
    run_options_.observer = &live;
    run_options_.describe = describe_watched;
  }
  void start(std::function<void()> on_trouble) {
    thread_ = std::thread([this, on_trouble = std::move(on_trouble)] {
      try {
        result_ = runs::run(scenario_, run_options_);
        live_.finish(describe_watched(*result_), result_->failure.text, result_->is_interrupted);
      } catch (const std::exception& error) {
        trouble_ = std::current_exception();
        live_.finish("", error.what());
        on_trouble();
      }
    });
  }
  ~LiveSimulation() { join(); }
  LiveSimulation(const LiveSimulation&) = delete;
  LiveSimulation& operator=(const LiveSimulation&) = delete;

  [[nodiscard]] const runs::RunResult& result() {
    join();
    if (trouble_) std::rethrow_exception(trouble_);
    return *result_;
  }

 private:
  void join() {
    live_.stop();
    if (thread_.joinable()) thread_.join();
  }

  serve::LiveRun& live_;
  model::Scenario scenario_;
  runs::RunOptions run_options_;
  std::optional<OutputFile> record_;
  std::optional<runs::RunResult> result_;
  std::exception_ptr trouble_;
  std::thread thread_;
};

int view_live(const ViewOptions& options) {
  serve::LiveRun live(std::filesystem::path(options.run.scenario).stem().string(), options.speed);
  if (options.is_paused) live.pause();
  LiveSimulation simulation(options, live);
  serve::Server server(options.server, {std::string(viewer_page()), {}, &live});
  const StopSignal signal([&] {
    live.stop();
    server.stop();
  });
  simulation.start([&] { server.stop(); });
  while (!live.wait_for(0, std::chrono::milliseconds(200)) && !live.is_over()) continue;  // bad input shows here
  if (!live.is_over() || live.whole_form()) announce(server.address(), options.opens_browser);
  server.run();
  const runs::RunResult& result = simulation.result();
  print(format_table(result));
  if (!result.failure) return kSuccess;
  std::fprintf(stderr, "snug: failed: %s\n", result.failure.text.c_str());
  return kRunFailed;
}

}  // namespace

void announce(const std::string& address, bool opens_browser) {
  std::fprintf(stderr, "snug: showing at %s (Ctrl-C ends it)\n", address.c_str());
  if (opens_browser) open_browser(address);
}

int run_view(const ViewOptions& options) {
  if (options.run.scenario.empty()) return view_recordings(options);
  return options.click ? view_served(options) : view_live(options);
}

}  // namespace snug::app
