// Tests of settle: reference equilibria, closed forms, symmetric and unstable loads, loads beyond the cup's capacity.
#include "snug/cup/statics.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "snug/cup/test/vectors.hpp"

namespace snug::cup {
namespace {

using std::numbers::pi;

/// The default cup, hanging straight down.
HeldLoad hanging(double mass, const Vector3& p_SScm) {
  HeldLoad load;
  load.R_WE = Vector3(1.0, -1.0, -1.0).asDiagonal();
  load.mass = mass;
  load.p_SScm = p_SScm;
  load.stiffness = as_matrix({2500.0, 6000.0, 5.0, 3.0, 0.0});
  load.X_ES2.p = Vector3(0.0, 0.0, 0.025);
  load.X_SS1.p = Vector3(0.0, 0.0, -0.025);
  return load;
}

HeldLoad tilted(double mass, const Vector3& p_SScm, double tilt) {
  HeldLoad load = hanging(mass, p_SScm);
  load.R_WE = exp_rotation(Vector3(tilt, 0.0, 0.0)) * load.R_WE;
  return load;
}

/// V - m g . p: its minima are the stable equilibria.
double energy(const HeldLoad& load, const Pose& H) {
  const Pose X_ES = load.X_ES2 * H * load.X_SS1.inverse();
  return potential(H, load.stiffness) - load.mass * load.gravity_W.dot(load.R_WE * (X_ES * load.p_SScm));
}

TEST(Settle, AgreesWithTheReferenceEquilibria) {
  const nlohmann::json vectors = test::load_vectors("static.json");
  if (vectors.is_null()) GTEST_SKIP() << "reference data not found: " << test::vectors_path("static.json");
  ASSERT_EQ(vectors.at("cases").size(), 15u);
  test::Worst position("position_m"), turn("turn_rad");
  for (const nlohmann::json& c : vectors.at("cases")) {
    SCOPED_TRACE(c.at("id").dump());
    HeldLoad load;
    load.R_WE = test::matrix3(c.at("W_R_E"));
    load.mass = c.at("mass").get<double>();
    load.p_SScm = test::vector3(c.at("com_S"));
    load.stiffness = test::matrix6(c.at("K"));
    load.X_ES2 = test::pose(c.at("E_H_S2"));
    load.X_SS1 = test::pose(c.at("S_H_S1"));
    const SettleResult result = settle(load);
    EXPECT_EQ(result.status, SettleStatus::Converged);
    // Tolerances: those that the vectors come with.
    EXPECT_LE(position.add((result.X_ES.p - test::vector3(c.at("E_o_S"))).norm()), 1e-7);
    EXPECT_LE(turn.add(angle_between(result.X_ES.R, test::matrix3(c.at("E_R_S")))), 1e-6);
    EXPECT_LE((result.H.p - test::vector3(c.at("H_o"))).norm(), 1e-7);
    EXPECT_TRUE(result.is_stable);
    EXPECT_NEAR(result.smallest_eigenvalue, c.at("min_tangent_eig").get<double>(), 1e-6);  // as the rotation
    EXPECT_LE(result.residual, 1e-10);                                                     // of 50 N and Nm x 20
    EXPECT_EQ(result.load_fraction, 1.0);
  }
}

TEST(Settle, StretchesAStraightCupByWeightOverStiffness) {
  const SettleResult result = settle(hanging(0.55, Vector3(0.0, 0.0, 0.05)));
  ASSERT_EQ(result.status, SettleStatus::Converged);
  EXPECT_NEAR(result.X_ES.p.z(), 0.05 + 0.55 * 9.81 / 6000.0, 1e-15);
  EXPECT_EQ(result.bend, 0.0);
  EXPECT_TRUE(result.is_stable);
}

TEST(Settle, RestsAtALocalMinimumOfTheEnergy) {
  Rng rng = Rng(1).split("minimum");
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE(i);
    HeldLoad load = tilted(rng.uniform(0.1, 1.0), test::random_vector(rng, 0.03) + Vector3(0.0, 0.0, 0.05), 0.0);
    load.R_WE = exp_rotation(test::random_vector(rng, 1.8));
    const SettleResult result = settle(load);
    ASSERT_EQ(result.status, SettleStatus::Converged);
    ASSERT_TRUE(result.is_stable);
    const double at_rest = energy(load, result.H);
    for (int j = 0; j < 40; ++j) {
      const Vector3 shift = test::random_vector(rng, 1e-4), turn = test::random_vector(rng, 1e-3);
      const Pose nearby{result.H.R * exp_rotation(turn), result.H.p + shift};
      EXPECT_GT(energy(load, nearby), at_rest);
    }
  }
}

TEST(Settle, DoesNotDependOnTheNumberOfLoadSteps) {
  for (const double tilt : {0.3, 1.0, 1.57, 2.5}) {
    const HeldLoad load = tilted(1.05, Vector3(0.02, -0.01, 0.06), tilt);
    const SettleResult few = settle(load, {.load_steps = 2}), many = settle(load, {.load_steps = 64});
    ASSERT_EQ(few.status, SettleStatus::Converged);
    EXPECT_LE((few.X_ES.p - many.X_ES.p).norm(), 1e-12);  // both are solved to rounding
    EXPECT_LE((few.X_ES.R - many.X_ES.R).norm(), 1e-11);
  }
}

TEST(Settle, FindsAnUprightLoadBalancedAndSaysWhetherItWouldTip) {
  // Cup pointing up, load on top: straight is an equilibrium for every mass, stable while k_bend holds the moment.
  for (const double mass : {0.5, 2.0, 20.0}) {
    SCOPED_TRACE(mass);
    HeldLoad load = hanging(mass, Vector3(0.0, 0.0, 0.1));
    load.R_WE.setIdentity();
    const SettleResult result = settle(load);
    ASSERT_EQ(result.status, SettleStatus::Converged);
    EXPECT_NEAR(result.H.p.z(), -mass * 9.81 / 6000.0, 1e-13);
    EXPECT_EQ(result.bend, 0.0);
    // Second variation about the straight state: bending k_bend against the weight on its arm, plus shear.
    EXPECT_EQ(result.is_stable, mass < 3.0) << result.smallest_eigenvalue;
  }
}

TEST(Settle, SaysSoWhenTheMomentIsMoreThanTheCupCanHold) {
  // The cup gives k_bend / 2 = 2.5 Nm at most; these loads ask for 9 Nm and more in the undeformed pose.
  for (const double mass : {8.0, 20.0, 200.0}) {
    for (const double tilt : {0.0, 0.5, 1.5, 2.5}) {
      SCOPED_TRACE(std::to_string(mass) + " kg, tilt " + std::to_string(tilt));
      const SettleResult result = settle(tilted(mass, Vector3(0.12, 0.0, 0.05), tilt));
      EXPECT_EQ(result.status, SettleStatus::BeyondCapacity);
      EXPECT_FALSE(result.is_stable);
      EXPECT_GT(result.load_fraction, 0.0);
      EXPECT_TRUE(result.X_ES.p.allFinite());
      EXPECT_TRUE(result.load_fraction < 1.0 || result.bend >= pi / 4.0);
    }
  }
}

TEST(Settle, TwistsAsTheClosedFormSaysUpToARightAngle) {
  // Torsion by a weight beside a horizontal axis, every other direction rigid: (k/2) sin(2 a) = m g L cos(a), so
  // sin(a) = m g L / k while that is below 1; heavier loads hang straight down, held by gravity alone.
  HeldLoad load;
  load.R_WE = exp_rotation(Vector3(-0.5 * pi, 0.0, 0.0));  // Ez along Wy, Ex along Wx
  load.p_SScm = Vector3(0.1, 0.0, 0.0);
  load.stiffness = as_matrix({1e9, 1e9, 1e6, 3.0, 0.0});
  for (const double share : {0.1, 0.5, 0.9, 0.99}) {
    SCOPED_TRACE(share);
    load.mass = share * 3.0 / (9.81 * 0.1);
    const SettleResult result = settle(load);
    ASSERT_EQ(result.status, SettleStatus::Converged);
    // The other directions give by less than 1e-6 rad.
    EXPECT_NEAR(angle_between(result.H.R, Matrix3::Identity()), std::asin(share), 1e-4);
    EXPECT_TRUE(result.is_stable);
  }
  load.mass = 1.01 * 3.0 / (9.81 * 0.1);
  const SettleResult beyond = settle(load);
  EXPECT_EQ(beyond.status, SettleStatus::Converged);
  EXPECT_NEAR(angle_between(beyond.H.R, Matrix3::Identity()), 0.5 * pi, 1e-3);
}

TEST(Settle, RefusesWhatIsNotALoad) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  HeldLoad load = hanging(1.0, Vector3::Zero());
  load.mass = nan;
  EXPECT_EQ(settle(load).status, SettleStatus::BadInput);
  load = hanging(-1.0, Vector3::Zero());
  EXPECT_EQ(settle(load).status, SettleStatus::BadInput);
  load = hanging(1.0, Vector3(0.0, nan, 0.0));
  EXPECT_EQ(settle(load).status, SettleStatus::BadInput);
  load = hanging(1.0, Vector3::Zero());
  load.stiffness(3, 3) = 0.0;
  EXPECT_EQ(settle(load).status, SettleStatus::BadInput);
  load = hanging(0.0, Vector3::Zero());
  EXPECT_EQ(settle(load).status, SettleStatus::Converged);
  EXPECT_EQ(settle(load).iterations, 0);
}

}  // namespace
}  // namespace snug::cup
