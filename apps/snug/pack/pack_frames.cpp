// pack --perception frames: where its frames come from.
#include "apps/snug/command_line/stop_signal.hpp"
#include "apps/snug/pack/pack.hpp"
#include "snug/core/input_error.hpp"
#include "snug/frames/frame_source.hpp"

namespace snug::app {

camera::FrameSource make_frames(const PackOptions& options, const model::Scenario& scenario) {
  const bool is_asked = options.perception == perception::name_of(perception::Kind::Frames);
  if (!is_asked) {
    if (options.frames) {
      throw InputError("command line", "--frames", "with --perception " + options.perception, "--perception frames");
    }
    return {};
  }
  if (!options.frames) {
    throw InputError("command line", "--perception", "frames, without --frames",
                     "--frames with a folder, or with a command that leaves a frame");
  }
  if (options.plant == "simulated") {
    throw InputError("command line", "--perception", "frames, of a plant in this program",
                     "--plant with a cell of its own, which a camera can see; or --perception camera");
  }
  if (scenario.cameras.empty()) {
    throw InputError(scenario.source_name, "cameras", "none", "a camera, for --perception frames");
  }
  frames::SourceSettings settings;
  settings.from = *options.frames;
  settings.patience = options.frames_patience;
  settings.hints.camera = scenario.cameras.front();
  settings.hints.depth_unit = options.frames_unit;
  if (options.frames_camera) {
    settings.hints.camera_file = *options.frames_camera;
    (void)camera::load_camera_file(*options.frames_camera);  // slips are said before anything moves
  }
  settings.is_interrupted = is_interrupted;
  return frames::make_frame_source(settings);
}

}  // namespace snug::app
