// The cell as it is now, served by another program, for a picture of it.
#include "apps/snug/camera/live_view.hpp"

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/remote_plant/watched_cell.hpp"
#include "snug/runs/recorder.hpp"

namespace snug::app {
namespace {

/// Everything, the robot where its joints say that it is.
camera::Scene with_robot(const remote_plant::WatchedCell& cell, const std::string& name) {
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

camera::Scene without_robot(const remote_plant::WatchedCell& cell) {
  camera::Scene scene = camera::make_surroundings(cell.simulation().scenario());
  for (const remote_plant::WatchedCell::Box& box : cell.boxes()) camera::add_box(scene, box.id, box.X_WP, box.size);
  return scene;
}

}  // namespace

CameraView look_at_served(const CameraOptions& options) {
  CameraView view;
  view.scenario = load_changed(options.recording, options.changes);
  if (view.scenario.sequences.empty()) throw InputError(view.scenario.source_name, "sequences", "", "boxes");
  remote_plant::WatchedCell cell(view.scenario, options.sequence.value_or(view.scenario.sequences.front().name),
                                 *options.click, options.client.patience, click::find_client_keys(options.client.keys));
  const std::string trouble = cell.look();
  if (!trouble.empty()) {
    throw InputError("command line", "--click", "'" + *options.click + "'",
                     "a served cell: " + printable(trouble, kLongestMessage));
  }
  view.scene = options.without_robot ? without_robot(cell) : with_robot(cell, options.recording);
  view.time = cell.time();
  view.seed = view.scenario.seed;
  return view;
}

}  // namespace snug::app
