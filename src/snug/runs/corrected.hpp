// corrected: a program with the site corrections of a scenario.
#pragma once

#include <string>

#include "snug/cup/phases.hpp"
#include "snug/model/scenario.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::runs {

/// `layer`: name of a correction layer of the scenario, or empty for none. Throws InputError for an unknown one.
[[nodiscard]] motion::Program corrected(const model::Scenario& scenario, const motion::Program& program,
                                        const std::string& layer);

/// The cup that corrected waypoints were made for: with phases where `layer` says nothing else or is empty.
[[nodiscard]] cup::CupMode cup_for(const model::Scenario& scenario, const std::string& layer);

}  // namespace snug::runs
