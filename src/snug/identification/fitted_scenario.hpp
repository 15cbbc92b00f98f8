// FittedScenario: a scenario with the numbers that a fit found, and with what it leaves uncertain.
#pragma once

#include <string>
#include <vector>

#include "snug/identification/scene_fit.hpp"
#include "snug/model/scenario.hpp"

namespace snug::identification {

/// A key of `uncertainty` that the fit changed.
struct UncertaintyChange {
  std::string key;
  double before = 0.0, after = 0.0;  ///< half widths, in the unit of the key
};

struct FittedScenario {
  model::Scenario scenario;
  std::vector<UncertaintyChange> changes;
};

/// The experiment's scenario at the values of the fit. Its `uncertainty` becomes that of the fit where numbers of
/// friction, contact stiffness, travel, the cup's stiffness and damping, and its lengths were found: the half width of
/// a uniform draw with the same standard deviation (sqrt 3 standard errors), the largest of those that share a key. A
/// key shrinks below what the scenario says only where all the numbers that it is about were found (the friction of
/// every pair, say). What is not identifiable changes nothing. Throws InputError when the scenario cannot be.
[[nodiscard]] FittedScenario fitted_scenario(const SceneExperiment& experiment, const SceneFit& fit);

}  // namespace snug::identification
