// perceive: where boxes of known size are, from one depth frame.
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/box_estimation/estimate_text.hpp"
#include "snug/camera/camera_file.hpp"
#include "snug/camera/frame_file.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/model/placements.hpp"

namespace snug::app {
namespace {

struct PerceiveOptions {
  std::string frame;  ///< .png, .ply, .pcd or .h5
  std::string scenario;
  std::string expect;                      ///< placements (YAML)
  std::optional<std::string> camera;       ///< name; absent: the scenario's first
  std::vector<double> intrinsics;          ///< px: fx, fy, cx, cy; empty: the file's or the scenario's
  std::optional<double> depth_unit;        ///< m
  bool points_in_camera = false;           ///< PLY, PCD
  std::string axes = "optical";            ///< of the camera's frame, of such points
  std::optional<std::string> camera_file;  ///< what it says of the camera stands for the frame's and the scenario's
  bool use_scenario_camera = false;        ///< also where the file has its own
  double spread = 0.010;                   ///< m
  double spread_deg = 3.0;
  std::optional<std::string> output;  ///< JSON
  bool json = false;
};

camera::FrameHints make_hints(const PerceiveOptions& options, const model::Scenario& scenario) {
  camera::FrameHints hints;
  hints.camera = camera::choose_camera(scenario, options.camera, options.scenario);
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

constexpr const char* kPerceiveHelp =
    R"(perceive reads depth alone: no labels, colour or truth. It fits boxes with the sizes of the scenario; covariances follow from
the errors of its camera.
FRAME is a PNG (16-bit grey), a PLY or a PCD (text or binary, organised or not) or an HDF5 of `snug camera`. Files of `snug camera` say
where the camera is. For others a file beside the frame says it (NAME.json, .yaml or .yml, else camera.json, .yaml or .yml in its folder),
or --camera-file; what they leave out is the scenario's camera, its intrinsics replaced by --intrinsics (docs/camera-frames.md).
EXPECT is a list of placements as `snug pack --plan` writes it: where each box is believed to be in the container. perceive searches
boxes that are elsewhere; leave out boxes that are not in the container yet.
Exit code 1: the frame itself cannot be used (too few points, or something stands in the view).
Examples:
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --plan plan.json -o run.h5
  snug camera run.h5 -o frame.png
  snug perceive frame.png --scenario scenarios/box-demonstrator.yaml --expect plan.json --json
  snug camera run.h5 -o frame.ply
  snug perceive frame.ply --scenario scenarios/box-demonstrator.yaml --expect plan.json -o boxes.json
Frames of other cameras: a PNG with --intrinsics FX FY CX CY and --depth-unit METRES, a PLY or PCD with --points-in-camera and --axes if
necessary. If the camera could see almost none of the points, the message says what would fit: another unit, other axes, another frame.)";

}  // namespace

void add_perceive(CLI::App& app, Action& action) {
  const Verb verb(app, action, "perceive", "find the boxes in a depth frame", kPerceiveHelp);
  PerceiveOptions& options = verb.runs(run_perceive);
  verb.option("frame", options.frame, "FILE", "frame of a depth camera").required();
  verb.option("--scenario", options.scenario, "FILE.yaml", "scenario of cell, camera and boxes").required();
  verb.option("--expect", options.expect, "FILE.yaml", "where each box is believed to be").required();
  verb.option("--camera", options.camera, "NAME", "name in the scenario (default: the first)");
  verb.option("--intrinsics", options.intrinsics, "FX FY CX CY", "fx fy cx cy of the frame, in pixels").expected(4);
  verb.option("--depth-unit", options.depth_unit, "M",
              "metres in one step of grey, or in one unit of a PLY or PCD of other programs (default: 0.001 for PNG, 1 "
              "for these)",
              within(1e-7, 1.0));
  verb.flag("--points-in-camera", options.points_in_camera,
            "the points of a PLY or PCD are in the camera's frame, not in the world's");
  verb.option("--axes", options.axes, "NAME",
              "axes of that frame: optical (z forward, y down), ros (x forward, z up) or opengl (z backward, y up)",
              one_of({"optical", "ros", "opengl"}));
  verb.option("--camera-file", options.camera_file, "FILE",
              "optics, unit, axes and pose of the camera, in JSON or YAML; overrides what the frame says");
  verb.flag("--scenario-camera", options.use_scenario_camera,
            "use pose and optics of the scenario; overrides what the file says");
  verb.option("--spread", options.spread, "M", "deviation of each believed coordinate", within(1e-4, 1.0));
  verb.option("--spread-deg", options.spread_deg, "DEG", "deviation of the believed rotation", within(0.01, 180.0));
  verb.option("-o,--output", options.output, "FILE.json", "the result as JSON, with the height map");
  add_json(verb, options.json);
}

}  // namespace snug::app
