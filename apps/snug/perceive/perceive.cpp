// perceive: a frame and what is expected in it, poses with covariance out.
#include "apps/snug/perceive/perceive.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/common/choose_camera.hpp"
#include "snug/box_estimation/estimate_text.hpp"
#include "snug/camera/frame_file.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/model/placements.hpp"

namespace snug::app {
namespace {

camera::FrameHints make_hints(const PerceiveOptions& options, const model::Scenario& scenario) {
  camera::FrameHints hints;
  hints.camera = choose_camera(scenario, options.camera, options.scenario);
  hints.camera_is_given = options.use_scenario_camera || !options.intrinsics.empty();
  hints.depth_unit = options.depth_unit;
  hints.points_are_in_camera = options.points_in_camera;
  hints.axes = camera::axes_of(options.axes, "command line");
  if (options.camera_file) hints.camera_file = *options.camera_file;
  if (options.intrinsics.empty()) return hints;
  for (const double value : options.intrinsics)
    if (!(std::abs(value) < 1e6)) throw InputError("command line", "--intrinsics", fmt::format("{}", value), "pixels");
  if (!(options.intrinsics[0] > 1.0 && options.intrinsics[1] > 1.0))
    throw InputError("command line", "--intrinsics", "a focal length of at most 1 px", "fx fy cx cy in pixels");
  hints.camera.intrinsics = {options.intrinsics[0], options.intrinsics[1], options.intrinsics[2],
                             options.intrinsics[3]};
  return hints;
}

box_estimation::EstimateInput make_input(const PerceiveOptions& options, const model::Scenario& scenario) {
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr) throw InputError(options.scenario, "containers", "none", "a container to look into");
  box_estimation::EstimateInput input = box_estimation::make_input(scenario, *container);
  for (const model::PlacementEntry& entry : model::load_placements(options.expect, scenario)) {
    const model::Parcel& parcel = *model::find_parcel(scenario, entry.parcel);
    input.boxes.push_back({entry.parcel, model::collision_size(scenario, parcel), container->X_WT * entry.X_TP,
                           options.spread, options.spread_deg * std::numbers::pi / 180.0});
  }
  return input;
}

}  // namespace

int run_perceive(const PerceiveOptions& options) {
  NamedFiles inputs = {{"the frame", options.frame},
                       {"--scenario", find_scenario(options.scenario)},
                       {"--expect", options.expect}},
             outputs;
  add_file(inputs, "--camera-file", options.camera_file);
  add_file(outputs, "-o", options.output);
  expect_distinct(inputs, outputs);
  const model::Scenario scenario = model::load_scenario(find_scenario(options.scenario));
  const box_estimation::EstimateInput input = make_input(options, scenario);
  std::optional<OutputFile> output = reserve(options.output);
  const camera::Frame frame = camera::load_frame(options.frame, make_hints(options, scenario));
  const box_estimation::Estimate estimate = box_estimation::estimate_boxes(frame, input);
  if (output) write_file(std::move(*output), box_estimation::format_json_with_heights(estimate));
  print(options.json ? format_json(estimate) : format_table(estimate));
  return estimate.fault == box_estimation::FrameFault::None ? kSuccess : kRunFailed;
}

}  // namespace snug::app
