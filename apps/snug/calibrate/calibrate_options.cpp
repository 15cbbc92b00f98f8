// calibrate: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/calibrate/calibrate.hpp"
#include "apps/snug/command_line/options.hpp"

namespace snug::app {
namespace {

constexpr const char* kKinematicsHelp =
    R"(Writes a URDF whose tool is where the real arm's is, with joint frames as near to the nominal ones as that allows,
and reports how far joint origins moved in their parents' frames. Three sources, one at a time:
  --deltas: what a UR controller stores; the tool agrees to rounding
  --yaml:   origins of the six joints, as drivers read them
  --poses:  measurements, CSV with header q1,...,q6,x,y,z,rx,ry,rz (rad; m; rotation vector in rad; 10 rows or more);
            deviations with their standard deviations
Examples:
  snug calibrate kinematics --deltas scenarios/examples/calibration.conf -o ur10-calibrated.urdf --json
  snug calibrate kinematics --yaml scenarios/examples/calibration.yaml --angles euler-xyz -o ur10-calibrated.urdf
  snug calibrate kinematics --poses scenarios/examples/tracker.csv --base base --end tool0 -o ur10-calibrated.urdf)";

constexpr const char* kToolHelp =
    R"(The CSV has a header x,y,z,rx,ry,rz (m; rotation vector in rad) and one row for each touch of one and the same point
with the tip, the tool turned differently each time; four or more.
Examples:
  snug calibrate tool scenarios/examples/touches.csv
  snug calibrate tool scenarios/examples/touches.csv --tip-in-tool 0 0 0.05 -o ur10-bent.urdf --json)";

constexpr const char* kSensorHelp =
    R"(The CSV has a header rx,ry,rz,fx,fy,fz,tx,ty,tz: orientation of the sensor's frame in the world (rotation vector, rad)
and its reading at rest (N, Nm; a hanging load pulls along gravity). Four or more orientations, each axis up and down.
Only ratios of mass and scales show: without --mass the scales have the geometric mean 1.
Examples:
  snug calibrate ft scenarios/examples/readings.csv
  snug calibrate ft scenarios/examples/readings.csv --mass 1.02 -o ur10-weighed.urdf --json)";

constexpr const char* kCameraPosesHelp =
    R"(The CSV has a header x,y,z,rx,ry,rz,cx,cy,cz,crx,cry,crz: pose of the tool in the world, and pose in the camera of what the
tool holds: a board, or a box that `snug perceive` measured (m; rotation vectors in rad). Four rows or more, the tool turned about two
axes at least. What is held need not be known where it sits: that is found too.
Examples:
  snug calibrate camera scenarios/examples/board.csv
  snug calibrate camera scenarios/examples/board.csv --name tote -o camera.yaml --json)";

void add_common(CLI::App& part, CalibrateOptions& options, const char* output) {
  part.add_option("--urdf", options.urdf, "the nominal arm; the shipped UR10 unless given")->type_name("FILE.urdf");
  part.add_option("--tool-frame", options.tool_frame, "link of the URDF that is the tool")
      ->type_name("LINK")
      ->capture_default_str();
  part.add_option("-o,--output", options.output, output)->type_name("FILE.urdf");
  part.add_flag("--json", options.json, "the result as one JSON object on stdout");
}

void add_kinematics(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("kinematics", "the geometry of the arm");
  const auto options = std::make_shared<CalibrateKinematicsOptions>();
  part.add_option("--deltas", options->deltas, "calibration.conf of a UR controller: deviations of the DH parameters")
      ->type_name("FILE.conf");
  part.add_option("--yaml", options->yaml, "calibration file of a driver: origins of the six joints")
      ->type_name("FILE.yaml");
  part.add_option("--poses", options->poses, "joints and measured poses")->type_name("FILE.csv");
  part.add_option("--base", options->base, "link in whose frame poses were measured")
      ->type_name("LINK")
      ->capture_default_str();
  part.add_option("--end", options->end, "link whose poses were measured")->type_name("LINK")->capture_default_str();
  part.add_option("--angles", options->angles,
                  "how roll, pitch, yaw of YAML files are meant: urdf (fixed axes) or euler-xyz (moving axes, as "
                  "ur_calibration writes them)")
      ->check(one_of({"urdf", "euler-xyz"}))
      ->capture_default_str();
  part.add_option("--write-yaml", options->yaml_output, "the joint origins for a driver")->type_name("FILE.yaml");
  add_common(part, *options, "the calibrated arm");
  part.footer(kKinematicsHelp);
  part.callback([options, &action] { action = [options] { return run_calibrate_kinematics(*options); }; });
}

void add_tool(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("tool", "where the tip of the tool is");
  const auto options = std::make_shared<CalibrateToolOptions>();
  part.add_option("touches", options->input, "poses of the flange")->required()->type_name("FILE.csv");
  part.add_option("--flange", options->flange, "link whose poses are given")->type_name("LINK")->capture_default_str();
  part.add_option("--tip-in-tool", options->tip_in_tool,
                  "where the tip is in the tool's frame, when a cone is mounted there")
      ->expected(3)
      ->type_name("X Y Z");
  add_common(part, *options, "the arm with its tool frame moved to the tip");
  part.footer(kToolHelp);
  part.callback([options, &action] { action = [options] { return run_calibrate_tool(*options); }; });
}

void add_sensor(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("ft", "offsets and scales of the force/torque sensor, and its load");
  const auto options = std::make_shared<CalibrateSensorOptions>();
  part.add_option("readings", options->input, "readings at rest")->required()->type_name("FILE.csv");
  part.add_option("--mass", options->mass, "of the load, when it was weighed")->check(positive())->type_name("KG");
  part.add_option("--sensor", options->sensor, "link in whose frame is measured")
      ->type_name("LINK")
      ->capture_default_str();
  add_common(part, *options, "the arm with this load behind the sensor");
  part.footer(kSensorHelp);
  part.callback([options, &action] { action = [options] { return run_calibrate_sensor(*options); }; });
}

void add_camera_poses(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("camera", "where a camera is that stands in the cell (hand-eye)");
  const auto options = std::make_shared<CalibrateCameraOptions>();
  part.add_option("poses", options->input, "of the tool, and of what it holds as the camera sees it")
      ->required()
      ->type_name("FILE.csv");
  part.add_option("--name", options->name, "of the camera in what is written")
      ->type_name("NAME")
      ->capture_default_str();
  part.add_option("--preset", options->preset, "of the camera in what is written")
      ->check(one_of({"structured_light", "active_stereo", "ideal"}))
      ->capture_default_str();
  part.add_option("-o,--output", options->output, "block for a scenario: pose and hand-eye error")
      ->type_name("FILE.yaml");
  part.add_flag("--json", options->json, "the result as one JSON object on stdout");
  part.footer(kCameraPosesHelp);
  part.callback([options, &action] { action = [options] { return run_calibrate_camera(*options); }; });
}

}  // namespace

void add_calibrate(CLI::App& app, Action& action) {
  CLI::App& verb =
      *app.add_subcommand("calibrate", "identify the arm, its tool, its sensor or a camera from measurements");
  verb.require_subcommand(1);
  add_kinematics(verb, action);
  add_tool(verb, action);
  add_sensor(verb, action);
  add_camera_poses(verb, action);
  verb.footer("`snug calibrate kinematics --help` and so on tell the files and units; docs/calibration.md the rest.");
}

}  // namespace snug::app
