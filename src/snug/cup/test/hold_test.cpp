// Tests of the hold: each limit trips alone where its formula says, leaking before peeling, and the push of a release.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/cup/phases.hpp"
#include "snug/physics/world.hpp"

namespace snug::cup {
namespace {

constexpr double kPressure = -6.0e4;
const Vector3 kNone = Vector3::Zero();

/// Suction of the whole disc, N.
double suction(const model::CupParams& params, double pressure = kPressure) {
  return -pressure * std::numbers::pi * params.effective_diameter * params.effective_diameter / 4.0;
}

/// On the package, in S: z into it, so a load that hangs from the lip is pulled by a force along -z of S.
Wrench wrench(const Vector3& force, const Vector3& torque = Vector3::Zero()) { return {force, torque}; }

TEST(HoldLoss, IsNoneWithoutLoad) {
  const model::CupParams params;
  EXPECT_EQ(find_hold_loss(params, kPressure, Wrench{}, 0.0), HoldLoss::None);
  EXPECT_EQ(find_leak(params, kPressure, Wrench{}), 0.0);
}

TEST(HoldLoss, IsTensionWhereThePullReachesTheSuction) {
  const model::CupParams params;
  const double limit = suction(params);
  EXPECT_EQ(find_hold_loss(params, kPressure, wrench({0.0, 0.0, -0.999 * limit}), 0.0), HoldLoss::None);
  EXPECT_EQ(find_hold_loss(params, kPressure, wrench({0.0, 0.0, -1.001 * limit}), 0.0), HoldLoss::Tension);
  // Pressed on, it can be any force; without vacuum none.
  EXPECT_EQ(find_hold_loss(params, kPressure, wrench({0.0, 0.0, 100.0 * limit}), 0.0), HoldLoss::None);
  EXPECT_EQ(find_hold_loss(params, 0.0, wrench({0.0, 0.0, -1e-6}), 0.0), HoldLoss::Tension);
}

TEST(HoldLoss, IsShearWhereTheFrictionOfTheLipEnds) {
  const model::CupParams params;
  const double limit = params.lip_friction * suction(params);
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 6.0;
    const Vector3 way(std::cos(angle), std::sin(angle), 0.0);
    EXPECT_EQ(find_hold_loss(params, kPressure, wrench(0.999 * limit * way), 0.0), HoldLoss::None);
    EXPECT_EQ(find_hold_loss(params, kPressure, wrench(1.001 * limit * way), 0.0), HoldLoss::Shear);
  }
}

TEST(HoldLoss, IsShearWhereTheLipTwistsOff) {
  const model::CupParams params;
  const double limit = params.lip_friction * suction(params) * params.lip_radius;
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_EQ(find_hold_loss(params, kPressure, wrench(kNone, {0.0, 0.0, sign * 0.999 * limit}), 0.0), HoldLoss::None);
    EXPECT_EQ(find_hold_loss(params, kPressure, wrench(kNone, {0.0, 0.0, sign * 1.001 * limit}), 0.0), HoldLoss::Shear);
  }
}

TEST(HoldLoss, OfShearAndTwistTogetherLiesOnTheEllipse) {
  const model::CupParams params;
  const double force = params.lip_friction * suction(params), torque = force * params.lip_radius;
  for (int i = 0; i <= 18; ++i) {
    const double angle = i * std::numbers::pi / 36.0, c = std::cos(angle), s = std::sin(angle);
    EXPECT_EQ(
        find_hold_loss(params, kPressure, wrench({0.0, 0.999 * c * force, 0.0}, {0.0, 0.0, 0.999 * s * torque}), 0.0),
        HoldLoss::None);
    EXPECT_EQ(
        find_hold_loss(params, kPressure, wrench({0.0, 1.001 * c * force, 0.0}, {0.0, 0.0, 1.001 * s * torque}), 0.0),
        HoldLoss::Shear);
  }
}

TEST(HoldFactor, IsWhereTheHoldIsLost) {
  const model::CupParams params;
  Rng rng = Rng(11).split("hold factor");
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const auto vector = [&](double size) {
      return Vector3(rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size));
    };
    const Wrench load = wrench(vector(50.0), vector(2.0));
    const double factor = find_hold_factor(params, kPressure, load);
    const auto times = [&](double k) { return wrench(k * load.force, k * load.torque); };
    if (!std::isfinite(factor)) {
      EXPECT_EQ(find_hold_loss(params, kPressure, times(1e6), 0.0), HoldLoss::None);
      continue;
    }
    EXPECT_EQ(find_hold_loss(params, kPressure, times(0.9999 * factor), 0.0), HoldLoss::None);
    EXPECT_NE(find_hold_loss(params, kPressure, times(1.0001 * factor), 0.0), HoldLoss::None);
  }
}

TEST(HoldFactor, OfNoLoadIsInfiniteAndOfNoVacuumZero) {
  const model::CupParams params;
  EXPECT_EQ(find_hold_factor(params, kPressure, Wrench{}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(find_hold_factor(params, 0.0, wrench({0.0, 0.0, -1.0})), 0.0);
}

TEST(HoldFactor, SensedAtTheToolIsThatOfTheLip) {
  const model::CupParams params;
  Rng rng = Rng(12).split("sensed");
  const auto vector = [&](double size) {
    return Vector3(rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size));
  };
  for (int i = 0; i < 200; ++i) {
    const Wrench on_box = wrench(vector(40.0), vector(2.0));  // about the lip, in S = E shifted by the cup's length
    const Vector3 p_ES(0.0, 0.0, params.hold_length);
    const Wrench on_tool = wrench(-on_box.force, -on_box.torque - p_ES.cross(on_box.force));
    // Inverse: the factor is infinite where the box is pressed on.
    EXPECT_NEAR(1.0 / sensed_hold_factor(params, kPressure, on_tool), 1.0 / find_hold_factor(params, kPressure, on_box),
                1e-12);
  }
  // 12 N sideways at the lip, 0.05 m below E: what the sensor reads as 12 N and 0.6 Nm is no torque at the lip.
  EXPECT_NEAR(sensed_hold_factor(params, kPressure, wrench({12.0, 0.0, 0.0}, {0.0, 12.0 * params.hold_length, 0.0})),
              params.lip_friction * suction(params) / 12.0, 1e-9);
}

TEST(HoldFactor, IsNotSensedBeforeTheVacuumIsEstablished) {
  const model::CupParams params;
  const Wrench load = wrench({30.0, 0.0, 0.0});
  const double established = kEstablishedVacuum * params.vacuum.pressure_gauge_hold;
  EXPECT_TRUE(std::isinf(sensed_hold_factor(params, established + 1.0, load)));
  EXPECT_TRUE(std::isfinite(sensed_hold_factor(params, established - 1.0, load)));
  EXPECT_TRUE(std::isinf(sensed_hold_factor(params, 0.0, load)));
}

TEST(HoldLoss, IsPeelWhereTheBendingMomentLiftsTheRim) {
  const model::CupParams params;
  const double limit = params.limits.peel_full * suction(params) * params.lip_radius;
  for (int i = 0; i < 12; ++i) {
    const double angle = i * std::numbers::pi / 6.0;
    const Vector3 axis(std::cos(angle), std::sin(angle), 0.0);
    EXPECT_EQ(find_hold_loss(params, kPressure, wrench(kNone, 0.999 * limit * axis), 0.0), HoldLoss::None);
    EXPECT_EQ(find_hold_loss(params, kPressure, wrench(kNone, 1.001 * limit * axis), 0.0), HoldLoss::Peel);
  }
}

TEST(HoldLoss, IsBendingAtTheCapacityOfTheLawWhateverTheWrench) {
  const model::CupParams params;
  const double limit = 45.0 * std::numbers::pi / 180.0;
  EXPECT_EQ(find_hold_loss(params, kPressure, Wrench{}, limit - 1e-9), HoldLoss::None);
  EXPECT_EQ(find_hold_loss(params, kPressure, Wrench{}, limit), HoldLoss::Bending);
  EXPECT_EQ(find_hold_loss(params, kPressure, wrench({0.0, 0.0, -1e6}), limit), HoldLoss::Bending);
}

TEST(HoldLoss, ComesEarlierWithLessVacuumAndMorePull) {
  const model::CupParams params;
  Rng rng = Rng(1).split("monotone");
  int lost = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto draw = [&rng](double size) { return rng.uniform(-size, size); };
    const double n = suction(params);
    Wrench load = wrench({draw(0.4 * n), draw(0.4 * n), draw(n)}, {draw(3.0), draw(3.0), draw(2.0)});
    if (find_hold_loss(params, kPressure, load, 0.0) == HoldLoss::None) continue;
    ++lost;
    EXPECT_NE(find_hold_loss(params, 0.7 * kPressure, load, 0.0), HoldLoss::None);
    load.force.z() -= rng.uniform(0.0, n);
    EXPECT_NE(find_hold_loss(params, kPressure, load, 0.0), HoldLoss::None);
  }
  EXPECT_GT(lost, 200);
}

TEST(Leak, GrowsFromTheOnsetAndEndsWithTheWholeVacuum) {
  const model::CupParams params;
  const double moment = suction(params) * params.lip_radius;
  const auto leak = [&](double share) {
    return find_leak(params, kPressure, wrench(kNone, {share * moment, 0.0, 0.0}));
  };
  EXPECT_EQ(leak(0.0), 0.0);
  EXPECT_EQ(leak(params.limits.peel_onset * (1.0 - 1e-12)), 0.0);
  for (const double excess : {0.1, 0.25, 0.5}) {
    // The gain per unit of excess; a few roundings.
    EXPECT_NEAR(leak(params.limits.peel_onset + excess), params.limits.leak_gain * excess, 1e-14);
  }
  EXPECT_EQ(leak(100.0), 1.0);
  EXPECT_EQ(find_leak(params, kPressure, wrench({0.0, 0.0, -2.0 * suction(params)})), 1.0);  // pulled off
  EXPECT_EQ(find_leak(params, 0.0, Wrench{}), 1.0);                                          // nothing holds it
}

TEST(Leak, RunsAwayUntilTheLipPeelsWhenTheMomentIsTooLarge) {
  // Less vacuum, less normal force, more lift: just above the onset it settles, near the limit it runs away.
  const model::CupParams params;
  const double moment = suction(params, params.vacuum.pressure_gauge_hold) * params.lip_radius;
  const auto loss_with = [&](double share) {
    CupState state;
    state.phase = CupPhase::Holding;
    state.pressure_gauge = params.vacuum.pressure_gauge_hold;
    const Wrench load = wrench(kNone, {0.0, share * moment, 0.0});
    for (int i = 0; i < 5000; ++i) {
      state.leak = find_leak(params, state.pressure_gauge, load);
      advance_pressure(params, {true, false}, 1e-3, state);
      const HoldLoss loss = find_hold_loss(params, state.pressure_gauge, load, 0.0);
      if (loss != HoldLoss::None) return loss;
    }
    // Settled: p = 1 - gain (share / p - onset), in units of the set point.
    const double p = state.pressure_gauge / params.vacuum.pressure_gauge_hold;
    if (share > params.limits.peel_onset) {
      EXPECT_NEAR(p, 1.0 - params.limits.leak_gain * (share / p - params.limits.peel_onset), 1e-6);
      EXPECT_LT(p, 1.0);
    } else {
      EXPECT_NEAR(p, 1.0, 1e-12);
    }
    return HoldLoss::None;
  };
  EXPECT_EQ(loss_with(0.4), HoldLoss::None);
  EXPECT_EQ(loss_with(0.6), HoldLoss::None);
  // p^2 - (1 + gain onset) p + gain share = 0 and share < p: solvable for share below 0.75 with gain = onset = 0.5.
  EXPECT_EQ(loss_with(0.74), HoldLoss::None);
  EXPECT_EQ(loss_with(0.79), HoldLoss::Peel);
}

/// A box on a table under a cup that was holding it at `hold_length` and is released: what the growing bellows do.
struct Release {
  physics::WorldModel model;
  double top = 0.0;
  explicit Release(double mass) {
    physics::BodyModel gripper, parcel;
    gripper.kind = physics::BodyKind::Kinematic;
    parcel.inertia.mass = mass;
    parcel.inertia.inertia = Matrix3::Identity() * mass * 0.004;
    parcel.geoms = {{geometry::Box{Vector3(0.1, 0.1, 0.05)}, Pose{}, 0, true}};
    gripper.X_WB = {exp_rotation(Vector3(std::numbers::pi, 0.0, 0.0)), Vector3(0.0, 0.0, 0.1)};
    model.bodies = {gripper, parcel};
    model.laws = {{}};
    model.gravity.setZero();
    model.settings.sleep.enabled = false;
    model.finalize();
  }
};

TEST(Release, PushesABoxAwayWithAtMostTheEnergyOfTheLip) {
  const model::CupParams params;
  const double stiffness = params.free_stiffness_ratio * params.stiffness.axial;
  const double stroke = params.free_length - params.hold_length;
  for (const double damping : {0.0, params.free_damping_ratio * params.damping.axial}) {
    for (const double mass : {0.26, 1.7}) {
      SCOPED_TRACE(mass);
      Release release(mass);
      release.model.bodies[1].X_WB.p.z() = 0.1 - params.hold_length - 0.05;  // its top is at the lip
      physics::WorldState state = physics::make_state(release.model);
      physics::Workspace work(release.model);
      const LipPush push(stiffness, damping, params.free_length, Vector3(0.0, 0.0, 0.05), Vector3::UnitZ());
      const physics::ElementUse use{&push, physics::BodyId{0}, {}, physics::BodyId{1}};
      physics::WorldInput input;
      input.elements = {&use, 1};
      for (int i = 0; i < 400; ++i) {
        ASSERT_EQ(physics::step(release.model, input, state, work).status, physics::StepStatus::Converged);
      }
      const double energy = physics::kinetic_energy(release.model, state), stored = 0.5 * stiffness * stroke * stroke;
      EXPECT_LT(state.bodies[1].velocity.z(), 0.0);  // away from the gripper above
      EXPECT_LE(energy, stored * (1.0 + 1e-3));
      if (damping == 0.0) {
        // All of it, but for the step in which the lip leaves: its end is known to w dt of a quarter swing, squared.
        const double w_dt = std::sqrt(stiffness / mass) * release.model.settings.dt;
        EXPECT_NEAR(energy / stored, 1.0, w_dt * w_dt);
      } else {
        EXPECT_LT(energy, stored);
      }
    }
  }
}

}  // namespace
}  // namespace snug::cup
