// calibrate tool, calibrate ft: the tip of the tool and the force/torque sensor from measurements.
#include <cmath>
#include <filesystem>

#include "apps/snug/calibrate/calibrate.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "snug/calibration/calibration_text.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"

namespace snug::app {
namespace {

struct CalibrateToolOptions : CalibrateOptions {
  std::string input;
  std::string flange = "tool0";                 ///< link whose poses are given
  std::vector<double> tip_in_tool = {0, 0, 0};  ///< m, tip of the cone in E
};

struct CalibrateSensorOptions : CalibrateOptions {
  std::string input;
  std::string sensor = "ft_sensor";
  std::optional<double> mass;  ///< kg
};

constexpr double kLongestTip = 2.0;      // m
constexpr double kHeaviestLoad = 500.0;  // kg

std::string note_of(const std::string& what, const std::string& input, const NominalArm& nominal) {
  return "Calibrated: " + what + " from " + std::filesystem::path(input).filename().string() + ", all else from " +
         nominal.path.filename().string();
}

int run_calibrate_tool(const CalibrateToolOptions& options) {
  for (const double value : options.tip_in_tool)
    if (!(std::abs(value) <= kLongestTip))
      throw InputError("command line", "--tip-in-tool", std::to_string(value), "metres, at most 2");
  const NominalArm nominal = load_nominal(options);
  std::optional<OutputFile> output =
      reserve({{"the input", options.input}, {"the nominal URDF", nominal.path}}, options.output);
  const int flange = calibration::require_link(nominal.arm, "--flange", options.flange);
  if (nominal.arm.links[static_cast<std::size_t>(flange)].segment != nominal.arm.joint_count())
    throw InputError("command line", "--flange", options.flange, "a link behind the last joint");
  const Vector3 tip_in_tool(options.tip_in_tool[0], options.tip_in_tool[1], options.tip_in_tool[2]);
  const calibration::ToolReport report =
      calibration::report_tool(calibration::find_tool_tip(load_table(options.input, calibration::tool_tip_columns())),
                               nominal.arm, flange, tip_in_tool);
  if (output)
    write_file(std::move(*output),
               calibration::format_urdf_with_tip(nominal.path, nominal.arm, flange, report.p_FE,
                                                 note_of("tool frame", options.input, nominal), nominal.out_folder));
  print(options.json ? calibration::format_json(report) : calibration::format_text(report, options.flange));
  return kSuccess;
}

int run_calibrate_sensor(const CalibrateSensorOptions& options) {
  const NominalArm nominal = load_nominal(options);
  if (options.mass && !(*options.mass <= kHeaviestLoad))
    throw InputError("command line", "--mass", std::to_string(*options.mass), "kilograms, at most 500");
  std::optional<OutputFile> output =
      reserve({{"the input", options.input}, {"the nominal URDF", nominal.path}}, options.output);
  const int sensor = calibration::require_link(nominal.arm, "--sensor", options.sensor);
  const calibration::ForceSensorFit fit =
      calibration::fit_force_sensor(load_table(options.input, calibration::force_sensor_columns()), options.mass);
  if (output)
    write_file(std::move(*output), calibration::format_urdf_with_load(
                                       nominal.path, nominal.arm, sensor, fit.mass, fit.com,
                                       note_of("load of the sensor", options.input, nominal), nominal.out_folder));
  print(options.json ? calibration::format_json(fit)
                     : calibration::format_text(fit, options.sensor, options.mass.has_value()));
  return kSuccess;
}

constexpr const char* kToolHelp =
    R"(The CSV has a header x,y,z,rx,ry,rz (m; rotation vector in rad) and one row for each touch of one and the same point
with the tip, the tool turned differently each time; four or more.
Examples:
  snug calibrate tool scenarios/examples/touches.csv
  snug calibrate tool scenarios/examples/touches.csv --tip-in-tool 0 0 0.05 -o ur10-bent.urdf --json)";

constexpr const char* kSensorHelp =
    R"(The CSV has a header rx,ry,rz,fx,fy,fz,tx,ty,tz: orientation of the sensor's frame in the world (rotation vector, rad)
and its reading at rest (N, Nm; a hanging load pulls along gravity). Four or more orientations, each axis up and down.
The readings determine only ratios of mass and scales: without --mass the scales have the geometric mean 1.
Examples:
  snug calibrate ft scenarios/examples/readings.csv
  snug calibrate ft scenarios/examples/readings.csv --mass 1.02 -o ur10-weighed.urdf --json)";

}  // namespace

void add_calibrate_tool(const Verb& verb) {
  const Verb part = verb.part("tool", "find where the tip of the tool is", kToolHelp);
  CalibrateToolOptions& options = part.runs(run_calibrate_tool);
  part.option("touches", options.input, "FILE.csv", "poses of the flange").required();
  part.option("--flange", options.flange, "LINK", "link whose poses are given");
  part.option("--tip-in-tool", options.tip_in_tool, "X Y Z",
              "place of the tip in the tool's frame, if a cone is mounted there")
      .expected(3);
  add_arm_options(part, options, "the arm with its tool frame moved to the tip");
}

void add_calibrate_sensor(const Verb& verb) {
  const Verb part = verb.part("ft", "calibrate the force/torque sensor and its load", kSensorHelp);
  CalibrateSensorOptions& options = part.runs(run_calibrate_sensor);
  part.option("readings", options.input, "FILE.csv", "readings at rest").required();
  part.option("--mass", options.mass, "KG", "mass of the load, if it was weighed", positive());
  part.option("--sensor", options.sensor, "LINK", "link in whose frame the sensor measures");
  add_arm_options(part, options, "the arm with this load behind the sensor");
}

}  // namespace snug::app
