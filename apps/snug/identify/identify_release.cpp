// identify release: loads recorded releases, fits or evaluates a cup, prints numbers and what is missed.
#include <fmt/format.h>
#include <fmt/printf.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/identify/identify.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/identification/release_fit.hpp"
#include "snug/model/scenario.hpp"

namespace snug::app {
namespace {

struct IdentifyReleaseOptions : IdentifyOptions {
  std::vector<std::string> inputs;
  bool evaluate = false;  ///< only what the cup of the scenario predicts
};

using identification::CupReleaseFit;
using identification::ReleaseErrors;
using identification::ReleaseMassError;
using nlohmann::ordered_json;

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

ordered_json release_json(const ReleaseErrors& errors) {
  return {{"parameters", ordered_json::array()},
          {"rms_mm", 1e3 * errors.rms},
          {"opening_ms_error", known(errors.opening_error, 1e3)},
          {"masses", release_masses(errors)}};
}

void show_release(const char* about, const ReleaseErrors& errors) {
  print(fmt::sprintf("%s: %.2f mm rms of the box's heights", about, 1e3 * errors.rms));
  print(errors.opening_error < 0.0 ? "\n" : fmt::sprintf(", opening %.1f ms rms\n", 1e3 * errors.opening_error));
  for (const ReleaseMassError& mass : errors.masses) {
    print(fmt::sprintf("  %6.3f kg, %3d recordings: %5.2f mm (recordings scatter by %.2f), opens at %5.1f ms",
                       mass.mass, mass.recordings, 1e3 * mass.rms, 1e3 * mass.scatter, 1e3 * mass.opening));
    print(mass.recorded_opening < 0.0 ? "\n" : fmt::sprintf(", recorded %5.1f\n", 1e3 * mass.recorded_opening));
  }
}

ordered_json release_json(const CupReleaseFit& fit) {
  ordered_json json = release_json(fit.errors);
  for (const identification::Parameter& parameter : fit.parameters) {
    json["parameters"].push_back({{"name", parameter.name},
                                  {"value", parameter.value},
                                  {"standard_error", parameter.standard_error},
                                  {"unit", parameter.unit},
                                  {"verdict", name_of(parameter.verdict)}});
    if (!parameter.advice.empty()) json["parameters"].back()["record_instead"] = parameter.advice;
  }
  json["held_back"] = {{"rms_mm", 1e3 * fit.held_back.rms},
                       {"opening_ms_error", known(fit.held_back.opening_error, 1e3)},
                       {"masses", release_masses(fit.held_back)}};
  return json;
}

void show_release(const CupReleaseFit& fit) {
  for (const identification::Parameter& parameter : fit.parameters) {
    print(fmt::sprintf("  %-24s %12.6g +- %-9.2g %-8s %s\n", parameter.name.c_str(), parameter.value,
                       parameter.standard_error, parameter.unit.c_str(), name_of(parameter.verdict)));
    if (!parameter.advice.empty()) print(fmt::sprintf("      record as well: %s\n", parameter.advice.c_str()));
  }
  show_release("fitted", fit.errors);
  show_release("held back, each mass predicted from the others", fit.held_back);
}

int run_identify_release(const IdentifyReleaseOptions& options) {
  const std::string scenario = find_scenario(options.scenario.value_or("box-demonstrator"));
  const model::CupParams cup = model::load_scenario(scenario).cup;
  if (options.evaluate && options.output)
    throw InputError("command line", "--output", "with --evaluate", "nothing to write: --evaluate fits nothing");
  NamedFiles inputs = name_all("the input", options.inputs);
  add_file(inputs, "--scenario", options.scenario);
  std::optional<OutputFile> output = reserve(inputs, options.output);
  std::vector<identification::RecordedRelease> releases;
  for (const std::string& input : options.inputs)
    for (identification::RecordedRelease& release : identification::load_recorded_releases(input))
      releases.push_back(std::move(release));
  if (options.evaluate) {
    const ReleaseErrors errors = identification::evaluate_release(releases, cup);
    if (options.json)
      print(release_json(errors).dump(2) + "\n");
    else
      show_release("the scenario's cup", errors);
    return kSuccess;
  }
  const CupReleaseFit fit = identification::identify_release(releases, cup);
  if (output)
    write_file(std::move(*output),
               identification::format_release_block(
                   fit, fmt::format("Release from {} ({} recordings; {:.2f} mm rms, {:.2f} mm on masses left out)",
                                    std::filesystem::path(options.inputs.front()).filename().string(), releases.size(),
                                    1e3 * fit.errors.rms, 1e3 * fit.held_back.rms)));
  if (options.json)
    print(release_json(fit).dump(2) + "\n");
  else
    show_release(fit);
  return kSuccess;
}

constexpr const char* kReleaseHelp =
    R"(Each recording: a box at rest under a vertical cup, from the moment at which the vacuum is switched off (blow-off on).
Columns mass_kg, rep, t_s, E_z_m (gripper), B_z_m (box), and S_z_m (lip) if it was tracked; further ones are ignored.
Three masses or more. Each mass in turn is left out and predicted; standard errors are the jackknife over masses.
The model: docs/theory/cup.md, section 6. Units: docs/scenario.md, cup.
Examples:
  snug identify release scenarios/examples/releases.csv --json
  snug identify release scenarios/examples/releases.csv -o cup.yaml
  snug identify release scenarios/examples/releases.csv --evaluate)";

}  // namespace

void add_identify_release(const Verb& verb) {
  const Verb part = verb.part("release", "how the cup lets go, from recorded releases", kReleaseHelp);
  IdentifyReleaseOptions& options = part.runs(run_identify_release);
  part.option("recordings", options.inputs, "FILE.csv", "recorded releases").required();
  part.flag("--evaluate", options.evaluate, "fit nothing: only what the cup predicts");
  part.option("--scenario", options.scenario, "SCENARIO.yaml",
              "whose cup is evaluated, or is the first guess (default: scenarios/box-demonstrator.yaml)");
  add_identify_result(part, options);
}

}  // namespace snug::app
