// check: what may be said after the verb.
#include "apps/snug/check/check.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"

namespace snug::app {
namespace {

constexpr const char* kCheckExamples =
    R"(Moves the arm with its controller and limits, as a run does, but with nothing to touch, and looks at the whole way:
reach, joint limits and speeds, singularities, the arm's own links, and links, gripper, cup and held box against
everything that stands in the cell. Nothing is felt: rows of a fast program go to their end; exact is how exported programs are done.
Margins of collisions are distances, negative inside; what cup and held box may be inside is said beside them. Rows with
one finding stand in one line. Exit code 0: nothing in the way; 1: something is; 2: the input cannot be used.
With --reach: poses of a grid over the container and those of the picks, each by the same tests; a pose is reached where
one branch of the arm's inverse passes them, ways are not looked at. Exit code 1: a pick is not reached, or no place over
the container.
Examples:
  snug check scenarios/box-demonstrator.yaml --program program.csv --sequence 1
  snug check scenarios/box-demonstrator.yaml --program program.csv --sequence 1 --controller exact --json
  snug check scenarios/box-demonstrator.yaml --reach
  snug check scenarios/box-demonstrator.yaml --reach --set "robot.pose={position: [0.2, 0, 0], yaw_deg: 180}" --json)";

}  // namespace

void add_check(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("check", "say whether the robot can do a program, and what is in the way");
  const auto options = std::make_shared<CheckOptions>();
  verb.add_option("scenario", options->scenario, "scenario file with a robot, or name of one that comes with snug")
      ->required()
      ->type_name("SCENARIO.yaml");
  add_scenario_changes(verb, options->changes);
  CLI::Option* program =
      verb.add_option("--program", options->program, "waypoint file (13 columns)")->type_name("FILE.csv");
  CLI::Option* reach =
      verb.add_flag(
              "--reach", options->maps_reach,
              "instead of a program: where over the container and at the picks the tool can stand, pointing down, and "
              "what keeps it from the other places; nothing is moved")
          ->excludes(program);
  verb.add_option("--sequence", options->sequence, "item sequence, to look at the held boxes too")->type_name("NAME");
  verb.add_option("--robot", options->robot, "the scenario's robot; absent: the one there is")->type_name("NAME");
  add_motion_words(verb, options->motion);
  verb.add_option("--corrections", options->corrections, "site corrections: a layer of the scenario, or none")
      ->type_name("LAYER")
      ->capture_default_str();
  verb.add_flag("--json", options->json, "print the result as JSON");
  verb.footer(kCheckExamples);
  verb.callback([options, program, reach, &action] {
    if (program->count() + reach->count() == 0) throw CLI::RequiredError("--program or --reach");
    action = [options] { return run_check(*options); };
  });
}

}  // namespace snug::app
