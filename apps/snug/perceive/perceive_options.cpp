// perceive: what may be said after the verb.
#include "apps/snug/perceive/perceive.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"

namespace snug::app {
namespace {

constexpr const char* kPerceiveHelp =
    R"(Reads depth alone: no labels, no colour, no truth. Boxes are fitted with the sizes that the scenario knows; covariances come from
the errors that its camera states.
FRAME is a PNG (16-bit grey), a PLY or a PCD (text or binary, organised or not) or an HDF5 of `snug camera`. Files of `snug camera` say
where the camera is. For others a file beside the frame says it (NAME.json, .yaml or .yml, else camera.json, .yaml or .yml in its folder),
or --camera-file; what they leave out is the scenario's camera, its intrinsics replaced by --intrinsics (docs/camera.md).
EXPECT is a list of placements as `snug pack --plan` writes it: which box is believed to be where in the container. A box that is
elsewhere is looked for: leave out boxes that are not in the container yet.
Exit code 1: the frame itself cannot be used (too few points, or something stands in the view).
Examples:
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --plan plan.json -o run.h5
  snug camera run.h5 -o frame.png
  snug perceive frame.png --scenario scenarios/box-demonstrator.yaml --expect plan.json --json
  snug camera run.h5 -o frame.ply
  snug perceive frame.ply --scenario scenarios/box-demonstrator.yaml --expect plan.json -o boxes.json
Frames of other cameras: a PNG with --intrinsics FX FY CX CY and --depth-unit METRES, a PLY or PCD with --points-in-camera and --axes if
need be. Where next to no point can be one of the camera, the message says what would fit: another unit, other axes, another frame.)";

}  // namespace

void add_perceive(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("perceive", "where the boxes are, from a depth frame");
  const auto options = std::make_shared<PerceiveOptions>();
  verb.add_option("frame", options->frame, "of a depth camera")->required()->type_name("FILE");
  verb.add_option("--scenario", options->scenario, "with the cell, its camera and its boxes")
      ->required()
      ->type_name("FILE.yaml");
  verb.add_option("--expect", options->expect, "which box is believed to be where")->required()->type_name("FILE.yaml");
  verb.add_option("--camera", options->camera, "name in the scenario; without it the first")->type_name("NAME");
  verb.add_option("--intrinsics", options->intrinsics, "fx fy cx cy of the frame, pixels")
      ->expected(4)
      ->type_name("FX FY CX CY");
  verb.add_option("--depth-unit", options->depth_unit,
                  "metres of a step of grey, or of a unit of a PLY or PCD that is not ours; without it 0.001 of a PNG, "
                  "1 of these")
      ->check(within(1e-7, 1.0))
      ->type_name("M");
  verb.add_flag("--points-in-camera", options->points_in_camera,
                "the points of a PLY or PCD are in the camera's frame, not in the world's");
  verb.add_option("--axes", options->axes,
                  "of that frame: optical (z forward, y down), ros (x forward, z up) or opengl (z backward, y up)")
      ->check(one_of({"optical", "ros", "opengl"}))
      ->type_name("NAME")
      ->capture_default_str();
  verb.add_option("--camera-file", options->camera_file,
                  "optics, unit, axes and pose of the camera that took it, whatever the frame says: JSON or YAML")
      ->type_name("FILE");
  verb.add_flag("--scenario-camera", options->use_scenario_camera,
                "pose and optics of the scenario, whatever the file says");
  verb.add_option("--spread", options->spread, "standard deviation of what is believed, each coordinate")
      ->check(within(1e-4, 1.0))
      ->type_name("M")
      ->capture_default_str();
  verb.add_option("--spread-deg", options->spread_deg, "the same of the rotation")
      ->check(within(0.01, 180.0))
      ->type_name("DEG")
      ->capture_default_str();
  verb.add_option("-o,--output", options->output, "the result as JSON, with the height map")->type_name("FILE.json");
  verb.add_flag("--json", options->json, "the result as one JSON object on stdout");
  verb.footer(kPerceiveHelp);
  verb.callback([options, &action] { action = [options] { return run_perceive(*options); }; });
}

}  // namespace snug::app
