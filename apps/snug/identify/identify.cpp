// identify: loads measurements, asks the identification module, prints verdicts, writes the block of a scenario.
#include "apps/snug/identify/identify.hpp"

#include <fmt/format.h>
#include <fmt/printf.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/snug/command_line/outputs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/cup/law.hpp"
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
using nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;

model::CupParams cup_of(const IdentifyOptions& options) {
  return options.scenario ? model::load_scenario(*options.scenario).cup : model::CupParams{};
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

ordered_json as_json(const std::vector<Parameter>& parameters) {
  ordered_json list = ordered_json::array();
  for (const Parameter& parameter : parameters) {
    list.push_back({{"name", parameter.name},
                    {"value", parameter.value},
                    {"standard_error", parameter.standard_error},
                    {"unit", parameter.unit},
                    {"verdict", name_of(parameter.verdict)}});
    if (!parameter.advice.empty()) list.back()["record_instead"] = parameter.advice;
  }
  return list;
}

void add_errors(ordered_json& json, double chi2_per_dof, int degrees_of_freedom, const HeldBackError& held_back) {
  json["chi2_per_dof"] = chi2_per_dof;
  json["degrees_of_freedom"] = degrees_of_freedom;
  json["held_back_error"] = held_back.relative;
  json["held_back_position_mm"] = 1e3 * held_back.position;
  json["held_back_rotation_deg"] = kDegrees * held_back.rotation;
}

void show(const std::vector<Parameter>& parameters) {
  for (const Parameter& parameter : parameters) {
    print(fmt::sprintf("  %-9s %12.6g +- %-9.2g %-8s %s\n", parameter.name.c_str(), parameter.value,
                       parameter.standard_error, parameter.unit.c_str(), name_of(parameter.verdict)));
    if (!parameter.advice.empty()) print(fmt::sprintf("            record instead: %s\n", parameter.advice.c_str()));
  }
}

void print_errors(double chi2_per_dof, const HeldBackError& held_back, bool noise_is_given) {
  print(fmt::sprintf("misfit: chi2 per degree of freedom %.3f with the noise %s%s\n", chi2_per_dof,
                     noise_is_given ? "given" : "assumed (the demonstrator's sensors)",
                     chi2_per_dof > 2.0   ? ": more than noise; standard errors are enlarged"
                     : chi2_per_dof < 0.5 ? ": less than noise; it is smaller than said"
                                          : ""));
  print(fmt::sprintf("held back: %.3f mm, %.3f degrees rms, %.3f times the noise\n", 1e3 * held_back.position,
                     kDegrees * held_back.rotation, held_back.relative));
}

std::string indices(const std::vector<int>& list) {
  std::string text;
  for (const int index : list) text += (text.empty() ? "" : ", ") + std::to_string(index);
  return text;
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

ordered_json describe(const identification::StiffnessFit& fit, const HeldBackError& held_back, bool noise_is_given) {
  ordered_json json;
  json["parameters"] = as_json(fit.parameters);
  add_errors(json, fit.chi2_per_dof, fit.degrees_of_freedom, held_back);
  json["method"] = name_of(fit.method);
  json["wrench"] = name_of(fit.wrench);
  json["noise_is_given"] = noise_is_given;
  json["poses"] = fit.poses;
  json["outliers"] = fit.outliers;
  json["residual_position_mm"] = 1e3 * fit.position;
  json["residual_rotation_deg"] = kDegrees * fit.rotation;
  if (fit.symmetry)
    json["symmetry"] = {{"supported", fit.symmetry->is_supported},
                        {"p_value", fit.symmetry->p_value},
                        {"chi2", fit.symmetry->statistic},
                        {"degrees_of_freedom", 16},
                        {"worst", fit.symmetry->worst}};
  for (int i = 0; i < 6; ++i) {
    ordered_json row = ordered_json::array();
    for (int j = 0; j < 6; ++j) row.push_back(fit.K(i, j));
    json["K"].push_back(row);
  }
  return json;
}

void show(const identification::StiffnessFit& fit, const HeldBackError& held_back, bool noise_is_given) {
  print(fmt::sprintf("stiffness from %d poses, method %s, wrench of the %s\n", fit.poses, name_of(fit.method),
                     fit.wrench == identification::WrenchSource::Sensor ? "sensor" : "payload's gravity"));
  show(fit.parameters);
  print_errors(fit.chi2_per_dof, held_back, noise_is_given);
  print(fmt::sprintf("residuals: %.3f mm, %.3f degrees rms, measured less predicted pose\n", 1e3 * fit.position,
                     kDegrees * fit.rotation));
  if (fit.symmetry)
    print(fmt::sprintf("symmetry: the same from all sides is %s (p = %.3g; worst: %s)\n",
                       fit.symmetry->is_supported ? "supported" : "NOT supported", fit.symmetry->p_value,
                       fit.symmetry->worst.c_str()));
  if (!fit.outliers.empty())
    print(
        fmt::sprintf("left out, beyond 6 standard deviations of the rest: poses %s\n", indices(fit.outliers).c_str()));
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

ordered_json describe(const identification::DampingFit& fit, const HeldBackError& held_back, bool noise_is_given) {
  ordered_json json;
  json["parameters"] = as_json(fit.parameters);
  add_errors(json, fit.chi2_per_dof, fit.degrees_of_freedom, held_back);
  json["noise_is_given"] = noise_is_given;
  json["start"] = fit.start == identification::ReleaseStart::Moving ? "moving" : "rest";
  json["releases_agree"] = fit.releases_agree;
  for (const identification::ReleaseFit& release : fit.releases)
    json["releases"].push_back({{"name", release.name},
                                {"parameters", as_json(release.parameters)},
                                {"chi2_per_dof", release.chi2_per_dof},
                                {"residual_position_mm", 1e3 * release.position},
                                {"residual_rotation_deg", kDegrees * release.rotation},
                                {"outliers", release.outliers}});
  return json;
}

void show(const identification::DampingFit& fit, const HeldBackError& held_back, bool noise_is_given) {
  print(fmt::sprintf("damping from %zu release%s, %s when the records begin\n", fit.releases.size(),
                     fit.releases.size() == 1 ? "" : "s",
                     fit.start == identification::ReleaseStart::Moving ? "moving" : "at rest"));
  show(fit.parameters);
  print_errors(fit.chi2_per_dof, held_back, noise_is_given);
  for (const identification::ReleaseFit& release : fit.releases) {
    print(fmt::sprintf("%s: chi2 per degree of freedom %.3f, residuals %.3f mm, %.3f degrees", release.name.c_str(),
                       release.chi2_per_dof, 1e3 * release.position, kDegrees * release.rotation));
    print(
        fmt::sprintf(release.outliers.empty() ? "\n" : ", samples left out: %s\n", indices(release.outliers).c_str()));
    if (!fit.releases_agree) show(release.parameters);
  }
  if (!fit.releases_agree) print(fmt::sprintf("the releases contradict each other: no one damping fits them all\n"));
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
  if (options.json)
    print(describe(fit, held_back, poses.noise_is_given).dump(2) + "\n");
  else
    show(fit, held_back, poses.noise_is_given);
  return kSuccess;
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
  if (options.json)
    print(describe(fit, held_back, releases.front().noise_is_given).dump(2) + "\n");
  else
    show(fit, held_back, releases.front().noise_is_given);
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
    const model::Scenario scenario = model::load_scenario(*options.scenario);
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
