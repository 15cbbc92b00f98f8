// ScenePage: what a fit of a scene found and what it improved, as one HTML file.
#pragma once

#include <string>

#include "snug/identification/scene_fit.hpp"
#include "snug/model/scenario.hpp"

namespace snug::identification {

/// Errors before and after, on the recordings that were fitted and on those that were held back; each number with its
/// standard error and verdict; what is left uncertain in `scenario`, that of the fit.
[[nodiscard]] std::string make_page(const SceneExperiment& experiment, const SceneFit& fit,
                                    const model::Scenario& scenario);

}  // namespace snug::identification
