// Fitted scenario: values by their paths, half widths by the kind of number that stands there.
#include "snug/identification/fitted_scenario.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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

struct Width {
  double most = 0.0;
  std::set<std::string> paths;  ///< of the numbers that were found
};

}  // namespace

model::Scenario fitted_scenario(const SceneExperiment& experiment, const SceneFit& fit) {
  model::Scenario scenario = experiment.scenario_at(fit.values);
  std::vector<std::pair<const Kind*, Width>> widths;
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const Parameter& found = fit.parameters[i];
    const model::TaskParameter& asked = experiment.task().parameters[i];
    const bool is_known = found.verdict != Verdict::NotIdentifiable && std::isfinite(found.standard_error);
    if (asked.is_fixed || !is_known) continue;
    for (const std::string& path : asked.paths) {
      const Kind* kind = find_kind(path);
      const std::optional<double> number =
          kind == nullptr ? std::nullopt : model::find_number(scenario, path, asked.where);
      if (!number || *number == 0.0) continue;
      double width = std::numbers::sqrt3 * found.standard_error;
      if (asked.form == model::ParameterForm::Scale) width *= std::abs(*number / found.value);
      if (kind->is_share) width = std::min(1.0, width / std::abs(*number));
      const auto is_same = [&](const auto& one) { return std::string(one.first->key) == kind->key; };
      auto known = std::ranges::find_if(widths, is_same);
      if (known == widths.end()) known = widths.insert(widths.end(), {kind, {}});
      known->second.most = std::max(known->second.most, width);
      if (!path.ends_with(".edge_friction")) known->second.paths.insert(path);
    }
  }
  std::vector<model::KeyValue> changes;
  for (const auto& [kind, width] : widths) {
    const bool has_all = width.paths.size() >= count_numbers(scenario, kind->key);
    const double now = scenario.uncertainty.*kind->value;
    changes.emplace_back(std::string("uncertainty.") + kind->key,
                         fmt::format("{:.3g}", has_all ? width.most : std::max(now, width.most)));
  }
  return changes.empty() ? scenario : model::with_values(scenario, changes, experiment.task().path.string());
}

}  // namespace snug::identification
