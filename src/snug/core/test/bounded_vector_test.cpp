// Tests of BoundedVector: what it makes and when, and what a smaller size leaves.
#include "snug/core/bounded_vector.hpp"

#include <gtest/gtest.h>

#include <cstdint>

namespace snug {
namespace {

struct Counted {
  static inline int made = 0;
  int value = 7;
  Counted() { ++made; }
};

TEST(BoundedVector, MakesValuesOnlyAsFarAsTheyAreReached) {
  Counted::made = 0;
  BoundedVector<Counted> values(std::size_t{1} << 30U);  // 4 GB, were they made
  EXPECT_EQ(Counted::made, 0);
  values.resize(3);
  EXPECT_EQ(Counted::made, 3);
  values.push_back(values[0]);
  EXPECT_EQ(values.size(), 4U);
  EXPECT_EQ(Counted::made, 4);
  values.room(2)[1].value = 9;
  EXPECT_EQ(values.size(), 4U);
  EXPECT_EQ(Counted::made, 6);
  values.resize(6);
  EXPECT_EQ(values[5].value, 9);
  EXPECT_EQ(values[4].value, 7);
}

TEST(BoundedVector, KeepsWhatItHeldWhereTheSizeShrinksAndGrows) {
  BoundedVector<int> values(8);
  for (int i = 0; i < 5; ++i) values.push_back(i);
  values.clear();
  EXPECT_TRUE(values.empty());
  values.resize(3);
  EXPECT_EQ(values[2], 2);
  const BoundedVector<int> copy = values;
  EXPECT_TRUE(copy == values);
  EXPECT_EQ(copy.capacity(), 8U);
  BoundedVector<int> other(8);
  other.push_back(5);
  other = copy;
  EXPECT_TRUE(other == copy);
}

TEST(BoundedVector, StandsWhereItsValuesMay) {
  struct alignas(128) Wide {
    double value = 0.0;
  };
  BoundedVector<Wide> values(3);
  values.resize(2);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(&values[1]) % 128, 0U);
}

}  // namespace
}  // namespace snug
