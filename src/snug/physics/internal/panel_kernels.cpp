// Panel kernels: products of dense panels with the widest vectors of the processor at hand.
#include "snug/physics/internal/panel_kernels.hpp"

#include <cstring>

#include "snug/core/wide_vectors.hpp"

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

/// J of each contact and S J, 3 rows of 12 numbers.
struct ScaledTerms {
  const double* j[kMaxContactTerms];
  /// What lies behind is read with the last row and does not count.
  alignas(64) double forces[kMaxContactTerms * 36 + 8];
  int count;
};

/// Columns [0, kWidth).
template <class V, int kWidth>
[[gnu::always_inline]] inline void scale_terms(const ContactTerm* terms, int count, ScaledTerms& scaled) {
  constexpr int kLanes = sizeof(V) / sizeof(double);
  scaled.count = count;
  for (int t = 0; t < count; ++t) {
    const double* s = terms[t].slope;
    double* to = scaled.forces + 36 * t;
    scaled.j[t] = terms[t].j;
    for (int column = 0; column < kWidth; column += kLanes, to += kLanes) {
      V row[3];
      for (int k = 0; k < 3; ++k) std::memcpy(&row[k], terms[t].j + 12 * k + column, sizeof(V));
      for (int i = 0; i < 3; ++i) {
        const V force = row[0] * s[3 * i] + row[1] * s[3 * i + 1] + row[2] * s[3 * i + 2];
        std::memcpy(to + 12 * i, &force, sizeof(V));
      }
    }
  }
  std::memset(scaled.forces + 36 * count, 0, 8 * sizeof(double));
}

/// Column of a block: six rows, in one vector of eight, one of four and one of two, or three of two.
struct ByEight {
  Vector8 part;
  [[gnu::always_inline]] void set(const double* from) { std::memcpy(&part, from, sizeof(part)); }
  [[gnu::always_inline]] void add(const ByEight& left, double right) { part += left.part * right; }
  [[gnu::always_inline]] void add_to(double* to) const {
    Vector4 low;
    Vector2 high;
    std::memcpy(&low, to, sizeof(low));
    std::memcpy(&high, to + 4, sizeof(high));
    low += Vector4{part[0], part[1], part[2], part[3]};
    high += Vector2{part[4], part[5]};
    std::memcpy(to, &low, sizeof(low));
    std::memcpy(to + 4, &high, sizeof(high));
  }
};
struct ByFour {
  Vector4 low;
  Vector2 high;
  [[gnu::always_inline]] void set(const double* from) {
    std::memcpy(&low, from, sizeof(low));
    std::memcpy(&high, from + 4, sizeof(high));
  }
  [[gnu::always_inline]] void add(const ByFour& left, double right) {
    low += left.low * right;
    high += left.high * right;
  }
  [[gnu::always_inline]] void add_to(double* to) const {
    ByFour sum;
    sum.set(to);
    sum.low += low, sum.high += high;
    std::memcpy(to, &sum.low, sizeof(low));
    std::memcpy(to + 4, &sum.high, sizeof(high));
  }
};
struct ByTwo {
  Vector2 part[3];
  [[gnu::always_inline]] void set(const double* from) { std::memcpy(part, from, sizeof(part)); }
  [[gnu::always_inline]] void add(const ByTwo& left, double right) {
    for (int i = 0; i < 3; ++i) part[i] += left.part[i] * right;
  }
  [[gnu::always_inline]] void add_to(double* to) const {
    ByTwo sum;
    sum.set(to);
    for (int i = 0; i < 3; ++i) sum.part[i] += part[i];
    std::memcpy(to, sum.part, sizeof(part));
  }
};

/// Adds the block of rows from `row` and columns from `column` on of sum J^T (S J); a transposed one by its rows.
template <class Column, int kColumns>
[[gnu::always_inline]] inline void add_product(const ScaledTerms& terms, int row, int column, const PanelBlock& M) {
  for (int c = 0; c < 6; c += kColumns) {
    Column sum[kColumns] = {};
    for (int t = 0; t < terms.count; ++t) {
      const double* force = terms.forces + 36 * t + column;
      const double* j = terms.j[t] + row;
      const double* left = M.is_transposed ? force : j;
      const double* right = (M.is_transposed ? j : force) + c;
      for (int k = 0; k < 3; ++k, left += 12, right += 12) {
        Column own;
        own.set(left);
        for (int i = 0; i < kColumns; ++i) sum[i].add(own, right[i]);
      }
    }
    for (int i = 0; i < kColumns; ++i) sum[i].add_to(M.data + (c + i) * M.stride);
  }
}

template <class V, class Column, int kColumns>
[[gnu::always_inline]] inline void add_pair(const ContactTerm* terms, int count, const PairBlocks& blocks) {
  ScaledTerms scaled;
  scale_terms<V, 12>(terms, count, scaled);
  add_product<Column, kColumns>(scaled, 0, 0, blocks.aa);
  add_product<Column, kColumns>(scaled, 0, 6, blocks.ab);
  add_product<Column, kColumns>(scaled, 6, 0, blocks.ba);
  add_product<Column, kColumns>(scaled, 6, 6, blocks.bb);
}

template <class Column, int kColumns>
[[gnu::always_inline]] inline void add_body(const ContactTerm* terms, int count, const PanelBlock& block) {
  ScaledTerms scaled;
  scale_terms<Vector2, 6>(terms, count, scaled);
  add_product<Column, kColumns>(scaled, 0, 0, block);
}

using PairKernel = void (*)(const ContactTerm*, int, const PairBlocks&);
using BodyKernel = void (*)(const ContactTerm*, int, const PanelBlock&);

void add_pair_by_two(const ContactTerm* terms, int count, const PairBlocks& blocks) {
  add_pair<Vector2, ByTwo, 3>(terms, count, blocks);
}
void add_body_by_two(const ContactTerm* terms, int count, const PanelBlock& block) {
  add_body<ByTwo, 3>(terms, count, block);
}
#if SNUG_HAS_WIDE_VECTORS
__attribute__((target("avx2"))) void add_pair_by_four(const ContactTerm* terms, int count, const PairBlocks& blocks) {
  add_pair<Vector4, ByFour, 6>(terms, count, blocks);
}
__attribute__((target("avx2"))) void add_body_by_four(const ContactTerm* terms, int count, const PanelBlock& block) {
  add_body<ByFour, 6>(terms, count, block);
}
__attribute__((target("avx512f"))) void add_pair_by_eight(const ContactTerm* terms, int count,
                                                          const PairBlocks& blocks) {
  add_pair<Vector4, ByEight, 6>(terms, count, blocks);
}
#endif

PairKernel choose_pair_kernel() {
#if SNUG_HAS_WIDE_VECTORS
  if (__builtin_cpu_supports("avx512f")) return add_pair_by_eight;
  if (__builtin_cpu_supports("avx2")) return add_pair_by_four;
#endif
  return add_pair_by_two;
}

BodyKernel choose_body_kernel() {
#if SNUG_HAS_WIDE_VECTORS
  if (__builtin_cpu_supports("avx2")) return add_body_by_four;
#endif
  return add_body_by_two;
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

void add_contact_terms(const ContactTerm* terms, int count, const PairBlocks& blocks) noexcept {
  static const PairKernel kernel = choose_pair_kernel();
  kernel(terms, count, blocks);
}

void add_contact_terms(const ContactTerm* terms, int count, const PanelBlock& block) noexcept {
  static const BodyKernel kernel = choose_body_kernel();
  kernel(terms, count, block);
}

}  // namespace snug::physics::internal
