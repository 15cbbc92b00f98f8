// What was identified of a cup as text.
#include "snug/identification/cup_text.hpp"

#include <fmt/format.h>
#include <fmt/printf.h>

#include <nlohmann/json.hpp>

#include "snug/core/units.hpp"
#include "snug/identification/internal/parameter_json.hpp"

namespace snug::identification {
namespace {

using nlohmann::ordered_json;

void add_errors(ordered_json& json, double chi2_per_dof, int degrees_of_freedom, const HeldBackError& held_back) {
  json["chi2_per_dof"] = chi2_per_dof;
  json["degrees_of_freedom"] = degrees_of_freedom;
  json["held_back_error"] = held_back.relative;
  json["held_back_position_mm"] = 1e3 * held_back.position;
  json["held_back_rotation_deg"] = kDegrees * held_back.rotation;
}

std::string as_text(const std::vector<Parameter>& parameters) {
  std::string text;
  for (const Parameter& parameter : parameters) {
    text += fmt::sprintf("  %-9s %12.6g +- %-9.2g %-8s %s\n", parameter.name.c_str(), parameter.value,
                         parameter.standard_error, parameter.unit.c_str(), name_of(parameter.verdict));
    if (!parameter.advice.empty()) text += fmt::sprintf("            record instead: %s\n", parameter.advice.c_str());
  }
  return text;
}

std::string errors_as_text(double chi2_per_dof, const HeldBackError& held_back, bool noise_is_given) {
  std::string text;
  text += fmt::sprintf("misfit: chi2 per degree of freedom %.3f with the noise %s%s\n", chi2_per_dof,
                       noise_is_given ? "given" : "assumed (the demonstrator's sensors)",
                       chi2_per_dof > 2.0   ? ": more than noise; standard errors are enlarged"
                       : chi2_per_dof < 0.5 ? ": less than noise; the noise is smaller than declared"
                                            : "");
  text += fmt::sprintf("held back: %.3f mm, %.3f degrees rms, %.3f times the noise\n", 1e3 * held_back.position,
                       kDegrees * held_back.rotation, held_back.relative);
  return text;
}

std::string as_text(const SensorBias& bias) {
  constexpr double kNoConstant = 2.0;
  const Vector6 value = as_vector(bias.bias), error = as_vector(bias.error);
  std::string text = fmt::sprintf(
      "sensor against %s: %+.2f %+.2f %+.2f N, %+.3f %+.3f %+.3f Nm too much (errors %.2g N, %.2g Nm), %s\n",
      bias.is_against_gravity ? "gravity" : "the law", value[0], value[1], value[2], value[3], value[4], value[5],
      error.head<3>().maxCoeff(), error.tail<3>().maxCoeff(),
      bias.is_removed ? "subtracted: the sensor is not tared" : "left in");
  if (bias.is_against_gravity && bias.misfit > kNoConstant)
    text += fmt::sprintf("sensor and gravity differ by more than a constant: chi2 per number %.1f\n", bias.misfit);
  return text;
}

std::string indices(const std::vector<int>& list) {
  std::string text;
  for (const int index : list) text += (text.empty() ? "" : ", ") + std::to_string(index);
  return text;
}

}  // namespace

std::string format_json(const StiffnessFit& fit, const HeldBackError& held_back, bool noise_is_given) {
  ordered_json json;
  json["parameters"] = internal::describe_parameters(fit.parameters);
  add_errors(json, fit.chi2_per_dof, fit.degrees_of_freedom, held_back);
  json["method"] = name_of(fit.method);
  json["wrench"] = name_of(fit.wrench);
  json["noise_is_given"] = noise_is_given;
  json["poses"] = fit.poses;
  json["outliers"] = fit.outliers;
  json["residual_position_mm"] = 1e3 * fit.position;
  json["residual_rotation_deg"] = kDegrees * fit.rotation;
  json["is_explained"] = fit.is_explained;
  if (fit.bias) {
    const Vector6 bias = as_vector(fit.bias->bias), error = as_vector(fit.bias->error);
    json["sensor_bias"] = {{"against", fit.bias->is_against_gravity ? "gravity" : "the law of the cup"},
                           {"wrench_E", std::vector<double>(bias.data(), bias.data() + 6)},
                           {"standard_error", std::vector<double>(error.data(), error.data() + 6)},
                           {"chi2_of_6", fit.bias->statistic},
                           {"is_removed", fit.bias->is_removed}};
    if (fit.bias->is_against_gravity) json["sensor_bias"]["chi2_per_number_without"] = fit.bias->misfit;
  }
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
  return json.dump(2) + "\n";
}

std::string format_table(const StiffnessFit& fit, const HeldBackError& held_back, bool noise_is_given) {
  std::string text;
  text += fmt::sprintf("stiffness from %d poses, method %s, wrench of the %s\n", fit.poses, name_of(fit.method),
                       fit.wrench == WrenchSource::Sensor ? "sensor" : "payload's gravity");
  text += as_text(fit.parameters);
  text += errors_as_text(fit.chi2_per_dof, held_back, noise_is_given);
  text += fmt::sprintf("residuals: %.3f mm, %.3f degrees rms, measured less predicted pose\n", 1e3 * fit.position,
                       kDegrees * fit.rotation);
  if (fit.bias) text += as_text(*fit.bias);
  if (!fit.is_explained)
    text += "NOT explained: the law of the cup with this noise does not explain these data; do not use any number\n";
  if (fit.symmetry)
    text += fmt::sprintf("symmetry about the axis is %s (p = %.3g; worst: %s)\n",
                         fit.symmetry->is_supported ? "supported" : "NOT supported", fit.symmetry->p_value,
                         fit.symmetry->worst.c_str());
  if (!fit.outliers.empty())
    text +=
        fmt::sprintf("left out, beyond 6 standard deviations of the rest: poses %s\n", indices(fit.outliers).c_str());
  return text;
}

std::string format_json(const DampingFit& fit, const HeldBackError& held_back, bool noise_is_given) {
  ordered_json json;
  json["parameters"] = internal::describe_parameters(fit.parameters);
  add_errors(json, fit.chi2_per_dof, fit.degrees_of_freedom, held_back);
  json["noise_is_given"] = noise_is_given;
  json["start"] = fit.start == ReleaseStart::Moving ? "moving" : "rest";
  json["releases_agree"] = fit.releases_agree;
  for (const ReleaseFit& release : fit.releases)
    json["releases"].push_back({{"name", release.name},
                                {"parameters", internal::describe_parameters(release.parameters)},
                                {"chi2_per_dof", release.chi2_per_dof},
                                {"residual_position_mm", 1e3 * release.position},
                                {"residual_rotation_deg", kDegrees * release.rotation},
                                {"outliers", release.outliers}});
  return json.dump(2) + "\n";
}

std::string format_table(const DampingFit& fit, const HeldBackError& held_back, bool noise_is_given) {
  std::string text;
  text += fmt::sprintf("damping from %zu release%s, %s when the records begin\n", fit.releases.size(),
                       fit.releases.size() == 1 ? "" : "s", fit.start == ReleaseStart::Moving ? "moving" : "at rest");
  text += as_text(fit.parameters);
  text += errors_as_text(fit.chi2_per_dof, held_back, noise_is_given);
  for (const ReleaseFit& release : fit.releases) {
    text += fmt::sprintf("%s: chi2 per degree of freedom %.3f, residuals %.3f mm, %.3f degrees", release.name.c_str(),
                         release.chi2_per_dof, 1e3 * release.position, kDegrees * release.rotation);
    text +=
        fmt::sprintf(release.outliers.empty() ? "\n" : ", samples left out: %s\n", indices(release.outliers).c_str());
    if (!fit.releases_agree) text += as_text(release.parameters);
  }
  if (!fit.releases_agree) text += fmt::sprintf("the releases contradict each other: no one damping fits them all\n");
  return text;
}

}  // namespace snug::identification
