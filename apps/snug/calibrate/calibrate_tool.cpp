// calibrate tool, calibrate ft: the tip of the tool and the force/torque sensor from measurements.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "apps/snug/calibrate/calibrate.hpp"
#include "apps/snug/calibrate/calibrate_files.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "snug/calibration/exact_arm.hpp"
#include "snug/calibration/force_sensor.hpp"
#include "snug/calibration/tool_tip.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"

namespace snug::app {
namespace {

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

}  // namespace

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

}  // namespace snug::app
