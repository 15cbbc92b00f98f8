// Panel kernels: products of the dense panels that a sparse factorisation consists of.
#pragma once

#include <cstddef>

namespace snug::physics::internal {

/// A product A B^T with six columns. Columns of A and C lie behind each other at `stride_a` and `stride_c`, entry (j,
/// k) of B at b[j * row_b + k * column_b]. `rows` is even.
struct PanelProduct {
  int rows, depth;
  const double* a;
  std::ptrdiff_t stride_a;
  const double* b;
  std::ptrdiff_t row_b, column_b;
  double* c;
  std::ptrdiff_t stride_c;
};

/// C = A B^T. Each entry is summed in the order of k, each product and each sum rounded: the bytes do not depend on the
/// vectors that the processor has.
void set_product(const PanelProduct& p) noexcept;
/// C -= A B^T, likewise; C must not overlap A or B.
void subtract_product(const PanelProduct& p) noexcept;

/// A 6 x 6 block within a panel, stored by columns, or its transpose so.
struct PanelBlock {
  double* data = nullptr;
  std::ptrdiff_t stride = 6;
  bool is_transposed = false;
};

/// One contact of two bodies: its rows J (3 x 12, those of A first) and the slope S of its law (3 x 3), both by rows.
struct ContactTerm {
  const double* j;
  const double* slope;
};
constexpr int kMaxContactTerms = 8;

/// The blocks to which the contacts of two bodies A and B add.
struct PairBlocks {
  PanelBlock aa, ab, ba, bb;
};
/// Adds sum J^T (S J) to the blocks. The order of sums does not depend on the processor. At most kMaxContactTerms.
void add_contact_terms(const ContactTerm* terms, int count, const PairBlocks& blocks) noexcept;
/// The same where only one of the bodies moves: `j` of the terms are its six columns of each row.
void add_contact_terms(const ContactTerm* terms, int count, const PanelBlock& block) noexcept;

}  // namespace snug::physics::internal
