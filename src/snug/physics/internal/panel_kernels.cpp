// Panel kernels: products of dense panels with the widest vectors of the processor at hand.
#include "snug/physics/internal/panel_kernels.hpp"

#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__)
#define SNUG_HAS_WIDE_VECTORS 1
#else
#define SNUG_HAS_WIDE_VECTORS 0
#endif

namespace snug::physics::internal {
namespace {

typedef double Vector2 __attribute__((vector_size(16)));
typedef double Vector4 __attribute__((vector_size(32)));
typedef double Vector8 __attribute__((vector_size(64)));

constexpr int kColumns = 6;

/// Rows [row, row + kCount * lanes of V) of the product.
template <class V, int kCount, bool kSubtract>
[[gnu::always_inline]] inline void multiply_strip(const PanelProduct& p, int row) {
  constexpr int kLanes = sizeof(V) / sizeof(double);
  V sum[kCount][kColumns] = {};
  const double* a = p.a + row;
  const double* b = p.b;
  for (int k = 0; k < p.depth; ++k, a += p.stride_a, b += p.column_b) {
    V left[kCount];
    for (int i = 0; i < kCount; ++i) std::memcpy(&left[i], a + kLanes * i, sizeof(V));
    for (int j = 0; j < kColumns; ++j) {
      const double right = b[j * p.row_b];
      for (int i = 0; i < kCount; ++i) sum[i][j] += left[i] * right;
    }
  }
  for (int j = 0; j < kColumns; ++j) {
    for (int i = 0; i < kCount; ++i) {
      double* c = p.c + row + kLanes * i + j * p.stride_c;
      V value = sum[i][j];
      if constexpr (kSubtract) {
        V before;
        std::memcpy(&before, c, sizeof(V));
        value = before - value;
      }
      std::memcpy(c, &value, sizeof(V));
    }
  }
}

template <bool kSubtract>
[[gnu::always_inline]] inline void multiply_narrow(const PanelProduct& p, int row) {
  for (; row + 4 <= p.rows; row += 4) multiply_strip<Vector2, 2, kSubtract>(p, row);
  if (row < p.rows) multiply_strip<Vector2, 1, kSubtract>(p, row);
}

using Kernel = void (*)(const PanelProduct&);

template <bool kSubtract>
void multiply_by_two(const PanelProduct& p) {
  multiply_narrow<kSubtract>(p, 0);
}

#if SNUG_HAS_WIDE_VECTORS
template <bool kSubtract>
__attribute__((target("avx2"))) void multiply_by_four(const PanelProduct& p) {
  int row = 0;
  for (; row + 8 <= p.rows; row += 8) multiply_strip<Vector4, 2, kSubtract>(p, row);
  if (row + 4 <= p.rows) multiply_strip<Vector4, 1, kSubtract>(p, row), row += 4;
  multiply_narrow<kSubtract>(p, row);
}

template <bool kSubtract>
__attribute__((target("avx512f"))) void multiply_by_eight(const PanelProduct& p) {
  int row = 0;
  for (; row + 16 <= p.rows; row += 16) multiply_strip<Vector8, 2, kSubtract>(p, row);
  if (row + 8 <= p.rows) multiply_strip<Vector8, 1, kSubtract>(p, row), row += 8;
  if (row + 4 <= p.rows) multiply_strip<Vector4, 1, kSubtract>(p, row), row += 4;
  multiply_narrow<kSubtract>(p, row);
}
#endif

template <bool kSubtract>
Kernel choose() {
#if SNUG_HAS_WIDE_VECTORS
  if (__builtin_cpu_supports("avx512f")) return multiply_by_eight<kSubtract>;
  if (__builtin_cpu_supports("avx2")) return multiply_by_four<kSubtract>;
#endif
  return multiply_by_two<kSubtract>;
}

}  // namespace

void set_product(const PanelProduct& p) noexcept {
  static const Kernel kernel = choose<false>();
  kernel(p);
}

void subtract_product(const PanelProduct& p) noexcept {
  static const Kernel kernel = choose<true>();
  kernel(p);
}

}  // namespace snug::physics::internal
