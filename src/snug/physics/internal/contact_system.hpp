// ContactSystem: the linear system of one step of Newton's method, from the laws of the contacts of a group of bodies.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "snug/physics/internal/block_solver.hpp"
#include "snug/physics/internal/contact_law.hpp"

namespace snug::physics::internal {

/// What Newton's method keeps of one contact.
struct NewtonRow {
  double best[3];   ///< N s, with the least residual so far
  double penalty;   ///< of the generalized step, in units of 1 / W
  double residual;  ///< m/s, as measured last
  ContactStatus status;
};

/// What its steps take the law of one contact for.
struct NewtonLaw {
  LinearLaw law;
  double center[3];  ///< N s, about which the augmented law is taken
};

/// Rows behind each other with the same bodies, and where these stand in the linear system.
struct RowPatch {
  int first = 0, count = 0;
  int ia = -1, ib = -1;
  int connection = -1;  ///< of the two bodies, or -1 when only one moves
  PairBlocks blocks;
};

/// I + sum (J T)^T S (J T) in blocks of the bodies, S the slopes of the laws, factorised. Never allocates after
/// construction.
class ContactSystem {
 public:
  ContactSystem(std::size_t bodies, std::size_t rows, std::shared_ptr<FactorStore> store);

  void begin();
  /// Rows come in the order of their indices, from 0. They may come after steps, too. Returns whether one of its bodies
  /// is new to the group: what bodies() has more at its end.
  void add_row(const Row& row);
  /// Active bodies of the rows, in the order of their first.
  [[nodiscard]] std::span<const int> bodies() const { return bodies_; }
  [[nodiscard]] std::span<const RowPatch> patches() const { return patches_; }

  /// False: it fills beyond memory.
  [[nodiscard]] bool factorize(const Row* rows, const NewtonLaw* laws);
  /// x = A^-1 y, 6 numbers for each active body.
  void solve(const double* y, double* x);

 private:
  void add_body(int body);
  [[nodiscard]] bool analyze();
  void add_patch(const RowPatch& patch, const Row* rows, const NewtonLaw* laws);

  std::vector<int> bodies_;
  std::vector<int> place_;  ///< of each active body, in bodies_; -1: not of the group
  std::vector<RowPatch> patches_;
  int row_count_ = 0;
  bool is_analyzed_ = false;
  BlockSolver solver_;
  std::vector<double> right_;  ///< 6 per body of the group
};

}  // namespace snug::physics::internal
