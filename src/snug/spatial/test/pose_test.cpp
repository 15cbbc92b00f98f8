// Tests of Pose and of the rotation exponential and logarithm.
#include "snug/spatial/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/core/rng.hpp"

namespace snug {
namespace {

Vector3 random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

TEST(Pose, ComposedWithItsInverseIsIdentity) {
  Rng rng = Rng(7).split("pose inverse");
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const Pose X_AB{exp_rotation(random_vector(rng, 4.0)), random_vector(rng, 2.0)};
    const Pose X_AA = X_AB * X_AB.inverse();
    // A few roundings of numbers of size 2.
    EXPECT_LT(X_AA.p.norm(), 1e-14);
    EXPECT_LT((X_AA.R - Matrix3::Identity()).norm(), 1e-14);
  }
}

TEST(Rotation, LogarithmInvertsTheExponentialFromTinyToAlmostPi) {
  Rng rng = Rng(7).split("log");
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    const Vector3 axis = random_vector(rng, 1.0).normalized();
    const double angle = i % 2 ? rng.uniform(0.0, std::numbers::pi - 1e-6) : std::pow(10.0, rng.uniform(-12.0, 0.0));
    const Vector3 w = angle * axis;
    EXPECT_LT((log_rotation(exp_rotation(w)) - w).norm(), 1e-9 * (1.0 + angle));
  }
}

TEST(Rotation, ByPiKeepsItsAxisUpToSign) {
  const Vector3 axis = Vector3(1.0, -2.0, 0.5).normalized();
  const Vector3 w = log_rotation(exp_rotation(std::numbers::pi * axis));
  EXPECT_NEAR(w.norm(), std::numbers::pi, 1e-12);
  EXPECT_NEAR(std::abs(w.normalized().dot(axis)), 1.0, 1e-12);
}

TEST(Rotation, AngleBetweenIsAccurateForTinyAngles) {
  const Matrix3 R = exp_rotation(Vector3(0.3, 0.2, -0.4));
  EXPECT_NEAR(angle_between(R, R * exp_rotation(Vector3(1e-9, 0.0, 0.0))), 1e-9, 1e-15);
}

}  // namespace
}  // namespace snug
