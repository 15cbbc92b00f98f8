// Release: bellows, gas, valve and lip once the vacuum is switched off, as recorded releases show them.
#include "snug/cup/release.hpp"

#include <algorithm>
#include <cmath>

namespace snug::cup {
namespace {

/// Integral over time of the share of the valve that is open, from the switch to `time`, s.
double opened_until(const model::ReleaseParams& release, double time) {
  const double moving = std::max(0.0, time - release.valve_delay);
  if (moving >= release.valve_time) return moving - 0.5 * release.valve_time;
  return 0.5 * moving * moving / release.valve_time;
}

/// Share of the valve that lets air in, the mean over a step.
double mean_opening(const model::ReleaseParams& release, double time, double dt) {
  return (opened_until(release, time + dt) - opened_until(release, time)) / dt;
}

}  // namespace

Bellows find_bellows(const model::CupParams& params, double pressure_gauge, double length) {
  const model::ReleaseParams& release = params.release;
  const double shut = release.shut_stiffness, open = release.open_stiffness;
  const double pull = -pressure_gauge * params.vacuum.bellows_area;
  const double start = -release.pressure_gauge_start * params.vacuum.bellows_area;
  // Vacuum beyond that at the switch presses the folds together and shortens the bellows no more.
  const double shut_length = params.hold_length + std::max(0.0, start - pull) / shut;
  const double open_length = params.hold_length + release.growth - pull / open;
  if (shut * (length - shut_length) <= open * (length - open_length)) return {shut, shut_length, true};
  return {open, open_length, false};
}

SuctionCup releasing_cup(const model::CupParams& params, double pressure_gauge, double length, const Pose& X_PS) {
  const double s = drawn_in(params, pressure_gauge);
  const Bellows bellows = find_bellows(params, pressure_gauge, length);
  const double stiffness = params.free_stiffness_ratio + s * (1.0 - params.free_stiffness_ratio);
  const double damping = params.free_damping_ratio + s * (1.0 - params.free_damping_ratio);
  Matrix6 K = stiffness * as_matrix(params.stiffness), D = damping * as_matrix(params.damping);
  K(2, 2) = bellows.stiffness;
  D(2, 2) = params.release.damping;
  return {K, D, Pose{Matrix3::Identity(), Vector3(0.0, 0.0, bellows.unloaded_length - params.centre_from_lip)}, X_PS,
          Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -params.centre_from_lip)}};
}

void advance_release(const model::CupParams& params, bool blows, double length, double dt, CupState& state) {
  const model::VacuumParams& vacuum = params.vacuum;
  const model::ReleaseParams& release = params.release;
  const double now = std::max(length, 0.0), volume = vacuum.bellows_area * now + release.volume;
  if (state.length > 0.0) {
    const double before = vacuum.bellows_area * state.length + release.volume;
    state.pressure_gauge =
        (vacuum.ambient_pressure_abs + state.pressure_gauge) * (before / volume) - vacuum.ambient_pressure_abs;
  }
  state.length = now;
  const bool moves = state.release_time + dt > release.valve_delay;
  const double open = mean_opening(release, state.release_time, dt);
  state.release_time += dt;
  if (!moves) return;
  state.pressure_gauge = std::max(state.pressure_gauge, release.pressure_gauge_start);
  // The open valve lets in what lies around the cup, so the pressure fades; blow-off adds its flow. A mean opening
  // makes the step exact for this volume.
  const double blown = blows ? vacuum.ambient_pressure_abs * release.blow_flow * vacuum.vent_time / volume : 0.0;
  const double next = blown + (state.pressure_gauge - blown) * std::exp(-dt * open / vacuum.vent_time);
  state.pressure_gauge = std::min(next, std::max(state.pressure_gauge, vacuum.pressure_gauge_blow));
}

bool peel_lip(const model::CupParams& params, const Wrench& F_S, double dt, CupState& state) {
  const double lacking = find_lacking_force(params, state.pressure_gauge, F_S);
  if (lacking > 0.0) state.peel_impulse += lacking * dt;
  return state.bend >= params.limits.fail_bend || (lacking > 0.0 && state.peel_impulse >= params.release.peel_impulse);
}

}  // namespace snug::cup
