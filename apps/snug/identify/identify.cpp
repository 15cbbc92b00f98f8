// identify: loads measurements, asks the identification module, prints verdicts, writes the block of a scenario.
#include "apps/snug/identify/identify.hpp"

#include <fmt/format.h>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/cup_text.hpp"
#include "snug/identification/damping.hpp"
#include "snug/identification/scenario_block.hpp"
#include "snug/identification/stiffness.hpp"
#include "snug/model/scenario.hpp"

namespace snug::app {
namespace {

struct IdentifyStiffnessOptions : IdentifyOptions {
  std::string input;
  std::string method = "compliance";
  std::optional<std::string> wrench;
  std::string parameters = "5";
};

struct IdentifyDampingOptions : IdentifyOptions {
  std::vector<std::string> inputs;
  std::string start = "auto";
  std::optional<std::uint64_t> release;  ///< only this one, from 0
  bool coupling = false;
  bool stiffness = false;
};

using identification::HeldBackError;

identification::StiffnessOptions as_fit_options(const IdentifyStiffnessOptions& options, const model::CupParams& cup) {
  identification::StiffnessOptions fit;
  for (const auto method : {identification::StiffnessMethod::Wrench, identification::StiffnessMethod::Compliance,
                            identification::StiffnessMethod::ErrorsInVariables})
    if (options.method == name_of(method)) fit.method = method;
  if (options.wrench)
    fit.wrench =
        *options.wrench == "sensor" ? identification::WrenchSource::Sensor : identification::WrenchSource::Gravity;
  if (options.parameters == "21") fit.form = identification::StiffnessForm::Full;
  fit.prior = cup.stiffness;
  return fit;
}

std::vector<identification::Release> load_all(const IdentifyDampingOptions& options, const model::CupParams& cup) {
  std::vector<identification::Release> releases;
  for (const std::string& input : options.inputs)
    for (identification::Release& release : identification::load_releases(input, cup)) {
      apply(options, release.noise, release.noise_is_given);
      releases.push_back(std::move(release));
    }
  if (!options.release) return releases;
  if (*options.release >= releases.size())
    throw InputError("command line", "--release", std::to_string(*options.release),
                     "a number below " + std::to_string(releases.size()) + ", that of the releases");
  return {releases[*options.release]};
}

int run_identify_stiffness(const IdentifyStiffnessOptions& options) {
  const model::CupParams cup = cup_of(options);
  NamedFiles inputs = {{"the input", options.input}};
  add_file(inputs, "--scenario", options.scenario);
  std::optional<OutputFile> output = reserve(inputs, options.output);
  identification::StaticPoses poses = identification::load_static_poses(options.input, cup);
  apply(options, poses.noise, poses.noise_is_given);
  const identification::StiffnessOptions fit_options = as_fit_options(options, cup);
  const identification::StiffnessFit fit = identification::identify_stiffness(poses, fit_options);
  const HeldBackError held_back = identification::compute_held_back_error(poses, fit_options, fit);
  if (output)
    write_file(std::move(*output),
               identification::format_cup_block(
                   identification::block_entries(fit), {},
                   {fmt::format("Stiffness from {} ({} poses, {}, chi2 per degree of freedom {:.3f})",
                                file_name(options.input), fit.poses, name_of(fit.method), fit.chi2_per_dof)}));
  print(options.json ? format_json(fit, held_back, poses.noise_is_given)
                     : format_table(fit, held_back, poses.noise_is_given));
  return fit.is_explained ? kSuccess : kRunFailed;
}

int run_identify_damping(const IdentifyDampingOptions& options) {
  const model::CupParams cup = cup_of(options);
  NamedFiles inputs = name_all("the input", options.inputs);
  add_file(inputs, "--scenario", options.scenario);
  std::optional<OutputFile> output = reserve(inputs, options.output);
  const std::vector<identification::Release> releases = load_all(options, cup);
  identification::DampingOptions fit_options;
  fit_options.prior = cup.damping;
  fit_options.K = cup::as_matrix(cup.stiffness);
  fit_options.start = options.start == "rest"     ? identification::ReleaseStart::Rest
                      : options.start == "moving" ? identification::ReleaseStart::Moving
                                                  : identification::ReleaseStart::Auto;
  fit_options.with_coupling = options.coupling;
  fit_options.with_stiffness = options.stiffness;
  const identification::DampingFit fit = identification::identify_damping(releases, fit_options);
  const HeldBackError held_back = identification::compute_held_back_error(releases, fit_options, fit);
  if (output)
    write_file(
        std::move(*output),
        identification::format_cup_block(
            identification::block_entries(fit.parameters, 'k'), identification::block_entries(fit.parameters, 'd'),
            {fmt::format("Damping from {}{} ({} releases, chi2 per degree of freedom {:.3f})",
                         file_name(options.inputs.front()), options.inputs.size() > 1 ? " and others" : "",
                         releases.size(), fit.chi2_per_dof)}));
  print(options.json ? format_json(fit, held_back, releases.front().noise_is_given)
                     : format_table(fit, held_back, releases.front().noise_is_given));
  return kSuccess;
}

constexpr const char* kStiffnessHelp =
    R"(Each pose: where the lip is in the gripper's frame, and the cup's wrench on the box (sensor) or the box's mass and centre of
mass with the gripper's orientation (gravity). Files: docs/formats.md, static poses. Outliers are
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

}  // namespace

void add_identify_stiffness(const Verb& verb) {
  const Verb part = verb.part("stiffness", "estimate the stiffness of the cup from a held box at rest", kStiffnessHelp);
  IdentifyStiffnessOptions& options = part.runs(run_identify_stiffness);
  part.option("poses", options.input, "FILE.json|FILE.csv", "static poses").required();
  part.option("--method", options.method, "NAME", "compliance, wrench or errors-in-variables",
              one_of({"compliance", "wrench", "errors-in-variables"}));
  part.option("--wrench", options.wrench, "NAME", "sensor or gravity (default: sensor, unless a pose lacks it)",
              one_of({"sensor", "gravity"}));
  part.option("--parameters", options.parameters, "N", "5 (a cup that is symmetric about its axis) or 21",
              one_of({"5", "21"}));
  add_identify_scenario(part, options);
  add_pose_noise(part, options);
  part.option("--force-noise", options.force_noise, "N", "deviation (default: the file's, or 0.3)", positive());
  part.option("--torque-noise", options.torque_noise, "NM", "deviation (default: the file's, or 0.02)", positive());
  add_identify_result(part, options);
}

void add_identify_damping(const Verb& verb) {
  const Verb part = verb.part("damping", "estimate the damping of the cup from free oscillations", kDampingHelp);
  IdentifyDampingOptions& options = part.runs(run_identify_damping);
  part.option("releases", options.inputs, "FILE.json|FILE.csv", "records after a release").required();
  part.option("--release", options.release, "N", "use only this release, counted from 0", whole(0));
  part.option("--start", options.start, "NAME",
              "motion of the box when a record begins: rest, moving, or auto (at rest unless the data contradict)",
              one_of({"auto", "rest", "moving"}));
  part.flag("--coupling", options.coupling, "estimate also the damping that couples shear and bending");
  part.flag("--stiffness", options.stiffness, "estimate the stiffness as well, starting from the given one");
  add_identify_scenario(part, options);
  add_pose_noise(part, options);
  add_identify_result(part, options);
}

model::CupParams cup_of(const IdentifyOptions& options) {
  return options.scenario ? model::load_scenario(find_scenario(*options.scenario)).cup : model::CupParams{};
}

void apply(const IdentifyOptions& options, identification::MeasurementNoise& noise, bool& is_given) {
  const auto set = [&](const std::optional<double>& value, double& field) {
    if (!value) return;
    field = *value;
    is_given = true;
  };
  set(options.position_noise, noise.position);
  set(options.rotation_noise, noise.rotation);
  set(options.force_noise, noise.force);
  set(options.torque_noise, noise.torque);
}

void add_identify_scenario(const Verb& part, IdentifyOptions& options) {
  part.option("--scenario", options.scenario, "SCENARIO.yaml",
              "scenario with the cup of the first guess (default: the cup that scenarios have by default)");
}

void add_pose_noise(const Verb& part, IdentifyOptions& options) {
  part.option("--position-noise", options.position_noise, "M",
              "standard deviation along each axis (default: that of the file, or 0.0005)", positive());
  part.option("--rotation-noise", options.rotation_noise, "RAD",
              "standard deviation about each axis (default: that of the file, or 0.0035)", positive());
}

void add_identify_result(const Verb& part, IdentifyOptions& options) {
  part.option("-o,--output", options.output, "FILE.yaml", "write the numbers as a block for a scenario");
  add_json(part, options.json);
}

void add_identify(CLI::App& app, Action& action) {
  const Verb verb(app, action, "identify", "estimate parameters of the model from measurements, with their errors",
                  "`snug identify stiffness --help` and so on describe files and methods; "
                  "docs/theory/identification.md has the rest.");
  add_identify_stiffness(verb);
  add_identify_damping(verb);
  add_identify_pluck(verb);
  add_identify_payload(verb);
  add_identify_release(verb);
  add_identify_poses(verb);
  add_identify_scene(verb);
}

}  // namespace snug::app
