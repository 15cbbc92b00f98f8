// Lemke: the packaged pivoting solver of linear complementarity problems, behind a call without its types.
#pragma once

#include <memory>

namespace snug::numerics::internal {

/// Finds z >= 0 with w = M z + q >= 0 and z.w = 0 for a symmetric positive semidefinite M by Lemke's method with
/// lexicographic pivots (Siconos). The solver takes its memory from the heap in every call that has to pivot.
class Lemke {
 public:
  Lemke();
  ~Lemke();
  Lemke(Lemke&&) noexcept;
  Lemke& operator=(Lemke&&) noexcept;

  /// M: size x size, column by column; overwritten. Returns whether it ended at a solution; `z` and `w` must be
  /// checked all the same.
  [[nodiscard]] bool solve(int size, double* M, double* q, double* z, double* w);

 private:
  struct Options;
  std::unique_ptr<Options> options_;
};

}  // namespace snug::numerics::internal
