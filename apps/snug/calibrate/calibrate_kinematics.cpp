// calibrate kinematics: deviations, origins or measured poses in, a calibrated URDF out.
#include "apps/snug/calibrate/calibrate.hpp"

#include <filesystem>

#include "apps/snug/command_line/outputs.hpp"
#include "snug/calibration/calibration_text.hpp"
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

void check_one_source(const CalibrateKinematicsOptions& options) {
  const int count = int{options.deltas.has_value()} + int{options.yaml.has_value()} + int{options.poses.has_value()};
  if (count != 1)
    throw InputError("command line", "calibrate kinematics", std::to_string(count) + " sources",
                     "one of --deltas, --yaml, --poses");
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
  calibration::ArmReport report;
  robot::ArmModel arm;
  calibration::DhTable table;
  if (options.deltas) {
    table = add(calibration::nominal_dh(nominal.arm, nominal.path.string()), calibration::load_deltas(*options.deltas));
    arm = calibration::with_frames_near(calibration::arm_from_dh(nominal.arm, table), nominal.arm);
  } else if (options.yaml) {
    arm = calibration::load_calibration_yaml(*options.yaml, reading, nominal.arm);
  } else {
    const calibration::MeasuredFrames frames = calibration::require_frames(nominal.arm, options.base, options.end);
    report.found =
        calibration::identify_arm(nominal.arm, calibration::load_pose_pairs(*options.poses, nominal.arm), frames);
    arm = report.found->arm;
  }
  const std::string source = options.deltas ? *options.deltas : options.yaml ? *options.yaml : *options.poses;
  calibration::check_same_arm(arm, nominal.arm, source);
  const std::string note = "Calibrated: joint origins from " + std::filesystem::path(source).filename().string() +
                           ", all else from " + nominal.path.filename().string();
  const std::string text = calibration::format_urdf(nominal.path, nominal.arm, arm, note, nominal.out_folder);
  const robot::ArmModel written =
      robot::parse_urdf(text, options.output.value_or("calibrated URDF"), options.tool_frame, nominal.out_folder);
  if (options.deltas) report.end_error = calibration::largest_end_error(written, nominal.arm, table);
  report.origins = calibration::largest_origin_shift(written, nominal.arm);
  report.frames = calibration::largest_frame_shift(written, nominal.arm);
  if (output) write_file(std::move(*output), text);
  if (yaml_output) write_file(std::move(*yaml_output), calibration::format_calibration_yaml(written, reading));
  print(options.json ? calibration::format_json(report, nominal.arm) : calibration::format_text(report, nominal.arm));
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
  const Verb part = verb.part("kinematics", "calibrate the geometry of the arm", kKinematicsHelp);
  CalibrateKinematicsOptions& options = part.runs(run_calibrate_kinematics);
  part.option("--deltas", options.deltas, "FILE.conf",
              "calibration.conf of a UR controller: deviations of the DH parameters");
  part.option("--yaml", options.yaml, "FILE.yaml", "calibration file of a driver: origins of the six joints");
  part.option("--poses", options.poses, "FILE.csv", "joints and measured poses");
  part.option("--base", options.base, "LINK", "link in whose frame the poses were measured");
  part.option("--end", options.end, "LINK", "link whose poses were measured");
  part.option("--angles", options.angles, "NAME",
              "meaning of roll, pitch, yaw in YAML files: urdf (fixed axes) or euler-xyz (moving axes, as "
              "ur_calibration writes them)",
              one_of({"urdf", "euler-xyz"}));
  part.option("--write-yaml", options.yaml_output, "FILE.yaml", "the joint origins for a driver");
  add_arm_options(part, options, "the calibrated arm");
}

}  // namespace snug::app
