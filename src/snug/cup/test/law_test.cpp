// Tests of the cup's law: reference vectors, symmetries, derivatives and closed forms.
#include "snug/cup/law.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "snug/cup/test/vectors.hpp"

namespace snug::cup {
namespace {

using test::difference;
using test::random_pose;
using test::random_stiffness;
using test::random_vector;

using std::numbers::pi;

model::CupElasticity default_cup() { return {2500.0, 6000.0, 5.0, 3.0, 0.0}; }

/// H moved along the body twist nu for a time h: right tangent at h = 0, which is all that a derivative needs.
Pose moved(const Pose& H, const Vector6& nu, double h) {
  return {H.R * exp_rotation(h * nu.tail<3>()), H.p + H.R * (h * nu.head<3>())};
}

/// [Ad_g] for twists with the linear part first.
Matrix6 adjoint(const Pose& g) {
  Matrix6 Ad;
  Ad << g.R, skew(g.p) * g.R, Matrix3::Zero(), g.R;
  return Ad;
}

TEST(CupLaw, AgreesWithTheReferenceVectors) {
  const nlohmann::json vectors = test::load_vectors("wrench.json");
  if (vectors.is_null()) GTEST_SKIP() << "reference data not found: " << test::vectors_path("wrench.json");
  ASSERT_EQ(vectors.at("cases").size(), 100u);
  test::Worst energy("energy"), wrench("wrench");
  for (const nlohmann::json& c : vectors.at("cases")) {
    SCOPED_TRACE(c.at("id").dump());
    const Pose H{test::matrix3(c.at("R")), test::vector3(c.at("o"))};
    const Matrix6 K = test::matrix6(c.at("K"));
    const Pose X_SS1{test::matrix3(c.at("S_R_S1")), test::vector3(c.at("S_o_S1"))};
    // Tolerances: those that the vectors come with. At four half turns (182 to 188) the wrench is zero but for the
    // rounding of the inputs, some 1e-15 N, and 1e-15 N is the tolerance: exact arithmetic would miss two of them.
    const double V = c.at("V").get<double>();
    EXPECT_LE(energy.add(std::abs(potential(H, K) - V) / (std::abs(V) + 1e-12)), 1e-10);
    const auto expect_wrench = [&](const char* key, const Vector6& got) {
      const Vector6 want = test::vector6(c.at(key));
      EXPECT_LE(wrench.add((got - want).norm() / (want.norm() + 1e-6)), 1e-9) << key;
    };
    const Vector6 wrench_S1 = spring_wrench(H, K);
    expect_wrench("wrench_S1", wrench_S1);
    expect_wrench("wrench_S", wrench_transform(X_SS1) * wrench_S1);
    // The cup is massless: the gripper gets the opposite wrench, here about the origin of S2.
    expect_wrench("reaction_on_gripper_S2", -(wrench_transform(H) * wrench_S1));
    EXPECT_LE((deformation(H) - test::vector6(c.at("e"))).norm(), 1e-12);
  }
}

TEST(CupLaw, IsTheSameSeenFromEitherEnd) {
  Rng rng = Rng(1).split("inverse");
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const Pose H = random_pose(rng, 1.8, 0.05);
    const Matrix6 K = random_stiffness(rng);
    // Roundings of products of size 1: 16 epsilon.
    EXPECT_LE((deformation(H.inverse()) + deformation(H)).norm(), 4e-15);
    EXPECT_NEAR(potential(H.inverse(), K), potential(H, K), 1e-12 * potential(H, K));
    const Vector6 reaction = -(wrench_transform(H) * spring_wrench(H, K));
    EXPECT_LE((spring_wrench(H.inverse(), K) - reaction).norm(), 1e-12 * reaction.norm());
  }
}

TEST(CupLaw, KeepsItsFormWhenBothEndFramesMoveTogether) {
  Rng rng = Rng(2).split("covariance");
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const Pose H = random_pose(rng, 1.8, 0.05), g = random_pose(rng, 1.8, 0.2);
    const Matrix6 K = random_stiffness(rng);
    const Pose H_g = g.inverse() * H * g;
    const Matrix6 Ad = adjoint(g);
    const Matrix6 K_g = Ad.transpose() * K * Ad;
    EXPECT_LE((deformation(H_g) - adjoint(g.inverse()) * deformation(H)).norm(), 1e-14);
    EXPECT_NEAR(potential(H_g, K_g), potential(H, K), 1e-11 * potential(H, K));
    const Vector6 want = Ad.transpose() * spring_wrench(H, K);
    EXPECT_LE((spring_wrench(H_g, K_g) - want).norm(), 1e-11 * want.norm());
  }
}

TEST(CupLaw, WithFiveNumbersDoesNotKnowDirectionsAroundTheCupNorMirrors) {
  Rng rng = Rng(3).split("symmetry");
  Matrix6 mirror = Matrix6::Identity();  // of the plane y = 0: rotations are pseudovectors
  mirror.diagonal() << 1.0, -1.0, 1.0, -1.0, 1.0, -1.0;
  const Matrix3 M = mirror.topLeftCorner<3, 3>();
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const Pose H = random_pose(rng, 1.8, 0.05);
    const Matrix6 K = as_matrix({rng.uniform(100.0, 5000.0), rng.uniform(100.0, 8000.0), rng.uniform(5.0, 10.0),
                                 rng.uniform(1.0, 6.0), rng.uniform(-20.0, 20.0)});
    const Pose g{exp_rotation(Vector3(0.0, 0.0, rng.uniform(-pi, pi))), Vector3::Zero()};
    const Pose turned = g.inverse() * H * g, mirrored{M * H.R * M, M * H.p};
    const Vector6 f = spring_wrench(H, K);
    EXPECT_NEAR(potential(turned, K), potential(H, K), 1e-12 * potential(H, K));
    EXPECT_LE((spring_wrench(turned, K) - adjoint(g).transpose() * f).norm(), 1e-12 * f.norm());
    EXPECT_NEAR(potential(mirrored, K), potential(H, K), 1e-12 * potential(H, K));
    EXPECT_LE((spring_wrench(mirrored, K) - mirror * f).norm(), 1e-12 * f.norm());
  }
}

TEST(CupLaw, SeenFromTheLipIsTheCentredCupWithACoupling) {
  // c = k_lat h and k_bend' = k_bend + k_lat h^2, with h the height of the centre of stiffness: at any deformation.
  const double h = -0.025;
  const Pose g{Matrix3::Identity(), Vector3(0.0, 0.0, -h)};  // lip in the frame of the centre
  const Matrix6 Ad = adjoint(g);
  const Matrix6 at_lip = Ad.transpose() * as_matrix(default_cup()) * Ad;
  const Matrix6 want = as_matrix({2500.0, 6000.0, 5.0 + 2500.0 * h * h, 3.0, 2500.0 * h});
  EXPECT_LE((at_lip - want).norm(), 1e-11 * want.norm());
}

TEST(CupLaw, WrenchIsTheNegativeGradientOfThePotential) {
  Rng rng = Rng(4).split("gradient");
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const Pose H = random_pose(rng, 1.8, 0.05);
    const Matrix6 K = random_stiffness(rng);
    const Vector6 f = spring_wrench(H, K);
    Vector6 gradient;
    for (int j = 0; j < 6; ++j) {
      const double h = j < 3 ? 1e-4 : 1e-3;
      gradient[j] = difference([&](double s) { return potential(moved(H, Vector6::Unit(j), s), K); }, h);
    }
    // Fourth-order differences: truncation h^4 and rounding epsilon / h are both near 1e-11 of the largest entry.
    EXPECT_LE((gradient + f).norm(), 1e-9 * (1.0 + f.norm()));
  }
}

TEST(CupLaw, TangentIsTheDerivativeOfTheWrench) {
  Rng rng = Rng(5).split("tangent");
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const Pose H = random_pose(rng, i < 10 ? 0.0 : 1.8, i < 5 ? 0.0 : 0.05);
    const Matrix6 K = random_stiffness(rng);
    const Matrix6 tangent = spring_tangent(H, K);
    for (int j = 0; j < 6; ++j) {
      const double h = j < 3 ? 1e-4 : 1e-3;
      const Vector6 column =
          difference([&](double s) -> Vector6 { return spring_wrench(moved(H, Vector6::Unit(j), s), K); }, h);
      // As above; forces and torques are compared each with their own size.
      EXPECT_LE((column - tangent.col(j)).head<3>().norm(), 1e-7 * tangent.topRows<3>().norm());
      EXPECT_LE((column - tangent.col(j)).tail<3>().norm(), 1e-7 * tangent.bottomRows<3>().norm());
    }
  }
}

TEST(CupLaw, StiffnessAtRestIsK) {
  Rng rng = Rng(6).split("rest");
  for (int i = 0; i < 20; ++i) {
    const Matrix6 K = random_stiffness(rng);
    EXPECT_LE((spring_tangent(Pose{}, K) + K).norm(), 1e-15 * K.norm());
    EXPECT_EQ(potential(Pose{}, K), 0.0);
    EXPECT_EQ(spring_wrench(Pose{}, K).norm(), 0.0);
  }
}

TEST(CupLaw, IsAPlainSpringInPureTranslation) {
  Rng rng = Rng(7).split("translation");
  for (int i = 0; i < 100; ++i) {
    const Vector3 o = random_vector(rng, 0.05);
    const Pose H{Matrix3::Identity(), o};
    const Matrix6 K = as_matrix(default_cup());
    const Vector3 force = -(Vector3(2500.0, 2500.0, 6000.0).asDiagonal() * o);
    const Vector6 f = spring_wrench(H, K);
    EXPECT_LE((f.head<3>() - force).norm(), 1e-12 * force.norm());
    // The bracket's -(R^T o)^ block: half of the deformation is the arm, o/2 x force about S1.
    EXPECT_LE((f.tail<3>() - (-0.5 * o.cross(force))).norm(), 1e-12 * force.norm());
  }
  const Vector6 axial = spring_wrench({Matrix3::Identity(), Vector3(0.0, 0.0, 0.002)}, as_matrix(default_cup()));
  EXPECT_LE((axial - Vector6::Unit(2) * -12.0).norm(), 1e-14);
}

TEST(CupLaw, SoftensAsTheSineOfTwiceTheAngleInPureRotation) {
  const Matrix6 K = as_matrix(default_cup());
  for (int deg = -180; deg <= 180; deg += 5) {
    SCOPED_TRACE(deg);
    const double theta = deg * pi / 180.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double k = axis == 2 ? 3.0 : 5.0;
      const Pose H{exp_rotation(theta * Vector3::Unit(axis)), Vector3::Zero()};
      const double s = std::sin(theta);
      EXPECT_NEAR(potential(H, K), 0.5 * k * s * s, 1e-14);
      const Vector6 want = -0.5 * k * std::sin(2.0 * theta) * Vector6::Unit(3 + axis);
      EXPECT_LE((spring_wrench(H, K) - want).norm(), 1e-14);
    }
    EXPECT_NEAR(bend_angle(exp_rotation(Vector3(theta, 0.0, 0.0))), std::abs(theta), 1e-14);
    EXPECT_NEAR(bend_angle(exp_rotation(Vector3(0.0, 0.0, theta))), 0.0, 1e-14);
  }
}

TEST(CupLaw, IsBlindToHalfTurns) {
  // The known limit of the law: no energy and no wrench at a half turn with o across its axis. Never start there.
  Rng rng = Rng(8).split("half turn");
  for (int i = 0; i < 50; ++i) {
    const Vector3 n = random_vector(rng, 1.0).normalized();
    const Vector3 o = 0.05 * n.cross(random_vector(rng, 1.0));
    const Pose H{exp_rotation(pi * n), o};
    const Matrix6 K = random_stiffness(rng);
    EXPECT_LE(potential(H, K), 1e-24 * K.norm());  // e is rounding, about 1e-16 a unit
    EXPECT_LE(spring_wrench(H, K).norm(), 1e-12 * K.norm());
  }
}

TEST(CupLaw, PassesNotANumberOnInsteadOfHidingIt) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Pose H{Matrix3::Identity(), Vector3(nan, 0.0, 0.0)};
  EXPECT_TRUE(std::isnan(potential(H, as_matrix(default_cup()))));
  EXPECT_FALSE(spring_wrench(H, as_matrix(default_cup())).allFinite());
}

}  // namespace
}  // namespace snug::cup
