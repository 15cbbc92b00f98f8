// WatchedRun: a cell of another program, seen while somebody else drives it: as a run goes on, and as a camera's scene.
#include "snug/remote_runs/watched_run.hpp"

#include <chrono>
#include <thread>
#include <utility>

namespace snug::remote_runs {
namespace {

constexpr std::chrono::milliseconds kBetweenObservations(8);  // at most 125 answers a second are the watcher's

}  // namespace

WatchedRun::WatchedRun(remote_plant::WatchedCell& cell, runs::RunObserver& observer, std::string version,
                       std::function<void(const std::string&)> over)
    : cell_(cell),
      observer_(observer),
      version_(std::move(version)),
      over_(std::move(over)),
      work_(cell.simulation().make_workspace()) {}

std::string WatchedRun::run() {
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

void WatchedRun::begin() {
  const cell::Simulation& simulation = cell_.simulation();
  runs::RecorderSetup setup;
  setup.observer = &observer_;
  setup.period = simulation.scenario().controller.tick;
  setup.sequence = simulation.sequence().name;
  setup.version = version_;
  recorder_.emplace(simulation.scenario(), simulation.world(), setup);
  add();
}

void WatchedRun::show() {
  if (cell_.time() < last_) finish("");
  if (recorder_ ? cell_.time() > last_ : cell_.time() > 0.0) recorder_ ? add() : begin();
}

void WatchedRun::add() {
  last_ = cell_.time();
  const cell::Simulation& simulation = cell_.simulation();
  const cell::CellState state = cell_.state();
  runs::FrameInput input;
  input.X_WE = input.X_WE_command = state.arm->machine.tool.X_WE;
  if (!recorder_->add_frame(simulation.world(), state.world, work_.physics, {}, input)) finish("");
}

/// What was shown stays until the next run moves.
void WatchedRun::finish(const std::string& why) {
  if (recorder_) over_(why);
  recorder_.reset();
  last_ = 0.0;
}

camera::Scene watched_scene(const remote_plant::WatchedCell& cell, const std::string& name) {
  const cell::Simulation& simulation = cell.simulation();
  runs::RunCapture capture;
  runs::RecorderSetup setup;
  setup.observer = &capture;
  setup.period = simulation.scenario().controller.tick;
  setup.sequence = simulation.sequence().name;
  runs::Recorder recorder(simulation.scenario(), simulation.world(), setup);
  const cell::CellState state = cell.state();
  const cell::CellWorkspace work = simulation.make_workspace();
  runs::FrameInput input;
  input.X_WE = input.X_WE_command = state.arm->machine.tool.X_WE;
  (void)recorder.add_frame(simulation.world(), state.world, work.physics, {}, input);
  camera::Scene scene = camera::make_scene(capture.recording.header, capture.recording.frames.front(), name);
  for (const remote_plant::WatchedCell::Box& box : cell.boxes()) {
    for (camera::SceneShape& shape : scene.shapes) {
      if (scene.names[static_cast<std::size_t>(shape.body)] == box.id) shape.shape = geometry::Box{0.5 * box.size};
    }
  }
  return scene;
}

camera::Scene scene_without_robot(const remote_plant::WatchedCell& cell) {
  camera::Scene scene = camera::make_surroundings(cell.simulation().scenario());
  for (const remote_plant::WatchedCell::Box& box : cell.boxes()) camera::add_box(scene, box.id, box.X_WP, box.size);
  return scene;
}

}  // namespace snug::remote_runs
