// program_fit: whether a program is one for the sequence that it is run with.
#pragma once

#include "snug/model/scenario.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::app {

/// Says on stderr when the boxes that the rows of a program name are not those of the sequence, come in another order,
/// or are picked though no row lets them come. Of rows that name no box of the scenario nothing is said.
void warn_misfit(const model::Scenario& scenario, const std::string& sequence, const motion::Program& program);
/// Throws InputError in the same cases, which names the sequences that fit.
void require_fit(const model::Scenario& scenario, const std::string& sequence, const motion::Program& program);

}  // namespace snug::app
