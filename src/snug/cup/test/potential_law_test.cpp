#include "snug/cup/potential_law.hpp"

#include <gtest/gtest.h>

#include "snug/core/rng.hpp"
#include "snug/cup/law.hpp"
#include "snug/cup/statics.hpp"
#include "snug/cup/suction_cup.hpp"
#include "snug/cup/test/vectors.hpp"
#include "snug/model/test/compressible_cup.hpp"

namespace snug::cup {
namespace {

Pose moved_by(const Pose& H, const Vector6& nu) { return {H.R * exp_rotation(nu.tail<3>()), H.p + H.R * nu.head<3>()}; }

TEST(CupPotential, WrenchIsMinusTheGradientOfTheEnergyAndTheTangentItsDerivative) {
  Rng rng(7);
  const model::CupLaw law = model::test::compressible_cup();
  const double h = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Pose H = test::random_pose(rng, 0.5, 0.02);
    const LawResponse at = law_response(law, H);
    for (int j = 0; j < 6; ++j) {
      const Vector6 step = h * Vector6::Unit(j);
      const LawResponse after = law_response(law, moved_by(H, step)), before = law_response(law, moved_by(H, -step));
      EXPECT_NEAR(at.wrench[j], -(after.energy - before.energy) / (2.0 * h), 2e-6 * (1.0 + at.wrench.norm()));
      const Vector6 by_step = (after.wrench - before.wrench) / (2.0 * h);
      EXPECT_LE((by_step - at.tangent.col(j)).norm(), 1e-4 * at.tangent.norm());
    }
  }
}

TEST(CupPotential, WithConstantStiffnessIsTheLawOfFiveNumbers) {
  Rng rng(8);
  model::CupLaw law;
  law.half_range = 0.01, law.axial_1 = 60.0;
  law.lateral_0 = 2500.0, law.bend_0 = 5.0, law.torsion_0 = 3.0, law.coupling_0 = 20.0;
  const Matrix6 K = as_matrix({2500.0, 6000.0, 5.0, 3.0, 20.0});
  for (int i = 0; i < 100; ++i) {
    const Pose H = test::random_pose(rng, 0.5, 0.02);
    const LawResponse at = law_response(law, H);
    EXPECT_NEAR(at.energy, potential(H, K), 1e-12 * (1.0 + at.energy));
    EXPECT_LE((at.wrench - spring_wrench(H, K)).norm(), 1e-11 * (1.0 + at.wrench.norm()));
    EXPECT_LE((at.tangent - spring_tangent(H, K)).norm(), 1e-11 * at.tangent.norm());
  }
}

TEST(CupPotential, TermsTimesCoefficientsAreTheResponse) {
  Rng rng(9);
  const model::CupLaw law = model::test::compressible_cup();
  Eigen::Matrix<double, kLawTerms, 1> coefficients;
  coefficients << 0.0, law.axial_1, law.axial_2, law.axial_3, law.axial_4, law.axial_5, law.lateral_0, law.lateral_1,
      law.lateral_2, law.bend_0, law.bend_1, law.bend_2, law.coupling_0, law.coupling_1, law.coupling_2, law.torsion_0,
      law.torsion_1;
  const LawTerms rest = law_terms(Vector6::Zero(), law.middle, law.half_range);
  coefficients[0] = -rest.gradient.row(2).dot(coefficients);
  for (int i = 0; i < 100; ++i) {
    const Pose H = test::random_pose(rng, 0.5, 0.02);
    const LawTerms terms = law_terms(0.5 * deformation(H), law.middle, law.half_range);
    const LawResponse at = law_response(law, H);
    EXPECT_NEAR((terms.energy - rest.energy).dot(coefficients), at.energy, 1e-12 * (1.0 + std::abs(at.energy)));
  }
}

TEST(CupPotential, LooksTheSameFromAllSides) {
  Rng rng(10);
  const model::CupLaw law = model::test::compressible_cup();
  for (int i = 0; i < 50; ++i) {
    const Pose H = test::random_pose(rng, 0.5, 0.02),
               turn{exp_rotation(Vector3(0.0, 0.0, rng.uniform(-3.0, 3.0))), Vector3::Zero()};
    EXPECT_NEAR(law_response(law, turn * H * turn.inverse()).energy, law_response(law, H).energy, 1e-12);
  }
}

TEST(CupPotential, ACupOfALawPushesByIt) {
  model::CupParams params;
  params.law = model::test::compressible_cup();
  physics::ElementQuery query;
  query.X_WB.p.z() = params.hold_length + 0.004;  // the face, drawn away by 4 mm
  const physics::ElementResponse pulled = SuctionCup(params, Pose{}).evaluate(query);
  EXPECT_NEAR(pulled.wrench[2], -params.law.axial(0.004).slope, 1e-12);
  EXPECT_NEAR(pulled.energy, params.law.axial(0.004).value, 1e-15);
}

HeldLoad load_under(const model::CupLaw& law) {
  HeldLoad load;
  load.mass = 1.2;
  load.p_SScm = Vector3(0.01, -0.02, 0.05);
  load.R_WE = exp_rotation(Vector3(3.0, 0.2, -0.1));
  load.stiffness = as_matrix(model::undeformed_stiffness(law));
  load.law = law;
  load.X_ES2.p = Vector3(0.0, 0.0, 0.025);
  load.X_SS1.p = Vector3(0.0, 0.0, -0.025);
  return load;
}

TEST(CupPotential, ALoadRestsWhereItsWrenchBalancesGravity) {
  const HeldLoad load = load_under(model::test::compressible_cup());
  const SettleResult result = settle(load);
  ASSERT_EQ(result.status, SettleStatus::Converged);
  EXPECT_TRUE(result.is_stable);
  const Pose H = load.X_ES2.inverse() * result.X_ES * load.X_SS1;
  const Vector3 weight = load.mass * ((load.R_WE * load.X_ES2.R * H.R).transpose() * load.gravity_W);
  const Vector3 arm = load.X_SS1.inverse() * load.p_SScm;
  const Vector6 wrench = law_response(load.law, H).wrench;
  EXPECT_LE((wrench.head<3>() + weight).norm(), 1e-9);
  EXPECT_LE((wrench.tail<3>() + arm.cross(weight)).norm(), 1e-10);
}

TEST(CupPotential, ALoadUnderConstantStiffnessRestsAsUnderFiveNumbers) {
  model::CupLaw law;
  law.half_range = 0.01, law.axial_1 = 60.0;
  law.lateral_0 = 2500.0, law.bend_0 = 5.0, law.torsion_0 = 3.0, law.coupling_0 = 20.0;
  const HeldLoad load = load_under(law);
  HeldLoad plain = load;
  plain.law = {};
  EXPECT_LE((settle(load).X_ES.p - settle(plain).X_ES.p).norm(), 1e-11);
  EXPECT_LE(angle_between(settle(load).X_ES.R, settle(plain).X_ES.R), 1e-9);
}

}  // namespace
}  // namespace snug::cup
