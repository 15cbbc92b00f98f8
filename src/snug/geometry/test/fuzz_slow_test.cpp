// Ten million random pairs against the reference.
#include <gtest/gtest.h>

#include <iostream>

#include "fuzz.hpp"

namespace snug::geometry {
namespace {

TEST(Collide, AgreesWithTheReferenceOnTenMillionAdversarialPairs) {
  const test::FuzzResult result = test::run_fuzz(1'000'000'000, 10'000'000);
  std::cout << test::to_text(result);
  EXPECT_EQ(result.failure_count, 0);
}

}  // namespace
}  // namespace snug::geometry
