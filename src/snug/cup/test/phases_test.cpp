// Tests of the vacuum phases: when a lip seals and why not, how pressure runs, what makes a hold fail, and the push.
#include "snug/cup/phases.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"

namespace snug::cup {
namespace {

using std::numbers::pi;

const Vector3 kHalf(0.1, 0.075, 0.05);
constexpr double kDegree = pi / 180.0;

/// A gripper that looks down at the box's top face from `length` (E to face along Ez), tilted about the face's x axis
/// and standing over the point (x, y) of the face.
Pose above(double length, double x = 0.0, double y = 0.0, double tilt = 0.0) {
  Pose X_WE;
  X_WE.R = exp_rotation(Vector3(tilt, 0.0, 0.0)) * exp_rotation(Vector3(pi, 0.0, 0.0));
  X_WE.p = Vector3(x, y, kHalf.z()) - length * X_WE.R.col(2);
  return X_WE;
}

TEST(CupMode, IsReadByTheNameThatItIsWrittenWith) {
  for (const CupMode mode : {CupMode::Holding, CupMode::Phases}) EXPECT_EQ(cup_mode_of(name_of(mode), "here"), mode);
  EXPECT_THROW((void)cup_mode_of("magnet", "here"), InputError);
}

TEST(Seal, IsFoundWithinReachAndNotBeyond) {
  const model::CupParams params;
  const double limit = params.free_length + params.seal.reach;
  EXPECT_TRUE(try_seal(params, above(limit - 1e-9), kHalf, Pose{}));
  const auto no = try_seal(params, above(limit + 1e-9), kHalf, Pose{});
  ASSERT_FALSE(no);
  EXPECT_EQ(no.error().reason, NoSeal::OutOfReach);
  EXPECT_NEAR(no.error().gap, params.seal.reach, 2e-9);  // what was asked for
}

TEST(Seal, IsRefusedWhereTheAxisMissesTheBoxOrTheGripperIsInsideIt) {
  const model::CupParams params;
  for (const Pose& X_WE : {above(0.05, 0.11), above(0.05, 0.0, -0.08), above(-0.01),
                           Pose{Matrix3::Identity(), Vector3(0.0, 0.0, 0.1)}}) {  // the last looks away
    const auto no = try_seal(params, X_WE, kHalf, Pose{});
    ASSERT_FALSE(no);
    EXPECT_EQ(no.error().reason, NoSeal::OutOfReach);
  }
}

TEST(Seal, IsRefusedWhenTheFaceIsTooTilted) {
  const model::CupParams params;
  const double limit = params.seal.max_tilt;
  EXPECT_TRUE(try_seal(params, above(0.07, 0.0, 0.0, limit - 1e-6), kHalf, Pose{}));
  const auto no = try_seal(params, above(0.07, 0.0, 0.0, limit + 1e-6), kHalf, Pose{});
  ASSERT_FALSE(no);
  EXPECT_EQ(no.error().reason, NoSeal::TooTilted);
  EXPECT_NEAR(no.error().tilt, limit + 1e-6, 1e-12);  // an arc cosine away from its ends: rounding
}

TEST(Seal, IsRefusedOverAnEdge) {
  const model::CupParams params;
  const double limit_x = kHalf.x() - 0.5 * params.effective_diameter + params.seal.max_overhang;
  const double limit_y = kHalf.y() - 0.5 * params.effective_diameter + params.seal.max_overhang;
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(try_seal(params, above(0.07, sign * (limit_x - 1e-9)), kHalf, Pose{}));
    EXPECT_TRUE(try_seal(params, above(0.07, 0.0, sign * (limit_y - 1e-9)), kHalf, Pose{}));
    for (const Pose& X_WE : {above(0.07, sign * (limit_x + 1e-9)), above(0.07, 0.0, sign * (limit_y + 1e-9))}) {
      const auto no = try_seal(params, X_WE, kHalf, Pose{});
      ASSERT_FALSE(no);
      EXPECT_EQ(no.error().reason, NoSeal::OverEdge);
      EXPECT_NEAR(no.error().overhang, params.seal.max_overhang, 2e-9);  // what was asked for
    }
  }
}

TEST(Seal, NamesTheNearestObstacleFirst) {
  const model::CupParams params;
  // Too far, too tilted and over the edge at once; then the last two.
  EXPECT_EQ(try_seal(params, above(0.2, 0.09, 0.0, 30.0 * kDegree), kHalf, Pose{}).error().reason, NoSeal::OutOfReach);
  EXPECT_EQ(try_seal(params, above(0.07, 0.09, 0.0, 30.0 * kDegree), kHalf, Pose{}).error().reason, NoSeal::TooTilted);
}

TEST(Seal, PutsTheLipOnTheFaceWhereTheAxisMeetsIt) {
  const model::CupParams params;
  Rng rng = Rng(1).split("seal");
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const double x = rng.uniform(-0.05, 0.05), y = rng.uniform(-0.03, 0.03), length = rng.uniform(0.06, 0.079);
    const double tilt = rng.uniform(-14.0, 14.0) * kDegree, yaw = rng.uniform(-3.0, 3.0);
    Pose X_PE = above(length, x, y, tilt);
    X_PE.R = X_PE.R * exp_rotation(Vector3(0.0, 0.0, yaw));
    const Pose X_WP{exp_rotation(Vector3(rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0))),
                    Vector3(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0))};
    const auto seal = try_seal(params, X_WP * X_PE, kHalf, X_WP);
    ASSERT_TRUE(seal);
    // Lengths near 1 m in W: a dozen roundings of 1e-16 m; the tilt as an arc cosine near 1 loses half of the digits.
    EXPECT_LT((seal->X_PS.p - Vector3(x, y, kHalf.z())).norm(), 1e-14);
    EXPECT_NEAR(seal->length, length, 1e-14);
    EXPECT_NEAR(seal->tilt, std::abs(tilt), 1e-7);
    EXPECT_LT((seal->X_PS.R.col(2) + Vector3::UnitZ()).norm(), 1e-14);  // into the package
    EXPECT_LT((seal->X_PS.R.transpose() * seal->X_PS.R - Matrix3::Identity()).norm(), 1e-14);
    EXPECT_NEAR(seal->X_PS.R.determinant(), 1.0, 1e-14);
    EXPECT_GT(seal->X_PS.R.col(0).dot(X_PE.R.col(0)), std::cos(15.0 * kDegree));  // yaw of E
  }
}

TEST(Seal, IsRefusedForAPoseThatIsNotANumber) {
  Pose X_WE = above(0.07);
  X_WE.p.z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(try_seal(model::CupParams{}, X_WE, kHalf, Pose{}));
  X_WE = above(0.07);
  X_WE.p.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(try_seal(model::CupParams{}, X_WE, kHalf, Pose{}));
}

TEST(Pressure, FollowsTheExponentialOfItsTimeConstantWhateverTheStep) {
  const model::CupParams params;
  for (const double dt : {1e-3, 4e-3, 20e-3}) {
    CupState state;
    state.phase = CupPhase::Holding;
    for (int i = 0; i < static_cast<int>(std::lround(0.2 / dt)); ++i) {
      advance_pressure(params, {true, false}, dt, state);
    }
    // Exact for a constant command: a rounding a step.
    EXPECT_NEAR(state.pressure_gauge / (params.vacuum.pressure_gauge_hold * (1.0 - std::exp(-1.0))), 1.0, 1e-12);
    state.phase = CupPhase::Releasing;
    const double start = state.pressure_gauge;
    for (int i = 0; i < static_cast<int>(std::lround(0.06 / dt)); ++i) advance_pressure(params, {}, dt, state);
    EXPECT_NEAR(state.pressure_gauge / (start * std::exp(-0.06 / params.vacuum.vent_time)), 1.0, 1e-12);
  }
}

TEST(Pressure, LosesTheShareThatLeaksAndStaysAtAmbientWithoutASeal) {
  const model::CupParams params;
  CupState state;
  state.phase = CupPhase::Holding;
  state.leak = 0.3;
  for (int i = 0; i < 5000; ++i) advance_pressure(params, {true, false}, 1e-3, state);
  EXPECT_NEAR(state.pressure_gauge / params.vacuum.pressure_gauge_hold, 0.7, 1e-9);  // e^-25 is left
  CupState open;
  for (int i = 0; i < 1000; ++i) advance_pressure(params, {true, false}, 1e-3, open);
  EXPECT_EQ(open.pressure_gauge, 0.0);
  for (int i = 0; i < 1000; ++i) advance_pressure(params, {false, true}, 1e-3, open);
  EXPECT_NEAR(open.pressure_gauge / params.vacuum.pressure_gauge_blow, 1.0, 1e-2);
}

TEST(Bellows, ShortensSmoothlyAndMonotonouslyFromFreeToHolding) {
  const model::CupParams params;
  EXPECT_DOUBLE_EQ(unloaded_length(params, 0.0), params.free_length);
  EXPECT_DOUBLE_EQ(unloaded_length(params, params.vacuum.pressure_gauge_blow), params.free_length);
  EXPECT_DOUBLE_EQ(unloaded_length(params, params.vacuum.pressure_gauge_collapse), params.hold_length);
  EXPECT_DOUBLE_EQ(unloaded_length(params, params.vacuum.pressure_gauge_hold), params.hold_length);
  double last = params.free_length;
  for (int i = 1; i <= 1000; ++i) {
    const double now = unloaded_length(params, params.vacuum.pressure_gauge_collapse * i / 1000.0);
    EXPECT_LT(now, last);
    // Largest slope of 3 x^2 - 2 x^3 is 1.5.
    EXPECT_LE(last - now, 1.5001e-3 * (params.free_length - params.hold_length));
    last = now;
  }
}

TEST(Bellows, KeepItsGasWhenSealed) {
  const model::CupParams params;
  const auto gas = [&params](const CupState& s) {
    return (params.vacuum.ambient_pressure_abs + s.pressure_gauge) *
           (params.vacuum.bellows_area * s.length + params.vacuum.hose_volume);
  };
  CupState state;
  state.phase = CupPhase::Holding;
  state.pressure_gauge = -3e4;
  follow_length(params, 0.06, state);
  EXPECT_EQ(state.pressure_gauge, -3e4);  // the first length is only taken down
  const double before = gas(state);
  for (const double length : {0.07, 0.05, 0.001, 0.06}) {
    const double last_length = state.length, last_pressure = state.pressure_gauge;
    follow_length(params, length, state);
    EXPECT_NEAR(gas(state) / before, 1.0, 1e-14);  // some roundings
    EXPECT_EQ(length > last_length, state.pressure_gauge < last_pressure);
  }
  EXPECT_NEAR(state.pressure_gauge, -3e4, 1e-9);  // back where it was
  follow_length(params, -1.0, state);
  EXPECT_TRUE(std::isfinite(state.pressure_gauge));
}

TEST(LipPush, ActsOnlyWhenCompressedAndOnlyPushes) {
  const double stiffness = 1500.0, damping = 4.0, length = 0.07;
  const LipPush push(stiffness, damping, length, Vector3(0.01, 0.02, 0.05), Vector3::UnitZ());
  physics::ElementQuery query;
  query.p_WBcm = Vector3(0.0, 0.0, -0.01);
  for (const double speed : {-1.0, 0.0, 1.0}) {
    query.V_WB.linear.z() = speed;  // toward the gripper above it
    query.X_WE.p = Vector3(0.01, 0.02, 0.05 + length + 1e-9);
    EXPECT_EQ(push.evaluate(query).wrench.norm(), 0.0);  // apart
    query.X_WE.p.z() = 0.05 + length - 0.004;
    const physics::ElementResponse response = push.evaluate(query);
    const double force = std::max(0.0, stiffness * 0.004 + damping * speed);
    EXPECT_NEAR(response.wrench[2], -force, 1e-11);  // rounding of 0.1 m times 1500 N/m
    EXPECT_NEAR(response.wrench[3], -0.02 * force, 1e-12);
    EXPECT_NEAR(response.wrench[4], 0.01 * force, 1e-12);
    EXPECT_NEAR(response.energy, 0.5 * stiffness * 0.004 * 0.004, 1e-13);
  }
  query.V_WB.linear.z() = -2.0;  // flees faster than the spring follows: no pull
  EXPECT_EQ(push.evaluate(query).wrench.norm(), 0.0);
}

}  // namespace
}  // namespace snug::cup
