// view --live --click: a cell that another program serves, in the browser while it is driven.
#include "apps/snug/view/view.hpp"

#include <atomic>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "apps/snug/command_line/stop_signal.hpp"
#include "apps/snug/command_line/version.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/remote_plant/watched_cell.hpp"
#include "snug/runs/recorder.hpp"

namespace snug::app {
namespace {

constexpr std::chrono::milliseconds kBetweenObservations(8);  // at most 125 answers a second are the watcher's

/// Observes the cell until told to stop; each run, from time 0 to the next reset, is one of `live`.
class Watch {
 public:
  Watch(remote_plant::WatchedCell& cell, serve::LiveRun& live) : cell_(cell), live_(live) {}

  void stop() { is_stopped_ = true; }

  /// Empty, or why the cell cannot be seen any more.
  std::string run() {
    begin();
    std::string trouble;
    while (!is_stopped_ && trouble.empty()) {
      std::this_thread::sleep_for(kBetweenObservations);
      trouble = cell_.look();
      if (trouble.empty()) show();
    }
    finish(trouble);
    return trouble;
  }

 private:
  void begin() {
    const cell::Simulation& simulation = cell_.simulation();
    runs::RecorderSetup setup;
    setup.observer = &live_;
    setup.period = simulation.scenario().controller.tick;
    setup.sequence = simulation.sequence().name;
    setup.version = version_text();
    recorder_.emplace(simulation.scenario(), simulation.world(), setup);
    add();
  }

  void show() {
    if (cell_.time() < last_) finish("");
    if (recorder_ ? cell_.time() > last_ : cell_.time() > 0.0) recorder_ ? add() : begin();
  }

  void add() {
    last_ = cell_.time();
    const cell::Simulation& simulation = cell_.simulation();
    const cell::CellState state = cell_.state();
    runs::FrameInput input;
    input.X_WE = input.X_WE_command = state.arm->machine.tool.X_WE;
    if (!recorder_->add_frame(simulation.world(), state.world, work_.physics, {}, input)) finish("");
  }

  /// The page keeps the run that is over until the next one moves.
  void finish(const std::string& why) {
    if (recorder_) live_.finish("", why);
    recorder_.reset();
    last_ = 0.0;
  }

  remote_plant::WatchedCell& cell_;
  serve::LiveRun& live_;
  cell::CellWorkspace work_ = cell_.simulation().make_workspace();
  std::optional<runs::Recorder> recorder_;
  double last_ = 0.0;  ///< s, simulated
  std::atomic<bool> is_stopped_ = false;
};

}  // namespace

int view_served(const ViewOptions& options) {
  const model::Scenario scenario = load_with_overrides(options.run);
  if (scenario.sequences.empty()) throw InputError(scenario.source_name, "sequences", "", "a sequence of boxes");
  remote_plant::WatchedCell cell(scenario, options.run.sequence.value_or(scenario.sequences.front().name),
                                 *options.click, options.client.patience, click::find_client_keys(options.client.keys));
  serve::LiveRun live(std::filesystem::path(options.run.scenario).stem().string(), 0.0);
  serve::Server server(options.server, {std::string(viewer_page()), {}, &live, true});
  Watch watch(cell, live);
  const StopSignal signal([&] {
    watch.stop();
    live.stop();
    server.stop();
  });
  std::string trouble;
  std::thread looking([&] {
    trouble = watch.run();
    if (!trouble.empty())
      std::fprintf(stderr, "snug: the cell is seen no more: %s\n", printable(trouble, kLongestMessage).c_str());
  });
  announce(server.address(), !options.is_quiet);
  server.run();
  looking.join();
  return trouble.empty() ? kSuccess : kRunFailed;
}

}  // namespace snug::app
