// collide never allocates: global new is counted.
#include <gtest/gtest.h>

#include "random_pair.hpp"
#include "snug/core/test/allocation_count.hpp"
#include "snug/geometry/bounds.hpp"

namespace snug::geometry {
namespace {

TEST(Collide, NeverAllocates) {
  Rng rng(1);
  const test::PairMaker maker(1, 50);
  for (int i = 0; i < 4000; ++i) {
    const auto pair = maker.make(static_cast<test::Family>(i % test::kFamilies), rng);
    PairCache cache;
    Manifold m;
    const long before = snug::test::allocation_count();
    collide(pair.A, pair.X_WA, pair.B, pair.X_WB, pair.margin, cache, m);
    static_cast<void>(bounds(pair.A, pair.X_WA));
    ASSERT_EQ(snug::test::allocation_count(), before) << i;
  }
}

}  // namespace
}  // namespace snug::geometry
