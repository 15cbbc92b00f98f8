// ScenePage: what a fit of a scene found and what it improved, as one HTML file.
#pragma once

#include <string>
#include <vector>

#include "snug/identification/fitted_scenario.hpp"

namespace snug::identification {

/// Errors before and after, on the recordings that were fitted and on those that were held back; each number with its
/// standard error and verdict; what the fit leaves uncertain.
[[nodiscard]] std::string make_page(const SceneExperiment& experiment, const SceneFit& fit,
                                    const std::vector<UncertaintyChange>& changes);

}  // namespace snug::identification
