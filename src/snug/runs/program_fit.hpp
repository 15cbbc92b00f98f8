// program_fit: whether a program is one for the sequence that it is run with.
#pragma once

#include <string>
#include <vector>
#include "snug/model/scenario.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::runs {

/// What speaks against it, a text each: the boxes that the waypoints of a program name are not those of the sequence,
/// come in another order, or are picked though no waypoint lets them come. Of waypoints that name no box of the
/// scenario nothing is said, and nothing of a sequence that there is not.
[[nodiscard]] std::vector<std::string> find_misfits(const model::Scenario& scenario, const std::string& sequence,
                                                    const motion::Program& program);
/// Throws InputError where the boxes are not those of the sequence or come in another order; names the sequences that
/// fit.
void require_fit(const model::Scenario& scenario, const std::string& sequence, const motion::Program& program);

}  // namespace snug::runs
