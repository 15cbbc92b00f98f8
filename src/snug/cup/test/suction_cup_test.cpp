// Tests of SuctionCup: its wrench, stiffness and damping as the step uses them.
#include "snug/cup/suction_cup.hpp"

#include "snug/cup/test/vectors.hpp"

namespace snug::cup {
namespace {

using test::difference;
using test::random_pose;
using test::random_stiffness;
using test::random_vector;

struct Scene {
  Matrix6 K, D;
  Pose X_ES2, X_PS, X_SS1;
  Vector3 p_BBcm;
  physics::ElementQuery query;
};

/// A held body somewhere in the world, the cup deformed by up to `turn` rad and 10 mm, everything moving.
Scene random_scene(Rng& rng, double turn) {
  Scene s;
  s.K = random_stiffness(rng);
  s.D = 0.004 * random_stiffness(rng);
  s.X_ES2 = random_pose(rng, 3.0, 0.05);
  s.X_PS = random_pose(rng, 3.0, 0.2);
  s.X_SS1 = random_pose(rng, 3.0, 0.05);
  s.p_BBcm = random_vector(rng, 0.1);
  s.query.X_WE = random_pose(rng, 3.0, 1.0);
  const Pose H = random_pose(rng, turn, 0.01);
  s.query.X_WB = s.query.X_WE * s.X_ES2 * H * (s.X_PS * s.X_SS1).inverse();
  s.query.p_WBcm = s.query.X_WB * s.p_BBcm;
  s.query.V_WE = {random_vector(rng, 0.5), random_vector(rng, 1.0)};
  s.query.V_WB = {random_vector(rng, 0.5), random_vector(rng, 1.0)};
  return s;
}

SuctionCup cup_of(const Scene& s) { return {s.K, s.D, s.X_ES2, s.X_PS, s.X_SS1}; }

/// The query after the centre of mass moved by x.head and the body turned by x.tail about it, in W;
/// velocity of the centre of mass and angular velocity changed by v.
physics::ElementQuery moved(const Scene& s, const Vector6& x, const Vector6& v) {
  physics::ElementQuery q = s.query;
  const Vector3 w = s.query.V_WB.angular + v.tail<3>();
  const Vector3 v_cm = s.query.V_WB.linear + s.query.V_WB.angular.cross(s.query.X_WB.R * s.p_BBcm) + v.head<3>();
  q.X_WB.R = exp_rotation(x.tail<3>()) * s.query.X_WB.R;
  q.p_WBcm = s.query.p_WBcm + x.head<3>();
  const Vector3 arm = q.X_WB.R * s.p_BBcm;
  q.X_WB.p = q.p_WBcm - arm;
  q.V_WB = {v_cm - w.cross(arm), w};
  return q;
}

TEST(SuctionCup, StiffnessAndDampingAreTheDerivativesOfItsWrenchWhileEverythingMoves) {
  Rng rng = Rng(1).split("derivatives");
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Scene s = random_scene(rng, 0.8);
    const SuctionCup cup = cup_of(s);
    const physics::ElementResponse response = cup.evaluate(s.query);
    for (int j = 0; j < 6; ++j) {
      const double h = j < 3 ? 1e-4 : 1e-3;
      const Vector6 by_x = difference(
          [&](double t) -> Vector6 { return cup.evaluate(moved(s, t * Vector6::Unit(j), Vector6::Zero())).wrench; }, h);
      // Fourth-order differences, truncation and rounding each near 1e-10 of the largest entry.
      EXPECT_LE((by_x + response.stiffness.col(j)).head<3>().norm(), 1e-7 * response.stiffness.topRows<3>().norm());
      EXPECT_LE((by_x + response.stiffness.col(j)).tail<3>().norm(), 1e-7 * response.stiffness.bottomRows<3>().norm());
      const Vector6 by_v = difference(
          [&](double t) -> Vector6 { return cup.evaluate(moved(s, Vector6::Zero(), t * Vector6::Unit(j))).wrench; },
          1e-1);
      // Linear in velocity: rounding only.
      EXPECT_LE((by_v + response.damping.col(j)).norm(), 1e-10 * (response.damping.norm() + response.wrench.norm()));
    }
  }
}

TEST(SuctionCup, WrenchWithoutDampingIsTheNegativeGradientOfItsEnergy) {
  Rng rng = Rng(2).split("energy");
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    Scene s = random_scene(rng, 0.8);
    s.D.setZero();
    const SuctionCup cup = cup_of(s);
    const physics::ElementResponse response = cup.evaluate(s.query);
    Vector6 gradient;
    for (int j = 0; j < 6; ++j) {
      gradient[j] =
          difference([&](double t) { return cup.evaluate(moved(s, t * Vector6::Unit(j), Vector6::Zero())).energy; },
                     j < 3 ? 1e-4 : 1e-3);
    }
    EXPECT_LE((gradient + response.wrench).norm(), 1e-8 * (1.0 + response.wrench.norm()));  // as above
  }
}

TEST(SuctionCup, DamperTakesEnergyFromTheRelativeMotionAndKnowsNoOther) {
  Rng rng = Rng(3).split("damper");
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    Scene s = random_scene(rng, 0.8);
    const SuctionCup with = cup_of(s);
    Scene undamped = s;
    undamped.D.setZero();
    const SuctionCup without = cup_of(undamped);
    const Vector6 damper = with.evaluate(s.query).wrench - without.evaluate(s.query).wrench;
    // Power into body and carrier together, the carrier's part by action and reaction at the centre of mass.
    Vector6 relative;
    const Vector3 w_B = s.query.V_WB.angular, w_E = s.query.V_WE.angular;
    relative << s.query.V_WB.linear + w_B.cross(s.query.p_WBcm - s.query.X_WB.p) - s.query.V_WE.linear -
                    w_E.cross(s.query.p_WBcm - s.query.X_WE.p),
        w_B - w_E;
    EXPECT_LT(damper.dot(relative), 0.0);
    // Carried along rigidly, it does nothing.
    s.query.V_WB = {s.query.V_WE.linear + w_E.cross(s.query.X_WB.p - s.query.X_WE.p), w_E};
    const Vector6 carried = with.evaluate(s.query).wrench - without.evaluate(s.query).wrench;
    EXPECT_LE(carried.norm(), 1e-13 * s.D.norm());  // rounding of velocities near 1 m/s, times D
  }
}

TEST(SuctionCup, DoesNotDependOnWhereTheWorldIs) {
  Rng rng = Rng(4).split("invariance");
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Scene s = random_scene(rng, 0.8);
    const SuctionCup cup = cup_of(s);
    const Pose g = random_pose(rng, 3.0, 1.0);
    physics::ElementQuery q = s.query;
    q.X_WE = g * q.X_WE;
    q.X_WB = g * q.X_WB;
    q.p_WBcm = g * q.p_WBcm;
    q.V_WE = {g.R * q.V_WE.linear, g.R * q.V_WE.angular};
    q.V_WB = {g.R * q.V_WB.linear, g.R * q.V_WB.angular};
    const Vector6 before = cup.evaluate(s.query).wrench, after = cup.evaluate(q).wrench;
    // Positions near 2 m make deformations of 10 mm with 4e-16 m of rounding, times the stiffness.
    const double tolerance = 1e-14 * s.K.norm();
    EXPECT_LE((after.head<3>() - g.R * before.head<3>()).norm(), tolerance);
    EXPECT_LE((after.tail<3>() - g.R * before.tail<3>()).norm(), tolerance);
    EXPECT_LE((as_vector(cup.lip_wrench(q)) - as_vector(cup.lip_wrench(s.query))).norm(), tolerance);
  }
}

TEST(SuctionCup, LipWrenchIsTheSameWrenchAboutTheLip) {
  Rng rng = Rng(5).split("lip");
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Scene s = random_scene(rng, 0.8);
    const SuctionCup cup = cup_of(s);
    const Vector6 about_cm = cup.evaluate(s.query).wrench;
    const Wrench lip = cup.lip_wrench(s.query);
    const Pose X_WS = s.query.X_WB * s.X_PS;
    const Vector3 force_W = X_WS.R * lip.force;
    const Vector3 torque_W = X_WS.R * lip.torque + (X_WS.p - s.query.p_WBcm).cross(force_W);
    // Two routes of a dozen roundings each.
    EXPECT_LE((force_W - about_cm.head<3>()).norm(), 1e-12 * (1.0 + force_W.norm()));
    EXPECT_LE((torque_W - about_cm.tail<3>()).norm(), 1e-12 * (1.0 + force_W.norm() + torque_W.norm()));
  }
}

TEST(SuctionCup, LipWrenchAgreesWithTheReferenceVectors) {
  const nlohmann::json vectors = test::load_vectors("wrench.json");
  if (vectors.is_null()) GTEST_SKIP() << "reference data not found: " << test::vectors_path("wrench.json");
  for (const nlohmann::json& c : vectors.at("cases")) {
    SCOPED_TRACE(c.at("id").dump());
    const Pose H{test::matrix3(c.at("R")), test::vector3(c.at("o"))};
    const Pose X_SS1{test::matrix3(c.at("S_R_S1")), test::vector3(c.at("S_o_S1"))};
    const SuctionCup cup(test::matrix6(c.at("K")), Matrix6::Zero(), Pose{}, Pose{}, X_SS1);
    physics::ElementQuery query;  // E = S2 = W and the package's frame is its lip
    query.X_WB = H * X_SS1.inverse();
    const Vector6 want = test::vector6(c.at("wrench_S"));
    // 1e-9 is the vectors' own; the frames in between cost 1e-17 m of rounding, times the stiffness.
    EXPECT_LE((as_vector(cup.lip_wrench(query)) - want).norm(),
              1e-9 * (want.norm() + 1e-6) + 1e-16 * test::matrix6(c.at("K")).norm());
  }
}

TEST(SuctionCup, OfTheDefaultParametersHangsItsLipOneHoldLengthBelowTheGripper) {
  const model::CupParams params;
  const SuctionCup cup(params, Pose{});
  physics::ElementQuery query;
  query.X_WB.p = Vector3(0.0, 0.0, params.hold_length);
  query.p_WBcm = query.X_WB.p;
  EXPECT_LE(cup.evaluate(query).wrench.norm(), 1e-12);  // at rest there: rounding of 0.05 m times 6000 N/m
  EXPECT_LE(cup.evaluate(query).energy, 1e-24);
}

}  // namespace
}  // namespace snug::cup
