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

}  // namespace snug::physics::internal
