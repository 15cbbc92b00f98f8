// calibrate: what may be said after the verb.
#include <memory>

#include "calibrate.hpp"
#include "options.hpp"

namespace snug::app {
namespace {

constexpr const char* kKinematicsHelp =
    R"(Writes a URDF whose tool is where the real arm's is, with joint frames as near to the nominal ones as that allows.
Reports the largest error of the tool against the source, and how far joint origins moved in their parents' frames.
Examples:
  snug calibrate kinematics --deltas calibration.conf -o ur10-calibrated.urdf --json
  snug calibrate kinematics --yaml calibration.yaml --angles euler-xyz -o ur10-calibrated.urdf)";

void add_kinematics(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("kinematics", "the geometry of the arm");
  const auto options = std::make_shared<CalibrateKinematicsOptions>();
  part.add_option("--urdf", options->urdf, "the nominal arm; the shipped UR10 unless given")->type_name("FILE.urdf");
  part.add_option("--deltas", options->deltas, "calibration.conf of a UR controller: deviations of the DH parameters")
      ->type_name("FILE.conf");
  part.add_option("--yaml", options->yaml, "calibration file of a driver: origins of the six joints")
      ->type_name("FILE.yaml");
  part.add_option("--angles", options->angles,
                  "how roll, pitch, yaw of YAML files are meant: urdf (fixed axes) or euler-xyz (moving axes, as "
                  "ur_calibration writes them)")
      ->check(one_of({"urdf", "euler-xyz"}))
      ->capture_default_str();
  part.add_option("-o,--output", options->output, "the calibrated arm")->type_name("FILE.urdf");
  part.add_option("--write-yaml", options->yaml_output, "the joint origins for a driver")->type_name("FILE.yaml");
  part.add_flag("--json", options->json, "the result as one JSON object on stdout");
  part.footer(kKinematicsHelp);
  part.callback([options, &action] { action = [options] { return run_calibrate_kinematics(*options); }; });
}

}  // namespace

void add_calibrate(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("calibrate", "identify the arm, its tool or its sensor from measurements");
  verb.require_subcommand(1);
  add_kinematics(verb, action);
  verb.footer("`snug calibrate kinematics --help` and so on tell the files and units; docs/calibration.md the rest.");
}

}  // namespace snug::app
