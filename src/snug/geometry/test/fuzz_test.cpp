// Two hundred thousand random pairs against the reference; the slow test does a million.
#include <gtest/gtest.h>

#include "fuzz.hpp"

namespace snug::geometry {
namespace {

TEST(Collide, AgreesWithTheReferenceOnTwoHundredThousandAdversarialPairs) {
  const test::FuzzResult result = test::run_fuzz(20240, 200'000);
  EXPECT_EQ(result.failure_count, 0) << test::to_text(result);
  for (const test::Worst& worst : result.worst) EXPECT_GT(worst.contacts, 2000);
}

}  // namespace
}  // namespace snug::geometry
