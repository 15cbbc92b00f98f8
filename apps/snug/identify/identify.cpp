// identify: loads measurements, asks the identification module, prints verdicts, writes the block of a scenario.
#include "apps/snug/identify/identify.hpp"

#include <fmt/format.h>
#include <fmt/printf.h>

#include <filesystem>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/cup_text.hpp"
#include "snug/identification/damping.hpp"
#include "snug/identification/scenario_block.hpp"
#include "snug/identification/stiffness.hpp"
#include "snug/identification/virtual_experiments.hpp"
#include "snug/model/scenario.hpp"

namespace snug::app {
namespace {

using identification::HeldBackError;
using identification::MeasurementNoise;
using identification::Parameter;

model::CupParams cup_of(const IdentifyOptions& options) {
  return options.scenario ? model::load_scenario(find_scenario(*options.scenario)).cup : model::CupParams{};
}

/// What was said on the command line goes before what the file says.
void apply(const IdentifyOptions& options, MeasurementNoise& noise, bool& is_given) {
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

/// The five numbers of a fit with 21 have the errors of the entries they are read from.
std::vector<identification::BlockEntry> stiffness_entries(const identification::StiffnessFit& fit) {
  if (fit.parameters.size() == 5) return identification::block_entries(fit.parameters, 'k');
  const auto parameter = [&](const char* entry, const char* name, double value) {
    for (const Parameter& one : fit.parameters) {
      if (one.name != entry) continue;
      Parameter renamed = one;
      renamed.name = name;
      renamed.value = value;
      return renamed;
    }
    return Parameter{};
  };
  const model::CupElasticity& five = fit.elasticity;
  return identification::block_entries(
      {parameter("k_x_x", "k_lat", five.lateral), parameter("k_z_z", "k_ax", five.axial),
       parameter("k_rx_rx", "k_bend", five.bend), parameter("k_rz_rz", "k_tors", five.torsion),
       parameter("k_x_ry", "c", five.coupling)},
      'k');
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

}  // namespace

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
                   stiffness_entries(fit), {},
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

int run_identify_pluck(const IdentifyPluckOptions& options) {
  using identification::PluckDirection;
  identification::Pluck pluck;
  // A B1 box of the demonstrator, held by the middle of its upper face: Sz points into it.
  Vector3 size(0.2, 0.2, 0.097);
  SpatialInertia box{0.55, Vector3(0.0, 0.0, -0.032), Vector3(0.0021, 0.0022, 0.0038).asDiagonal()};
  model::CupParams cup;
  if (options.scenario) {
    const model::Scenario scenario = model::load_scenario(find_scenario(*options.scenario));
    cup = scenario.cup;
    if (!options.parcel.empty()) {
      const model::Parcel* parcel = model::find_parcel(scenario, options.parcel);
      if (parcel == nullptr) {
        std::vector<std::string> ids;
        for (const model::Parcel& one : scenario.parcels) ids.push_back(one.id);
        const std::string_view nearest = find_nearest(options.parcel, ids);
        throw InputError("command line", "--parcel", "'" + options.parcel + "'",
                         nearest.empty() ? "a parcel of the scenario"
                                         : "a parcel of the scenario, nearest is " + std::string(nearest));
      }
      size = parcel->size;
      box = parcel->inertia;
    }
  } else if (!options.parcel.empty()) {
    throw InputError("command line", "--parcel", "no scenario that has it", "--scenario as well");
  }
  const Matrix3 R_SP = Vector3(1.0, -1.0, -1.0).asDiagonal();
  pluck.load_S = {box.mass, R_SP * (box.com - Vector3(0.0, 0.0, 0.5 * size.z())),
                  R_SP * box.inertia * R_SP.transpose()};
  pluck.frames = identification::frames_of(cup);
  pluck.K = cup::as_matrix(cup.stiffness);
  pluck.D = cup::as_matrix(cup.damping);
  pluck.direction = options.direction == "axial"     ? PluckDirection::Axial
                    : options.direction == "lateral" ? PluckDirection::Lateral
                    : options.direction == "bend"    ? PluckDirection::Bend
                                                     : PluckDirection::Torsion;
  const bool is_turn = pluck.direction == PluckDirection::Bend || pluck.direction == PluckDirection::Torsion;
  pluck.amplitude = options.amplitude.value_or(is_turn ? 0.1 : 0.004);
  constexpr double kMostPull = 0.03, kMostTurn = 0.6;  // m, rad: a cup of 50 mm, a law that ends at 45 degrees
  if (pluck.amplitude > (is_turn ? kMostTurn : kMostPull))
    throw InputError("command line", "--amplitude", fmt::format("{}", pluck.amplitude),
                     is_turn ? "0.6 rad or less" : "0.03 m or less");
  MeasurementNoise noise;
  bool is_given = true;
  apply(options, noise, is_given);
  Rng rng = Rng(options.seed).split("pluck");
  std::vector<identification::Release> releases;
  for (std::uint64_t i = 0; i < options.repeat; ++i) {
    releases.push_back(identification::make_pluck(pluck));
    identification::add_noise(releases.back(), noise, rng);
  }
  NamedFiles inputs;
  add_file(inputs, "--scenario", options.scenario);
  write_file(*reserve(inputs, options.output), identification::format_releases(releases));
  print(fmt::sprintf("%s: %llu releases %s by %g %s, %g kg, %zu samples each\n", options.output->c_str(),
                     static_cast<unsigned long long>(options.repeat), options.direction.c_str(), pluck.amplitude,
                     is_turn ? "rad" : "m", box.mass, releases.front().times.size()));
  return kSuccess;
}

}  // namespace snug::app
