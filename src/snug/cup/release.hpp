// Release: bellows, gas, valve and lip once the vacuum is switched off, as recorded releases show them.
#pragma once

#include "snug/cup/phases.hpp"

namespace snug::cup {

/// The bellows along its axis while it is let go (docs/theory/cup-release.md): it pulls the package with
/// stiffness * (length - unloaded_length), the weaker of what its shut folds and what vacuum and open bellows give.
struct Bellows {
  double stiffness = 0.0;        ///< N/m
  double unloaded_length = 0.0;  ///< m, E to lip; of the open bellows it may be below zero
  bool is_shut = true;           ///< the vacuum presses the folds together
};
/// `length`: E to lip along Ez, m.
[[nodiscard]] Bellows find_bellows(const model::CupParams& params, double pressure_gauge, double length);

/// The sealed cup that is let go, at this pressure and length (E to lip along Ez, m): along its axis the bellows above,
/// else as cup_at.
[[nodiscard]] SuctionCup releasing_cup(const model::CupParams& params, double pressure_gauge, double length,
                                       const Pose& X_PS);

/// One step of the gas: the bellows changes to this length and keeps its gas (constant temperature), the valve opens
/// from valve_delay on within valve_time, and the pressure fades with vent_time. With blow-off blow_flow comes in too,
/// up to pressure_gauge_blow.
void advance_release(const model::CupParams& params, bool blows, double length, double dt, CupState& state);

/// One step of a lip whose vacuum is off: has it come off now? It has once what its contact lacks has acted for
/// peel_impulse, or at too much bending.
[[nodiscard]] bool peel_lip(const model::CupParams& params, const Wrench& F_S, double dt, CupState& state);

}  // namespace snug::cup
