// calibrate: what its parts share.
#include "apps/snug/calibrate/calibrate.hpp"

#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/verbs.hpp"

namespace snug::app {

NominalArm load_nominal(const CalibrateOptions& options) {
  std::filesystem::path path = options.urdf;
  if (path.empty()) path = find_shipped("scenarios/robots/ur10.urdf");
  const std::filesystem::path beside = options.output.value_or(path.string());
  return {path, robot::load_urdf(path, options.tool_frame), std::filesystem::absolute(beside).parent_path()};
}

void add_arm_options(const Verb& part, CalibrateOptions& options, const char* output) {
  part.option("--urdf", options.urdf, "FILE.urdf", "the nominal arm; the shipped UR10 unless given");
  part.option("--tool-frame", options.tool_frame, "LINK", "link of the URDF that is the tool");
  part.option("-o,--output", options.output, "FILE.urdf", output);
  add_json(part, options.json);
}

void add_calibrate(CLI::App& app, Action& action) {
  const Verb verb(
      app, action, "calibrate", "calibrate the arm, its tool, its sensor or a camera from measurements",
      "`snug calibrate kinematics --help` and so on describe the files and units; docs/calibration.md has the rest.");
  add_calibrate_kinematics(verb);
  add_calibrate_tool(verb);
  add_calibrate_sensor(verb);
  add_calibrate_camera(verb);
}

}  // namespace snug::app
