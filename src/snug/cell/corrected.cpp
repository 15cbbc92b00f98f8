// corrected: a program with the site corrections of a scenario.
#include "snug/cell/corrected.hpp"

#include <fmt/format.h>

#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/motion/corrections.hpp"

namespace snug::cell {

motion::Program corrected(const model::Scenario& scenario, const motion::Program& program, const std::string& name) {
  if (name.empty()) return program;
  const model::CorrectionLayer* layer = model::find_correction_layer(scenario, name);
  if (layer == nullptr) {
    std::vector<std::string> names{"none"};
    for (const model::CorrectionLayer& known : scenario.controller.correction_layers) names.push_back(known.name);
    throw InputError(scenario.source_name, "--corrections", "'" + name + "'",
                     "one of " + fmt::format("{}", fmt::join(names, ", ")));
  }
  std::vector<motion::Correction> corrections;
  for (const model::Correction& correction : layer->corrections) {
    corrections.push_back({correction.prefixes, correction.offset});
  }
  return motion::apply_corrections(program, corrections);
}

}  // namespace snug::cell
