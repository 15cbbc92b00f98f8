// BlockSolver: direct solution of sparse linear systems in 6 x 6 blocks of bodies.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "snug/physics/internal/block_pattern.hpp"
#include "snug/physics/internal/panel_kernels.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::physics::internal {

/// Memory for numbers that is reserved at once and becomes real only where it is written to.
class LazyStore {
 public:
  explicit LazyStore(std::size_t count);
  [[nodiscard]] double* get() { return data_.get(); }

 private:
  struct Free {
    void operator()(double* data) const;
  };
  std::unique_ptr<double, Free> data_;
};

/// What factorisations work in. Solvers that share one take turns: from set_identity() to the last solve() of a matrix
/// it belongs to one of them.
struct FactorStore {
  explicit FactorStore(std::size_t bodies);

  LazyStore lower, upper;  ///< panels
  std::vector<int> place;  ///< of each rank in the panel at hand
  LazyStore product;       ///< six columns of a panel
  LazyStore x;             ///< by rank
  LazyStore gathered;
};

/// LU factorisation of matrices I + sum J^T S J, whose pattern is symmetric and whose blocks on the diagonal stay
/// regular without pivoting. Fronts of bodies (BlockPattern) have dense panels; each takes over what earlier ones
/// change in it, in their order, so that fill, work and the bytes of the result depend on the pattern alone. Never
/// allocates after construction.
///
/// For a pattern: begin(n), connect(i, j) for pairs of bodies that share contacts, analyze(). For a matrix:
/// set_identity(), add to diagonal() and coupling(), factorize(), solve().
class BlockSolver {
 public:
  /// For up to `bodies` bodies and `connections` calls of connect().
  BlockSolver(std::size_t bodies, std::size_t connections, std::shared_ptr<FactorStore> store);

  void begin(int count) { pattern_.begin(count); }
  /// Returns the number of this call, for coupling(). Pairs i != j may repeat.
  int connect(int i, int j) { return pattern_.connect(i, j); }
  /// Order and fill. False when the fill does not fit into the memory reserved (64 blocks a body).
  [[nodiscard]] bool analyze() { return pattern_.analyze(); }

  void set_identity();
  [[nodiscard]] PanelBlock diagonal(int i);
  struct Coupling {
    PanelBlock ij;  ///< row i, column j of connect(i, j)
    PanelBlock ji;
  };
  [[nodiscard]] Coupling coupling(int connection);

  /// Overwrites the matrix by its factors.
  void factorize();
  /// A^-1 x in place, 6 entries a body.
  void solve(double* x);

  [[nodiscard]] int count() const { return pattern_.count(); }
  [[nodiscard]] const BlockPattern& pattern() const { return pattern_; }

 private:
  using Front = BlockPattern::Front;

  /// Panel of a front: its own bodies and below them its rows, 6 numbers each. Below the diagonal, L with unit
  /// diagonal; on it, the inverse of U's; above it, within the front, U.
  [[nodiscard]] double* lower(const Front& front) { return store_->lower.get() + 36 * front.panel; }
  [[nodiscard]] std::ptrdiff_t lower_stride(const Front& front) const { return 6 * front.height(); }
  /// U beside the front's own bodies, transposed: its rows, 6 numbers each, for each of its bodies.
  [[nodiscard]] double* upper(const Front& front) { return store_->upper.get() + 36 * front.panel; }
  [[nodiscard]] std::ptrdiff_t upper_stride(const Front& front) const { return 6 * front.rows(); }

  void place_rows(const Front& front);
  void take_update(const Front& front, const BlockPattern::Update& update);
  void eliminate(const Front& front);

  BlockPattern pattern_;
  std::shared_ptr<FactorStore> store_;
};

}  // namespace snug::physics::internal
