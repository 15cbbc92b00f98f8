// The result of packing as text: a table for people, JSON for programs.
#pragma once

#include <string>

#include "snug/study/monte_carlo.hpp"
#include "snug/study/trial.hpp"

namespace snug::study {

/// Empty, or why the run failed. `wants_program`: a program or a recording was asked for.
[[nodiscard]] std::string find_failure(const session::SessionResult& result, const MonteCarloResult& repeated,
                                       bool wants_program);
/// What is packed with what, and the head of the table. `address`: of a plant that is served; empty: a simulated one.
[[nodiscard]] std::string format_pack_head(const std::string& sequence, const session::SessionOptions& session,
                                           const simulated_plant::SimulatedPlantOptions& plant,
                                           const std::string& address);
/// The line of one item, and one for each recovery.
[[nodiscard]] std::string format_item(const session::ItemReport& item, const study::TrueItem& truth);
/// What stands under the table. Repeated runs with count 0 are left out.
[[nodiscard]] std::string format_summary(const study::Trial& trial, const study::MonteCarloResult& repeated);
/// The keys are described in docs/formats.md.
[[nodiscard]] std::string format_json(const study::Trial& trial, const study::MonteCarloResult& repeated);
/// The placements, in the order of packing.
/// `is_complete`: the session has ended.
[[nodiscard]] std::string format_plan(const session::SessionResult& result, bool is_complete);

}  // namespace snug::study
