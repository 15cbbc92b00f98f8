// A million random pairs, of other seeds than those of the quick test, against the reference;
// SNUG_ADVERSARIAL_PAIRS=10000000 takes minutes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "fuzz.hpp"

namespace snug::geometry {
namespace {

TEST(Collide, AgreesWithTheReferenceOnAMillionAdversarialPairs) {
  const char* asked = std::getenv("SNUG_ADVERSARIAL_PAIRS");
  const test::FuzzResult result = test::run_fuzz(1'000'000'000, asked != nullptr ? std::atoll(asked) : 1'000'000);
  std::cout << test::to_text(result);
  EXPECT_EQ(result.failure_count, 0);
  for (const test::Worst& worst : result.worst) EXPECT_GT(worst.contacts, 10'000);
}

}  // namespace
}  // namespace snug::geometry
