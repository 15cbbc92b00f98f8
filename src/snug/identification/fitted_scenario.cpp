// Fitted scenario: values by their paths, half widths by the kind of number that stands there.
#include "snug/identification/fitted_scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "snug/model/number_edit.hpp"
#include "snug/model/scenario_edit.hpp"

namespace snug::identification {
namespace {

/// A key of `uncertainty` and the numbers that it is about.
struct Kind {
  const char* key;
  const char* begin;              ///< of the path
  std::vector<const char*> ends;  ///< of the path, one of them
  double model::Uncertainty::*value;
  bool is_share = true;  ///< of the number, else in its unit
};

const std::vector<Kind>& kinds() {
  using model::Uncertainty;
  static const std::vector<Kind> all = {
      {"friction", "contacts.", {".friction", ".edge_friction"}, &Uncertainty::friction},
      {"contact_stiffness", "contacts.", {".stiffness"}, &Uncertainty::contact_stiffness},
      {"contact_travel", "contacts.", {".travel"}, &Uncertainty::contact_travel},
      {"cup_stiffness", "cup.stiffness", {".lateral", ".axial", ".bend", ".torsion"}, &Uncertainty::cup_stiffness},
      {"cup_stiffness", "cup.damping", {".lateral", ".axial", ".bend", ".torsion"}, &Uncertainty::cup_stiffness},
      {"cup_length", "cup", {".free_length", ".hold_length"}, &Uncertainty::cup_length, false}};
  return all;
}

const Kind* find_kind(const std::string& path) {
  for (const Kind& kind : kinds())
    if (path.starts_with(kind.begin) &&
        std::ranges::any_of(kind.ends, [&](const char* end) { return path.ends_with(end); }))
      return &kind;
  return nullptr;
}

/// How many numbers of a scenario a key is about.
std::size_t count_numbers(const model::Scenario& scenario, const std::string& key) {
  const auto pairs = [&](auto&& has) {
    return static_cast<std::size_t>(std::ranges::count_if(scenario.contact_pairs, has));
  };
  if (key == "friction") return scenario.contact_pairs.size() + (scenario.default_contact ? 1 : 0);
  if (key == "contact_stiffness")
    return pairs([](const model::ContactPair& one) { return one.params.stiffness.has_value(); });
  if (key == "contact_travel")
    return pairs([](const model::ContactPair& one) { return one.params.travel.has_value(); });
  return key == "cup_length" ? 2 : 8;
}

/// What was found of the numbers that a key is about.
struct Found {
  const Kind* kind = nullptr;
  double width = 0.0;           ///< the largest half width
  std::set<std::string> paths;  ///< of the numbers
};

/// Of the number at `path`: the half width of a uniform draw with the same standard deviation, as its key has it.
std::optional<double> half_width(const model::Scenario& scenario, const Kind& kind, const std::string& path,
                                 const model::TaskParameter& asked, const Parameter& parameter) {
  const std::optional<double> number = model::find_number(scenario, path, asked.where);
  if (!number || *number == 0.0) return std::nullopt;
  double width = std::numbers::sqrt3 * parameter.standard_error;
  if (asked.form == model::ParameterForm::Scale) width *= std::abs(*number / parameter.value);
  return kind.is_share ? std::min(1.0, width / std::abs(*number)) : width;
}

std::map<std::string, Found> find_widths(const SceneExperiment& experiment, const SceneFit& fit,
                                         const model::Scenario& scenario) {
  std::map<std::string, Found> by_key;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const Parameter& parameter = fit.parameters[i];
    const model::TaskParameter& asked = experiment.task().parameters[i];
    const bool is_known = parameter.verdict != Verdict::NotIdentifiable && std::isfinite(parameter.standard_error);
    if (asked.is_fixed || !is_known) continue;
    for (const std::string& path : asked.paths) {
      const Kind* kind = find_kind(path);
      if (kind == nullptr) continue;
      const std::optional<double> width = half_width(scenario, *kind, path, asked, parameter);
      if (!width) continue;
      Found& found = by_key[kind->key];
      found.kind = kind;
      found.width = std::max(found.width, *width);
      // Edges have a friction of their own; the pair's is another number.
      if (!path.ends_with(".edge_friction")) found.paths.insert(path);
    }
  }
  return by_key;
}

}  // namespace

FittedScenario fitted_scenario(const SceneExperiment& experiment, const SceneFit& fit) {
  FittedScenario fitted{experiment.scenario_at(fit.values), {}};
  std::vector<model::KeyValue> values;
  for (const auto& [key, found] : find_widths(experiment, fit, fitted.scenario)) {
    const bool has_all = found.paths.size() >= count_numbers(fitted.scenario, key);
    const double before = fitted.scenario.uncertainty.*found.kind->value;
    const double after = has_all ? found.width : std::max(before, found.width);
    if (after == before) continue;
    values.emplace_back("uncertainty." + key, fmt::format("{:.3g}", after));
    fitted.changes.push_back({key, before, after});
  }
  if (!values.empty()) fitted.scenario = model::with_values(fitted.scenario, values, experiment.task().path.string());
  return fitted;
}

}  // namespace snug::identification
