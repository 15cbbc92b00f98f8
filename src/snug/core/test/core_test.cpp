// Tests of the core module: error texts, near names, random numbers, hashing.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "snug/core/hash.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"

namespace snug {
namespace {

TEST(InputError, SaysWhereWhatAndWhatWasExpected) {
  const InputError error("cell.yaml:12", "boxes.mass", "-1", "a number > 0 in kg");
  EXPECT_STREQ(error.what(), "cell.yaml:12: boxes.mass: got -1; expected a number > 0 in kg");
}

TEST(FindNearest, ReturnsTheNearestNameAndNothingWhenAllAreFar) {
  const std::array<std::string, 3> names{"friction", "restitution", "stiffness"};
  EXPECT_EQ(find_nearest("fricton", names), "friction");
  EXPECT_EQ(find_nearest("stifness", names), "stiffness");
  EXPECT_EQ(find_nearest("colour", names), "");
}

TEST(Rng, SplitPartsDoNotDisturbEachOther) {
  Rng a(7);
  Rng b(7);
  Rng part = a.split("packing");
  (void)part.next();
  EXPECT_EQ(a.next(), b.next());
  EXPECT_NE(Rng(7).split("x").next(), Rng(7).split("y").next());
}

TEST(Rng, MomentsMatchTheUniformAndNormalDistributions) {
  Rng rng(1);
  double sum = 0, sum_normal = 0, sum_square = 0;
  const int n = 100000;
  for (int i = 0; i < n; ++i) {
    sum += rng.uniform();
    const double z = rng.normal();
    sum_normal += z;
    sum_square += z * z;
  }
  // Four standard deviations of each mean.
  EXPECT_NEAR(sum / n, 0.5, 4 * 0.2887 / std::sqrt(n));
  EXPECT_NEAR(sum_normal / n, 0.0, 4 / std::sqrt(n));
  EXPECT_NEAR(sum_square / n, 1.0, 4 * std::sqrt(2.0) / std::sqrt(n));
}

TEST(Hash, DependsOnEveryByteAndOnTheOrder) {
  Hash a, b;
  a.add(1.0), a.add(2.0);
  b.add(2.0), b.add(1.0);
  EXPECT_NE(a.value(), b.value());
}

}  // namespace
}  // namespace snug
