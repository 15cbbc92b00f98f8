// Located impact: a body that bears on fixed supports and strikes them with another point, as a block that rocks does.
#pragma once

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {

/// The only body of an island that lies on things that stand still and is not round, all contacts rigid and plastic.
/// -1: there is none.
[[nodiscard]] int find_lone_body(const WorldModel& model, const WorldState& state, const Scratch& work,
                                 const Island& island);

/// Solves the island of a lone body that bears on some points and strikes with others, in order of time: what bears
/// carries it up to the impact, arms are those of there, and positions follow the velocities before and after. Rows are
/// built. False: there is no such impact, and rows and velocities are as before. docs/theory/contact.md, section 5.
[[nodiscard]] bool solve_located_impact(const WorldModel& model, const WorldState& state, Scratch& work,
                                        const Island& island, int lone, const Residuals& residuals,
                                        NewtonScratch& newton, SolveResult& result);

/// The correction of positions closes what opens under an edge or corner that a lone body rocks on. Rows are solved.
void hold_pivots(const WorldModel& model, const Island& island, int lone, Scratch& work);

}  // namespace snug::physics::internal
