// What was found of a cup's release and of laws from many poses as text: JSON for programs, lines for people.
#include "snug/identification/fit_text.hpp"

#include <fmt/format.h>
#include <fmt/printf.h>

#include "snug/identification/internal/parameter_json.hpp"

namespace snug::identification {
namespace {

using nlohmann::ordered_json;

constexpr const char* kWrenchNames[] = {"fx", "fy", "fz", "tx", "ty", "tz"};

ordered_json known(double value, double scale) {
  return value < 0.0 ? ordered_json(nullptr) : ordered_json(scale * value);
}

ordered_json release_masses(const ReleaseErrors& errors) {
  ordered_json list = ordered_json::array();
  for (const ReleaseMassError& mass : errors.masses)
    list.push_back({{"mass_kg", mass.mass},
                    {"recordings", mass.recordings},
                    {"rms_mm", 1e3 * mass.rms},
                    {"scatter_mm", 1e3 * mass.scatter},
                    {"opening_ms", 1e3 * mass.opening},
                    {"recorded_opening_ms", known(mass.recorded_opening, 1e3)}});
  return list;
}

ordered_json release_json(const std::vector<Parameter>& parameters, const ReleaseErrors& errors) {
  return {{"parameters", internal::describe_parameters(parameters)},
          {"rms_mm", 1e3 * errors.rms},
          {"opening_ms_error", known(errors.opening_error, 1e3)},
          {"masses", release_masses(errors)}};
}

std::string pose_json(const std::vector<Parameter>& parameters, const PoseErrors& errors) {
  ordered_json json = {{"parameters", internal::describe_parameters(parameters)},
                       {"normalised_error", errors.normalised},
                       {"linear_error", errors.linear},
                       {"zero_drifts", errors.zero_drifts},
                       {"normalised_error_constant_zero", errors.constant_zero},
                       {"normalised_error_drifting_zero", errors.drifting_zero},
                       {"linear_error_drifting_zero", errors.linear_drifting},
                       {"components", ordered_json::object()},
                       {"is_explained", find_unexplained(errors).empty()},
                       {"verdict", verdict_of(errors)}};
  Eigen::Index i = 0;
  for (const char* name : kWrenchNames) json["components"][name] = errors.components[i++];
  return json.dump(2) + "\n";
}

}  // namespace

std::string format_json(const ReleaseErrors& errors) { return release_json({}, errors).dump(2) + "\n"; }

std::string format_json(const CupReleaseFit& fit) {
  ordered_json json = release_json(fit.parameters, fit.errors);
  json["held_back"] = {{"rms_mm", 1e3 * fit.held_back.rms},
                       {"opening_ms_error", known(fit.held_back.opening_error, 1e3)},
                       {"masses", release_masses(fit.held_back)}};
  return json.dump(2) + "\n";
}

std::string format_text(const ReleaseErrors& errors, const std::string& about) {
  std::string text = fmt::sprintf("%s: %.2f mm rms of the box's heights", about, 1e3 * errors.rms);
  text += errors.opening_error < 0.0 ? "\n" : fmt::sprintf(", opening %.1f ms rms\n", 1e3 * errors.opening_error);
  for (const ReleaseMassError& mass : errors.masses) {
    text += fmt::sprintf("  %6.3f kg, %3d recordings: %5.2f mm (recordings scatter by %.2f), opens at %5.1f ms",
                         mass.mass, mass.recordings, 1e3 * mass.rms, 1e3 * mass.scatter, 1e3 * mass.opening);
    text += mass.recorded_opening < 0.0 ? "\n" : fmt::sprintf(", recorded %5.1f\n", 1e3 * mass.recorded_opening);
  }
  return text;
}

std::string format_text(const CupReleaseFit& fit) {
  std::string text;
  for (const Parameter& parameter : fit.parameters) {
    text += fmt::sprintf("  %-24s %12.6g +- %-9.2g %-8s %s\n", parameter.name, parameter.value,
                         parameter.standard_error, parameter.unit, name_of(parameter.verdict));
    if (!parameter.advice.empty()) text += fmt::sprintf("      record as well: %s\n", parameter.advice);
  }
  return text + format_text(fit.errors, "fitted") +
         format_text(fit.held_back, "held back, each mass predicted from the others");
}

std::string verdict_of(const PoseErrors& errors) {
  const std::vector<std::string> names = find_unexplained(errors);
  if (names.empty()) return "this law explains these data";
  return fmt::format("this law does not explain these data: {}", fmt::join(names, ", "));
}

std::string format_json(const PoseErrors& errors) { return pose_json({}, errors); }

std::string format_json(const PoseFit& fit) { return pose_json(fit.parameters, fit.held_back); }

std::string format_text(const PoseErrors& errors, const std::string& about) {
  std::string text = fmt::sprintf(
      "%s, standard deviations of a component, rms:\n"
      "                  constant zero  drifting zero of the sensor\n"
      "  this law        %13.3f  %13.3f\n"
      "  linear fit      %13.3f  %13.3f\n"
      "components with a %s zero:\n ",
      about, errors.constant_zero, errors.drifting_zero, errors.linear, errors.linear_drifting,
      errors.zero_drifts ? "drifting" : "constant");
  Eigen::Index i = 0;
  for (const char* name : kWrenchNames) text += fmt::sprintf(" %s %.3f", name, errors.components[i++]);
  return text + "\n" + verdict_of(errors) + "\n";
}

std::string format_text(const PoseFit& fit) {
  std::string text;
  for (const Parameter& parameter : fit.parameters)
    text += fmt::sprintf("  %-12s %12.6g +- %-9.2g %-7s %s\n", parameter.name, parameter.value,
                         parameter.standard_error, parameter.unit, name_of(parameter.verdict));
  return text + format_text(fit.held_back, "held back, each fifth pose predicted from the others");
}

}  // namespace snug::identification
