// calibrate tool, calibrate ft: the tip of the tool and the force/torque sensor from measurements.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "apps/snug/calibrate/calibrate.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "snug/calibration/exact_arm.hpp"
#include "snug/calibration/force_sensor.hpp"
#include "snug/calibration/tool_tip.hpp"
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

using nlohmann::ordered_json;

constexpr double kLongestTip = 2.0;      // m
constexpr double kHeaviestLoad = 500.0;  // kg

ordered_json numbers(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Vector3 deviations(const Matrix3& covariance) { return covariance.diagonal().cwiseMax(0.0).cwiseSqrt(); }

/// "0.1234 +- 0.0002, ..."
void print_three(const char* name, const Vector3& value, const Vector3& deviation, double factor, const char* unit) {
  std::printf("%-14s", name);
  for (int i = 0; i < 3; ++i)
    std::printf("%s%10.4f +- %.4f", i > 0 ? "," : "", factor * value(i), factor * deviation(i));
  std::printf(" %s\n", unit);
}

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
  const int flange = require_link(nominal.arm, "--flange", options.flange);
  const robot::Link& flange_link = nominal.arm.links[static_cast<std::size_t>(flange)];
  if (flange_link.segment != nominal.arm.joint_count())
    throw InputError("command line", "--flange", options.flange, "a link behind the last joint");
  const calibration::ToolTip tip =
      calibration::find_tool_tip(load_table(options.input, calibration::tool_tip_columns()));
  const Pose X_FE = flange_link.X_SL.inverse() * nominal.arm.X_SE;
  const Vector3 tip_in_tool(options.tip_in_tool[0], options.tip_in_tool[1], options.tip_in_tool[2]);
  const Vector3 p_FE = tip.p_FQ - X_FE.R * tip_in_tool;
  const Vector3 shift = p_FE - X_FE.p;
  if (output)
    write_file(std::move(*output),
               calibration::format_urdf_with_tip(nominal.path, nominal.arm, flange, p_FE,
                                                 note_of("tool frame", options.input, nominal), nominal.out_folder));
  if (options.json) {
    ordered_json json;
    json["tip_m"] = numbers(tip.p_FQ);
    json["tip_standard_deviation_m"] = numbers(deviations(tip.covariance));
    json["tool_m"] = numbers(p_FE);
    json["tool_shift_m"] = numbers(shift);
    json["point_m"] = numbers(tip.p_WQ);
    json["point_standard_deviation_m"] = numbers(deviations(tip.point_covariance));
    json["noise_m"] = tip.noise;
    print(json.dump(2) + "\n");
    return kSuccess;
  }
  print_three("tip", tip.p_FQ, deviations(tip.covariance), 1e3, ("mm in " + options.flange).c_str());
  print_three("tool shift", shift, deviations(tip.covariance), 1e3, "mm from nominal");
  print_three("point touched", tip.p_WQ, deviations(tip.point_covariance), 1e3, "mm");
  std::printf("noise of a touch %.4f mm\n", 1e3 * tip.noise);
  return kSuccess;
}

int run_calibrate_sensor(const CalibrateSensorOptions& options) {
  const NominalArm nominal = load_nominal(options);
  if (options.mass && !(*options.mass <= kHeaviestLoad))
    throw InputError("command line", "--mass", std::to_string(*options.mass), "kilograms, at most 500");
  std::optional<OutputFile> output =
      reserve({{"the input", options.input}, {"the nominal URDF", nominal.path}}, options.output);
  const int sensor = require_link(nominal.arm, "--sensor", options.sensor);
  const calibration::ForceSensorFit fit =
      calibration::fit_force_sensor(load_table(options.input, calibration::force_sensor_columns()), options.mass);
  if (output)
    write_file(std::move(*output), calibration::format_urdf_with_load(
                                       nominal.path, nominal.arm, sensor, fit.mass, fit.com,
                                       note_of("load of the sensor", options.input, nominal), nominal.out_folder));
  if (options.json) {
    ordered_json json;
    json["mass_kg"] = fit.mass;
    json["mass_standard_deviation_kg"] = fit.mass_deviation;
    json["com_m"] = numbers(fit.com);
    json["com_standard_deviation_m"] = numbers(fit.com_deviation);
    json["force_offset_N"] = numbers(fit.force_offset);
    json["force_offset_standard_deviation_N"] = numbers(fit.force_offset_deviation);
    json["torque_offset_Nm"] = numbers(fit.torque_offset);
    json["torque_offset_standard_deviation_Nm"] = numbers(fit.torque_offset_deviation);
    json["scale"] = numbers(fit.scale);
    json["scale_standard_deviation"] = numbers(fit.scale_deviation);
    json["force_noise_N"] = fit.force_noise;
    json["torque_noise_Nm"] = fit.torque_noise;
    print(json.dump(2) + "\n");
    return kSuccess;
  }
  std::printf("mass          %10.4f +- %.4f kg%s\n", fit.mass, fit.mass_deviation, options.mass ? " (given)" : "");
  print_three("centre", fit.com, fit.com_deviation, 1e3, ("mm in " + options.sensor).c_str());
  print_three("scale", fit.scale, fit.scale_deviation, 1.0, "");
  print_three("force offset", fit.force_offset, fit.force_offset_deviation, 1.0, "N");
  print_three("torque offset", fit.torque_offset, fit.torque_offset_deviation, 1.0, "Nm");
  std::printf("noise         %10.4f N, %.4f Nm\n", fit.force_noise, fit.torque_noise);
  const auto list = [](const Vector3& v) {
    char text[96];
    std::snprintf(text, sizeof text, "[%.6g, %.6g, %.6g]", v.x(), v.y(), v.z());
    return std::string(text);
  };
  std::printf("for a scenario: sensor: {force_noise: %.4g, torque_noise: %.4g, force_bias: %s, torque_bias: %s}\n",
              fit.force_noise, fit.torque_noise, list(fit.force_offset).c_str(), list(fit.torque_offset).c_str());
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
Only ratios of mass and scales show: without --mass the scales have the geometric mean 1.
Examples:
  snug calibrate ft scenarios/examples/readings.csv
  snug calibrate ft scenarios/examples/readings.csv --mass 1.02 -o ur10-weighed.urdf --json)";

}  // namespace

void add_calibrate_tool(const Verb& verb) {
  const Verb part = verb.part("tool", "where the tip of the tool is", kToolHelp);
  CalibrateToolOptions& options = part.runs(run_calibrate_tool);
  part.option("touches", options.input, "FILE.csv", "poses of the flange").required();
  part.option("--flange", options.flange, "LINK", "link whose poses are given");
  part.option("--tip-in-tool", options.tip_in_tool, "X Y Z",
              "where the tip is in the tool's frame, when a cone is mounted there")
      .expected(3);
  add_arm_options(part, options, "the arm with its tool frame moved to the tip");
}

void add_calibrate_sensor(const Verb& verb) {
  const Verb part = verb.part("ft", "offsets and scales of the force/torque sensor, and its load", kSensorHelp);
  CalibrateSensorOptions& options = part.runs(run_calibrate_sensor);
  part.option("readings", options.input, "FILE.csv", "readings at rest").required();
  part.option("--mass", options.mass, "KG", "of the load, when it was weighed", positive());
  part.option("--sensor", options.sensor, "LINK", "link in whose frame is measured");
  add_arm_options(part, options, "the arm with this load behind the sensor");
}

}  // namespace snug::app
