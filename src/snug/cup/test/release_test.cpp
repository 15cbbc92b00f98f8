// Release: bellows, gas, valve and lip against closed forms.
#include "snug/cup/release.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace snug::cup {
namespace {

model::CupParams released() {
  model::CupParams params;
  params.release.growth = 0.03;
  return params;
}

CupState releasing(double length) {
  CupState state;
  state.phase = CupPhase::Releasing;
  state.pressure_gauge = model::CupParams{}.vacuum.pressure_gauge_hold;
  state.length = length;
  return state;
}

TEST(ReleaseGas, RisesByVentAndFlowThroughTheOpeningValve) {
  const model::CupParams params = released();
  const model::ReleaseParams& release = params.release;
  for (const double dt : {0.25e-3, 1e-3, 4e-3}) {
    CupState state = releasing(0.05);
    const double volume = params.vacuum.bellows_area * 0.05 + release.volume;
    for (int i = 1; i <= static_cast<int>(std::lround(0.024 / dt)); ++i) {
      advance_release(params, true, 0.05, dt, state);
      const double t = i * dt - release.valve_delay;
      if (std::abs(t) < 1e-9) continue;  // rounding tells whether the valve moves by then
      // The valve has been open for t^2 / (2 valve_time): the mean opening of a step is exact. The pressure tends to
      // what the flow keeps up against the vent.
      const double open = t * t / (2.0 * release.valve_time), vent = params.vacuum.vent_time;
      const double kept = params.vacuum.ambient_pressure_abs * release.blow_flow * vent / volume;
      const double expected = t < 0.0 ? params.vacuum.pressure_gauge_hold
                                      : std::min(params.vacuum.pressure_gauge_blow,
                                                 kept + (release.pressure_gauge_start - kept) * std::exp(-open / vent));
      EXPECT_NEAR(state.pressure_gauge, expected, 1e-6) << t;
    }
    for (int i = 0; i < 4000; ++i) advance_release(params, true, 0.05, dt, state);
    EXPECT_EQ(state.pressure_gauge, params.vacuum.pressure_gauge_blow);
  }
}

TEST(ReleaseGas, BlowOffWithoutFlowIsNoBlowOff) {
  model::CupParams params = released();
  params.release.blow_flow = 0.0;
  CupState blown = releasing(0.05), vented = releasing(0.05);
  for (int i = 0; i < 60; ++i) {
    advance_release(params, true, 0.05, 1e-3, blown);
    advance_release(params, false, 0.05, 1e-3, vented);
    EXPECT_EQ(blown.pressure_gauge, vented.pressure_gauge) << i;
  }
}

TEST(ReleaseGas, FadesWithVentTimeWithoutBlowOff) {
  model::CupParams params = released();
  params.release.valve_delay = params.release.valve_time = 0.0;
  CupState state = releasing(0.05);
  for (int i = 0; i < 60; ++i) advance_release(params, false, 0.05, 1e-3, state);
  const double left = params.release.pressure_gauge_start * std::exp(-0.06 / params.vacuum.vent_time);
  EXPECT_NEAR(state.pressure_gauge / left, 1.0, 1e-12);
}

TEST(ReleaseGas, IsKeptWhileTheBellowsGrowsBeforeTheValveMoves) {
  const model::CupParams params = released();
  CupState state = releasing(0.05);
  const double before = (params.vacuum.ambient_pressure_abs + state.pressure_gauge) *
                        (params.vacuum.bellows_area * 0.05 + params.release.volume);
  advance_release(params, true, 0.07, 1e-3, state);
  const double after = (params.vacuum.ambient_pressure_abs + state.pressure_gauge) *
                       (params.vacuum.bellows_area * 0.07 + params.release.volume);
  EXPECT_NEAR(after / before, 1.0, 1e-14);
}

TEST(ReleaseBellows, PullWithoutJumpAndNeverLessWhenLonger) {
  const model::CupParams params = released();
  for (const double pressure : {5e3, 0.0, -5e3, -1.5e4, -2e4, -6e4}) {
    double last = -1e9;
    for (int i = 0; i <= 4000; ++i) {
      const double length = 0.02 + 2e-5 * i;
      const Bellows bellows = find_bellows(params, pressure, length);
      const double pull = bellows.stiffness * (length - bellows.unloaded_length);
      EXPECT_GT(pull, last);
      if (i > 0) {
        EXPECT_LE(pull - last, 1.0001 * params.release.shut_stiffness * 2e-5);
      }
      last = pull;
    }
  }
}

TEST(ReleaseBellows, IsWithoutForceAtItsTwoLengths) {
  const model::CupParams params = released();
  EXPECT_EQ(find_bellows(params, params.vacuum.pressure_gauge_hold, params.hold_length).unloaded_length,
            params.hold_length);
  EXPECT_NEAR(find_bellows(params, 0.0, 0.08).unloaded_length, params.hold_length + params.release.growth, 1e-15);
}

TEST(ReleaseBellows, ActsAlongTheAxisOfTheWholeCup) {
  const model::CupParams params = released();
  for (const double pressure : {-6e4, -1.2e4, 0.0}) {
    for (const double length : {0.045, 0.06, 0.075}) {
      const Bellows bellows = find_bellows(params, pressure, length);
      physics::ElementQuery query;
      query.X_WB.p = Vector3(0.0, 0.0, length);
      const Wrench F_S = releasing_cup(params, pressure, length, Pose{}).lip_wrench(query);
      EXPECT_NEAR(F_S.force.z(), -bellows.stiffness * (length - bellows.unloaded_length), 1e-9);
      EXPECT_LT(F_S.force.head<2>().norm() + F_S.torque.norm(), 1e-12);
    }
  }
}

TEST(ReleaseLip, PeelsOnceWhatItsContactLacksHasActedLongEnough) {
  model::CupParams params = released();
  params.release.peel_impulse = 0.1;
  CupState state = releasing(0.05);
  state.pressure_gauge = 0.0;
  EXPECT_FALSE(peel_lip(params, {Vector3(0.0, 0.0, 8.0), Vector3::Zero()}, 1.0, state));  // pressed on: never
  EXPECT_EQ(state.peel_impulse, 0.0);
  int steps = 1;
  while (!peel_lip(params, {Vector3(0.0, 0.0, -5.0), Vector3::Zero()}, 1e-3, state)) ++steps;
  EXPECT_NEAR(steps, 20, 1);  // 0.1 Ns at 5 N; rounding of twenty sums
  // Each limit of the hold lacks a normal force of its own.
  const double radius = params.lip_radius, mu = params.lip_friction;
  EXPECT_NEAR(find_lacking_force(params, 0.0, {Vector3(3.0, 0.0, 0.0), Vector3::Zero()}), 3.0 / mu, 1e-12);
  EXPECT_NEAR(find_lacking_force(params, 0.0, {Vector3::Zero(), Vector3(0.0, 0.2, 0.0)}), 0.2 / radius, 1e-12);
  EXPECT_NEAR(find_lacking_force(params, 0.0, {Vector3::Zero(), Vector3(0.0, 0.0, 0.2)}), 0.2 / radius / mu, 1e-12);
  state.peel_impulse = 0.0;
  state.bend = params.limits.fail_bend;
  EXPECT_TRUE(peel_lip(params, {Vector3(0.0, 0.0, 8.0), Vector3::Zero()}, 1e-3, state));
}

}  // namespace
}  // namespace snug::cup
