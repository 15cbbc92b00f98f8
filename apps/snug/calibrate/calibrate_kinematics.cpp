// calibrate kinematics: deviations, origins or measured poses in, a calibrated URDF out.
#include "apps/snug/calibrate/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "apps/snug/command_line/outputs.hpp"
#include "snug/calibration/exact_arm.hpp"
#include "snug/calibration/identify.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"

namespace snug::app {
namespace {

struct CalibrateKinematicsOptions : CalibrateOptions {
  std::optional<std::string> deltas;
  std::optional<std::string> yaml;
  std::optional<std::string> poses;
  std::string angles = "urdf";
  std::string base = "base";  ///< link that poses are measured in
  std::string end = "tool0";  ///< link that is measured
  std::optional<std::string> yaml_output;
};

using calibration::AngleReading;
using calibration::FrameShift;
using nlohmann::ordered_json;

void check_one_source(const CalibrateKinematicsOptions& options) {
  const int count = int{options.deltas.has_value()} + int{options.yaml.has_value()} + int{options.poses.has_value()};
  if (count != 1)
    throw InputError("command line", "calibrate kinematics", std::to_string(count) + " sources",
                     "one of --deltas, --yaml, --poses");
}

calibration::IdentifiedArm identify(const CalibrateKinematicsOptions& options, const robot::ArmModel& nominal) {
  const calibration::MeasuredFrames frames{require_link(nominal, "--base", options.base),
                                           require_link(nominal, "--end", options.end)};
  const auto segment = [&](int link) { return nominal.links[static_cast<std::size_t>(link)].segment; };
  if (segment(frames.base) != 0) throw InputError("command line", "--base", options.base, "a link that does not move");
  // The last joint's own link carries no origin that the deviation of the end could be written to.
  const auto is_fixed_behind = [&](const robot::Link& link) {
    return link.segment == nominal.joint_count() && segment(link.parent) == nominal.joint_count();
  };
  if (!is_fixed_behind(nominal.links[static_cast<std::size_t>(frames.end)])) {
    const auto other = std::find_if(nominal.links.begin(), nominal.links.end(), is_fixed_behind);
    throw InputError("command line", "--end", "'" + options.end + "'",
                     "a link behind a fixed joint of the last joint's link" +
                         (other == nominal.links.end() ? ": the URDF has none" : ", such as '" + other->name + "'"));
  }
  return calibration::identify_arm(nominal, calibration::load_pose_pairs(*options.poses, nominal), frames);
}

ordered_json describe(const calibration::IdentifiedArm& found, const robot::ArmModel& nominal) {
  ordered_json json;
  json["position_noise_m"] = found.position_noise;
  json["angle_noise_rad"] = found.angle_noise;
  json["rms_position_before_m"] = found.rms_position_before;
  json["rms_position_m"] = found.rms_position;
  json["rms_angle_before_rad"] = found.rms_angle_before;
  json["rms_angle_rad"] = found.rms_angle;
  for (int i = 0; i < found.deviations.size(); ++i)
    json["deviations"].push_back({{"name", calibration::deviation_name(nominal, i)},
                                  {"value", found.deviations(i)},
                                  {"standard_deviation", std::sqrt(found.covariance(i, i))}});
  return json;
}

/// What is reported is measured on the text that is written, read again.
void add_shifts(const robot::ArmModel& written, const robot::ArmModel& nominal, ordered_json& json) {
  const FrameShift origins = calibration::largest_origin_shift(written, nominal);
  const FrameShift frames = calibration::largest_frame_shift(written, nominal);
  json["max_frame_shift_m"] = origins.position;
  json["max_frame_turn_rad"] = origins.angle;
  json["max_deviation_in_base_m"] = frames.position;
  json["max_deviation_in_base_rad"] = frames.angle;
}

void print_table(const ordered_json& json) {
  const auto number = [&](const char* key) { return json.at(key).get<double>(); };
  if (json.contains("max_end_effector_error_m"))
    std::printf("tool against the deviations: at most %.2g m, %.2g rad apart\n", number("max_end_effector_error_m"),
                number("max_end_effector_error_rad"));
  if (json.contains("deviations")) {
    std::printf("left of the poses: %.3f mm, %.3f mrad rms (%.3f mm, %.3f mrad with the nominal arm)\n",
                1e3 * number("rms_position_m"), 1e3 * number("rms_angle_rad"), 1e3 * number("rms_position_before_m"),
                1e3 * number("rms_angle_before_rad"));
    for (const auto& entry : json["deviations"])
      std::printf("  %-40s %9.4f +- %.4f %s\n", entry["name"].get<std::string>().c_str(),
                  1e3 * entry["value"].get<double>(), 1e3 * entry["standard_deviation"].get<double>(),
                  entry["name"].get<std::string>().find("turn") == std::string::npos ? "mm" : "mrad");
  }
  std::printf("joint origins in their parents' frames: at most %.3f mm, %.5f rad from nominal\n",
              1e3 * number("max_frame_shift_m"), number("max_frame_turn_rad"));
  std::printf("joint frames in the base: at most %.3f mm, %.5f rad from nominal\n",
              1e3 * number("max_deviation_in_base_m"), number("max_deviation_in_base_rad"));
}

int run_calibrate_kinematics(const CalibrateKinematicsOptions& options) {
  check_one_source(options);
  const AngleReading reading = options.angles == "urdf" ? AngleReading::Urdf : AngleReading::EulerXyz;
  const NominalArm nominal = load_nominal(options);
  NamedFiles inputs = {{"the nominal URDF", nominal.path}}, outputs;
  add_file(inputs, "--deltas", options.deltas);
  add_file(inputs, "--yaml", options.yaml);
  add_file(inputs, "--poses", options.poses);
  add_file(outputs, "-o", options.output);
  add_file(outputs, "--write-yaml", options.yaml_output);
  expect_distinct(inputs, outputs);
  std::optional<OutputFile> output = reserve(options.output), yaml_output = reserve(options.yaml_output);
  ordered_json json;
  robot::ArmModel arm;
  calibration::DhTable table;
  if (options.deltas) {
    table = add(calibration::nominal_dh(nominal.arm, nominal.path.string()), calibration::load_deltas(*options.deltas));
    arm = calibration::with_frames_near(calibration::arm_from_dh(nominal.arm, table), nominal.arm);
  } else if (options.yaml) {
    arm = calibration::load_calibration_yaml(*options.yaml, reading, nominal.arm);
  } else {
    const calibration::IdentifiedArm found = identify(options, nominal.arm);
    arm = found.arm;
    json = describe(found, nominal.arm);
  }
  const std::string source = options.deltas ? *options.deltas : options.yaml ? *options.yaml : *options.poses;
  calibration::check_same_arm(arm, nominal.arm, source);
  const std::string note = "Calibrated: joint origins from " + std::filesystem::path(source).filename().string() +
                           ", all else from " + nominal.path.filename().string();
  const std::string text = calibration::format_urdf(nominal.path, nominal.arm, arm, note, nominal.out_folder);
  const robot::ArmModel written =
      robot::parse_urdf(text, options.output.value_or("calibrated URDF"), options.tool_frame, nominal.out_folder);
  if (options.deltas) {
    const FrameShift end = calibration::largest_end_error(written, nominal.arm, table);
    json["max_end_effector_error_m"] = end.position;
    json["max_end_effector_error_rad"] = end.angle;
  }
  add_shifts(written, nominal.arm, json);
  if (output) write_file(std::move(*output), text);
  if (yaml_output) write_file(std::move(*yaml_output), calibration::format_calibration_yaml(written, reading));
  if (options.json)
    print(json.dump(2) + "\n");
  else
    print_table(json);
  return kSuccess;
}

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

}  // namespace

void add_calibrate_kinematics(const Verb& verb) {
  const Verb part = verb.part("kinematics", "the geometry of the arm", kKinematicsHelp);
  CalibrateKinematicsOptions& options = part.runs(run_calibrate_kinematics);
  part.option("--deltas", options.deltas, "FILE.conf",
              "calibration.conf of a UR controller: deviations of the DH parameters");
  part.option("--yaml", options.yaml, "FILE.yaml", "calibration file of a driver: origins of the six joints");
  part.option("--poses", options.poses, "FILE.csv", "joints and measured poses");
  part.option("--base", options.base, "LINK", "link in whose frame poses were measured");
  part.option("--end", options.end, "LINK", "link whose poses were measured");
  part.option("--angles", options.angles, "NAME",
              "how roll, pitch, yaw of YAML files are meant: urdf (fixed axes) or euler-xyz (moving axes, as "
              "ur_calibration writes them)",
              one_of({"urdf", "euler-xyz"}));
  part.option("--write-yaml", options.yaml_output, "FILE.yaml", "the joint origins for a driver");
  add_arm_options(part, options, "the calibrated arm");
}

}  // namespace snug::app
