// collide never allocates: global new is counted.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "random_pair.hpp"
#include "snug/geometry/bounds.hpp"

namespace {

std::atomic<long long> allocations{0};

void* counted(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace snug::geometry {
namespace {

TEST(Collide, NeverAllocates) {
  Rng rng(1);
  const test::PairMaker maker(1, 50);
  for (int i = 0; i < 4000; ++i) {
    const auto pair = maker.make(static_cast<test::Family>(i % test::kFamilies), rng);
    PairCache cache;
    Manifold m;
    const long long before = allocations;
    collide(pair.A, pair.X_WA, pair.B, pair.X_WB, pair.margin, cache, m);
    static_cast<void>(bounds(pair.A, pair.X_WA));
    ASSERT_EQ(allocations, before) << i;
  }
}

}  // namespace
}  // namespace snug::geometry
