// identify: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/identify/identify.hpp"

namespace snug::app {
namespace {

constexpr const char* kStiffnessHelp =
    R"(Each pose: where the lip is in the gripper's frame, and the cup's wrench on the box (sensor) or the box's mass and centre of
mass with the gripper's orientation (gravity). Files: docs/formats.md, static poses. Poses that do not belong to the rest are
left out and named by index. Verdicts: identified (standard error below 5 %), weak (below 25 %), not identifiable.
Methods: compliance, closed form, the default; wrench, closed form, exact without noise, biased low with it;
errors-in-variables, maximum likelihood, the best error bars.
Examples:
  snug identify stiffness scenarios/examples/poses.json
  snug identify stiffness scenarios/examples/poses.json --method errors-in-variables --wrench gravity -o cup.yaml
  snug identify stiffness scenarios/examples/poses.json --parameters 21 --json)";

constexpr const char* kDampingHelp =
    R"(Each release: poses of the lip in the gripper's frame after a held box was displaced and let go, gripper at rest; mass, centre
of mass and inertia of the box. Files: docs/formats.md, releases. Stiffness is that of the file, else of --scenario.
Examples:
  snug identify pluck --scenario scenarios/box-demonstrator.yaml --parcel BOX013 -o pluck.json
  snug identify damping pluck.json --scenario scenarios/box-demonstrator.yaml -o cup.yaml
  snug identify damping pluck.json --release 0 --json)";

constexpr const char* kPluckHelp =
    R"(Swings say little about damping along the cup's axis. This writes the experiment that does, as sensors would record it
(360 Hz, 1.5 s): the box hangs straight down, is pulled along the axis and let go; --direction lateral, bend, torsion for
the others. What it is identified with: snug identify damping.
Examples:
  snug identify pluck --scenario scenarios/box-demonstrator.yaml --parcel BOX013 -o pluck.json
  snug identify damping pluck.json)";

constexpr const char* kPayloadHelp =
    R"(A lift of 1.5 s tells the mass to 2 % and the centre of mass to 5 mm, where the motion tells it: straight up tells nothing of
where the centre is along the weight. Columns of the table: t, x, y, z, qw, qx, qy, qz (the gripper's end in the world),
fx, fy, fz, tx, ty, tz (of the cup on the box, in the gripper's frame about its end: up for a hanging box), perhaps lip_x ..
lip_qz. The cup's stiffness, that of --scenario, says where the lip is under the wrench; --rigid-lip: where it is unloaded.
Example:
  snug identify payload scenarios/examples/lift.csv --rigid-lip --json)";

constexpr const char* kReleaseHelp =
    R"(Each recording: a box at rest under a vertical cup, from the moment at which the vacuum is switched off (blow-off on).
Columns mass_kg, rep, t_s, E_z_m (gripper), B_z_m (box), and S_z_m (lip) if it was tracked; further ones are ignored.
Three masses or more. Each mass in turn is left out and predicted; standard errors are the jackknife over masses.
The model: docs/theory/cup.md, section 6. Units: docs/scenario.md, cup.
Examples:
  snug identify release scenarios/examples/releases.csv --json
  snug identify release scenarios/examples/releases.csv -o cup.yaml
  snug identify release scenarios/examples/releases.csv --evaluate)";

constexpr const char* kPosesHelp =
    R"(Another make of cup: a robot deforms it, a sensor reads the wrench. The law is the gradient of one potential, so it is passive;
lateral and bending stiffness change with compression. Each fifth pose in turn is predicted from the others, beside a linear
fit. Where it leaves more than half a standard deviation of a component it says that it does not explain the data.
Columns x_mm, y_mm, z_mm, qw .. qz, fx_N .. fz_N, tx_Nmm .. tz_Nmm: docs/formats.md, cup poses; theory: docs/theory/cup.md, section 8.
Examples:
  snug identify poses scenarios/examples/cup-poses.csv --json
  snug identify poses scenarios/examples/cup-poses.csv -o law.yaml
  snug identify poses scenarios/examples/cup-poses.csv --cup scenarios/cups/other-make.yaml --evaluate)";

constexpr const char* kSceneHelp =
    R"(The task names a scenario, the bodies that were recorded, and which numbers of the scenario are open, with bounds. First
comes what each of them changes; combinations that the recordings cannot tell are named and left alone. Then the search, and
standard errors. Each fifth recording is held back and predicted. Task files: docs/identification.md.
Examples:
  snug identify scene scenarios/tosses/task.yaml --recordings scenarios/tosses/example.csv --evaluate --json
  snug identify scene scenarios/tosses/task.yaml --recordings scenarios/tosses/example.csv --local 10 --log points.csv --page found.html)";

void add_scenario(CLI::App& part, IdentifyOptions& options) {
  part.add_option("--scenario", options.scenario,
                  "whose cup is the first guess; without, the cup that scenarios have by default")
      ->type_name("SCENARIO.yaml");
}

void add_pose_noise(CLI::App& part, IdentifyOptions& options) {
  part.add_option("--position-noise", options.position_noise,
                  "standard deviation along each axis; 0.0005 unless the file tells")
      ->check(positive())
      ->type_name("M");
  part.add_option("--rotation-noise", options.rotation_noise, "about each axis; 0.0035 unless the file tells")
      ->check(positive())
      ->type_name("RAD");
}

void add_result(CLI::App& part, IdentifyOptions& options) {
  part.add_option("-o,--output", options.output, "the numbers as a block that a scenario takes")
      ->type_name("FILE.yaml");
  part.add_flag("--json", options.json, "the result as one JSON object on stdout");
}

void add_stiffness(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("stiffness", "the cup's stiffness from a held box at rest");
  const auto options = std::make_shared<IdentifyStiffnessOptions>();
  part.add_option("poses", options->input, "static poses")->required()->type_name("FILE.json|FILE.csv");
  part.add_option("--method", options->method, "compliance, wrench or errors-in-variables")
      ->check(one_of({"compliance", "wrench", "errors-in-variables"}))
      ->capture_default_str();
  part.add_option("--wrench", options->wrench, "sensor or gravity; the sensor's unless some pose has none")
      ->check(one_of({"sensor", "gravity"}));
  part.add_option("--parameters", options->parameters, "5, a cup that looks the same from all sides, or 21")
      ->check(one_of({"5", "21"}))
      ->capture_default_str();
  add_scenario(part, *options);
  add_pose_noise(part, *options);
  part.add_option("--force-noise", options->force_noise, "0.3 unless the file tells")
      ->check(positive())
      ->type_name("N");
  part.add_option("--torque-noise", options->torque_noise, "0.02 unless the file tells")
      ->check(positive())
      ->type_name("NM");
  add_result(part, *options);
  part.footer(kStiffnessHelp);
  part.callback([options, &action] { action = [options] { return run_identify_stiffness(*options); }; });
}

void add_damping(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("damping", "the cup's damping from free oscillations");
  const auto options = std::make_shared<IdentifyDampingOptions>();
  part.add_option("releases", options->inputs, "records after a release")->required()->type_name("FILE.json|FILE.csv");
  part.add_option("--release", options->release, "only this one of all, counted from 0")
      ->check(whole(0))
      ->type_name("N");
  part.add_option("--start", options->start,
                  "how the box moves when a record begins: rest, moving, or auto: at rest unless the data contradict")
      ->check(one_of({"auto", "rest", "moving"}))
      ->capture_default_str();
  part.add_flag("--coupling", options->coupling, "also the damping that couples shear and bending");
  part.add_flag("--stiffness", options->stiffness, "the stiffness too, from the given one on");
  add_scenario(part, *options);
  add_pose_noise(part, *options);
  add_result(part, *options);
  part.footer(kDampingHelp);
  part.callback([options, &action] { action = [options] { return run_identify_damping(*options); }; });
}

void add_pluck(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("pluck", "a virtual release, to see what it would tell");
  const auto options = std::make_shared<IdentifyPluckOptions>();
  part.add_option("--parcel", options->parcel, "box of the scenario, held in the middle of its upper face")
      ->type_name("ID");
  part.add_option("--direction", options->direction, "axial, lateral, bend or torsion")
      ->check(one_of({"axial", "lateral", "bend", "torsion"}))
      ->capture_default_str();
  part.add_option("--amplitude", options->amplitude, "pulled so far; 0.004 m, or 0.1 rad for bend and torsion")
      ->check(positive())
      ->type_name("M|RAD");
  part.add_option("--repeat", options->repeat, "releases")->check(whole(1, 100))->capture_default_str();
  part.add_option("--seed", options->seed, "of the noise")->check(whole(0))->capture_default_str();
  part.add_option("-o,--output", options->output, "the releases")->required()->type_name("FILE.json");
  add_scenario(part, *options);
  add_pose_noise(part, *options);
  part.footer(kPluckHelp);
  part.callback([options, &action] { action = [options] { return run_identify_pluck(*options); }; });
}

void add_payload(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("payload", "mass and centre of mass of a held box, from one lift");
  const auto options = std::make_shared<IdentifyPayloadOptions>();
  part.add_option("lift", options->input, "what sensor and joints recorded")->required()->type_name("LIFT.csv");
  part.add_option("--scenario", options->scenario,
                  "whose cup holds the box; without, the cup that scenarios have by default")
      ->type_name("SCENARIO.yaml");
  part.add_flag("--rigid-lip", options->rigid_lip, "the lip does not give, as of a hard gripper");
  const auto deviation = [&](const char* name, std::optional<double>& field, const char* what, const char* unit) {
    part.add_option(name, field, what)->check(positive())->type_name(unit);
  };
  deviation("--force-noise", options->force_noise, "standard deviation of a reading; default 0.3", "N");
  deviation("--torque-noise", options->torque_noise, "the same; default 0.02", "NM");
  deviation("--position-noise", options->position_noise, "of the lip; default 0.0002", "M");
  deviation("--rotation-noise", options->rotation_noise, "of the lip; default 0.004", "RAD");
  deviation("--force-bias", options->force_bias, "what taring left, standard deviation; default 0.015", "N");
  deviation("--torque-bias", options->torque_bias, "the same; default 0.001", "NM");
  part.add_flag("--json", options->json, "the result as one JSON object on stdout");
  part.footer(kPayloadHelp);
  part.callback([options, &action] { action = [options] { return run_identify_payload(*options); }; });
}

void add_release(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("release", "how the cup lets go, from recorded releases");
  const auto options = std::make_shared<IdentifyReleaseOptions>();
  part.add_option("recordings", options->inputs, "recorded releases")->required()->type_name("FILE.csv");
  part.add_flag("--evaluate", options->evaluate, "fit nothing: only what the cup predicts");
  part.add_option("--scenario", options->scenario,
                  "whose cup is evaluated, or is the first guess (default: scenarios/box-demonstrator.yaml)")
      ->type_name("SCENARIO.yaml");
  add_result(part, *options);
  part.footer(kReleaseHelp);
  part.callback([options, &action] { action = [options] { return run_identify_release(*options); }; });
}

void add_poses(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("poses", "a cup's law from wrenches in many poses");
  const auto options = std::make_shared<IdentifyPosesOptions>();
  part.add_option("poses", options->input, "poses and wrenches")->required()->type_name("FILE.csv");
  CLI::Option* cup = part.add_option("--cup", options->cup, "the law that is evaluated")->type_name("CUP.yaml");
  CLI::Option* evaluate =
      part.add_flag("--evaluate", options->evaluate, "fit nothing: only what the law of --cup predicts");
  cup->needs(evaluate);
  evaluate->needs(cup);
  part.add_option("-o,--output", options->output, "the law found")->type_name("FILE.yaml")->excludes(evaluate);
  part.add_flag("--json", options->json, "the result as one JSON object on stdout");
  part.footer(kPosesHelp);
  part.callback([options, &action] { action = [options] { return run_identify_poses(*options); }; });
}

void add_scene(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("scene", "numbers of a scenario, from recordings of its bodies");
  const auto options = std::make_shared<IdentifySceneOptions>();
  part.add_option("task", options->task, "what is open, and what was recorded")->required()->type_name("TASK.yaml");
  part.add_option("--recordings", options->recordings, "instead of those that the task names")->type_name("FILE");
  part.add_flag("--evaluate", options->evaluate, "only the errors of the task's present values on all recordings");
  part.add_flag("--floor", options->floor, "only the error that noise of the start alone sets, at the present values")
      ->excludes("--evaluate");
  part.add_option("--scatter", options->scatter, "points spread over the bounds first")->check(whole(0, 1000000));
  part.add_option("--global", options->global, "evaluations of the global search")->check(whole(0, 1000000));
  part.add_option("--local", options->local, "evaluations of the local search")->check(whole(0, 1000000));
  part.add_option("--seed", options->seed, "of the searches")->check(whole(0));
  part.add_option("--log", options->log, "points tried are added to it; what is in it already is not computed again")
      ->type_name("FILE.csv");
  part.add_option("--threads", options->threads, "threads; the result does not depend on it (default: all cores)")
      ->check(whole(1, kMostThreads))
      ->type_name("N");
  part.add_option("-o,--output", options->output, "the task with the values found")->type_name("TASK.yaml");
  part.add_flag("--profile", options->profile,
                "95 % intervals by the profile likelihood: each value with all others fitted again (takes longer)");
  part.add_option("--scenario", options->scenario,
                  "the scenario with the values found, and with what they leave uncertain")
      ->type_name("SCENARIO.yaml");
  part.add_option("--page", options->page, "what was found, and what it improves on the recordings held back")
      ->type_name("FILE.html");
  part.add_flag("--json", options->json, "the result as one JSON object on stdout");
  part.footer(kSceneHelp);
  part.callback([options, &action] { action = [options] { return run_identify_scene(*options); }; });
}

}  // namespace

void add_identify(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("identify", "numbers of the model from measurements, with their errors");
  verb.require_subcommand(1);
  add_stiffness(verb, action);
  add_damping(verb, action);
  add_pluck(verb, action);
  add_payload(verb, action);
  add_release(verb, action);
  add_poses(verb, action);
  add_scene(verb, action);
  verb.footer(
      "`snug identify stiffness --help` and so on tell files and methods; docs/theory/identification.md the rest.");
}

}  // namespace snug::app
