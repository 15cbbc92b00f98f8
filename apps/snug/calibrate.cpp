// calibrate kinematics: deviations or origins in, a calibrated URDF out.
#include "calibrate.hpp"

#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "snug/calibration/exact_arm.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {
namespace {

using calibration::AngleReading;
using nlohmann::ordered_json;

std::filesystem::path nominal_urdf(const std::string& given) {
  if (!given.empty()) return given;
  const std::filesystem::path here = "scenarios/robots/ur10.urdf";
  return std::filesystem::exists(here) ? here : std::filesystem::path(SNUG_SOURCE_DIR) / here;
}

struct Result {
  robot::ArmModel arm;
  std::string source;
};

Result from_deltas(const robot::ArmModel& nominal, const std::string& urdf, const std::string& file) {
  const calibration::DhTable table = add(calibration::nominal_dh(nominal, urdf), calibration::load_deltas(file));
  return {calibration::with_frames_near(calibration::arm_from_dh(nominal, table), nominal), file};
}

}  // namespace

int run_calibrate_kinematics(const CalibrateKinematicsOptions& options) {
  if (options.deltas.has_value() == options.yaml.has_value())
    throw InputError("command line", "calibrate kinematics", options.deltas ? "two sources" : "no source",
                     "one of --deltas, --yaml");
  const AngleReading reading = options.angles == "urdf" ? AngleReading::Urdf : AngleReading::EulerXyz;
  const std::filesystem::path urdf = nominal_urdf(options.urdf);
  const robot::ArmModel nominal = robot::load_urdf(urdf);
  const Result result =
      options.deltas ? from_deltas(nominal, urdf.string(), *options.deltas)
                     : Result{calibration::load_calibration_yaml(*options.yaml, reading, nominal), *options.yaml};
  const std::string note = "Calibrated: joint origins from " +
                           std::filesystem::path(result.source).filename().string() + ", all else from " +
                           urdf.filename().string();
  const std::filesystem::path folder =
      options.output ? std::filesystem::absolute(*options.output).parent_path() : urdf.parent_path();
  const std::string text = calibration::format_urdf(urdf, nominal, result.arm, note, folder);
  // What is reported is measured on the text that is written, read again.
  const robot::ArmModel written = robot::parse_urdf(text, options.output.value_or("calibrated URDF"), "E", folder);
  ordered_json json;
  if (options.deltas) {
    const calibration::DhTable table =
        add(calibration::nominal_dh(nominal, urdf.string()), calibration::load_deltas(*options.deltas));
    const calibration::FrameShift end = calibration::largest_end_error(written, nominal, table);
    json["max_end_effector_error_m"] = end.position;
    json["max_end_effector_error_rad"] = end.angle;
  }
  const calibration::FrameShift origins = calibration::largest_origin_shift(written, nominal);
  const calibration::FrameShift frames = calibration::largest_frame_shift(written, nominal);
  json["max_frame_shift_m"] = origins.position;
  json["max_frame_turn_rad"] = origins.angle;
  json["max_deviation_in_base_m"] = frames.position;
  json["max_deviation_in_base_rad"] = frames.angle;
  if (options.output) calibration::write_text(text, *options.output);
  if (options.yaml_output)
    calibration::write_text(calibration::format_calibration_yaml(written, reading), *options.yaml_output);
  if (options.json) {
    std::printf("%s\n", json.dump(2).c_str());
    return kSuccess;
  }
  if (options.deltas)
    std::printf("tool against the deviations: at most %.2g m, %.2g rad apart\n",
                json["max_end_effector_error_m"].get<double>(), json["max_end_effector_error_rad"].get<double>());
  std::printf("joint origins in their parents' frames: at most %.3f mm, %.5f rad from nominal\n",
              1e3 * origins.position, origins.angle);
  std::printf("joint frames in the base: at most %.3f mm, %.5f rad from nominal\n", 1e3 * frames.position,
              frames.angle);
  return kSuccess;
}

}  // namespace snug::app
