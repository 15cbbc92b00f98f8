// corrected: a program with the site corrections of a scenario.
#include "snug/runs/corrected.hpp"

#include <fmt/format.h>

#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/motion/corrections.hpp"

namespace snug::runs {
namespace {

const model::CorrectionLayer& require_layer(const model::Scenario& scenario, const std::string& name) {
  const model::CorrectionLayer* layer = model::find_correction_layer(scenario, name);
  if (layer != nullptr) return *layer;
  std::vector<std::string> names{"none"};
  for (const model::CorrectionLayer& known : scenario.controller.correction_layers) names.push_back(known.name);
  throw InputError(scenario.source_name, "--corrections", "'" + name + "'",
                   "one of " + fmt::format("{}", fmt::join(names, ", ")));
}

}  // namespace

motion::Program corrected(const model::Scenario& scenario, const motion::Program& program, const std::string& layer) {
  if (layer.empty()) return program;
  std::vector<motion::Correction> corrections;
  for (const model::Correction& correction : require_layer(scenario, layer).corrections) {
    corrections.push_back({correction.prefixes, correction.offset});
  }
  return motion::apply_corrections(program, corrections);
}

cup::CupMode cup_for(const model::Scenario& scenario, const std::string& layer) {
  const bool with_phases = layer.empty() || require_layer(scenario, layer).with_phases;
  return with_phases ? cup::CupMode::Phases : cup::CupMode::Holding;
}

}  // namespace snug::runs
