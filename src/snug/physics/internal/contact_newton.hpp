// Contact Newton: solves the contacts of islands on which Gauss-Seidel converges slowly.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "snug/physics/internal/block_solver.hpp"
#include "snug/physics/internal/contact_row.hpp"

namespace snug::physics::internal {

/// What Newton's method keeps of one contact: impulses in the row's frame, N s.
struct NewtonRow {
  double center[3];  ///< about which the augmented law is taken
  double lambda[3];  ///< of the augmented law
  double best[3];    ///< with the least residual so far
  double slope[9];   ///< -d lambda / d relative velocity, row-major
  int connection;    ///< of its two bodies in the linear system, or -1
};

struct NewtonScratch {
  NewtonScratch(std::size_t bodies, std::size_t rows);

  std::vector<int> active;                              ///< the island's bodies, by active index
  std::vector<int> local;                               ///< of each active body: its place in `active`, or -1
  std::vector<double> u, u_free, u_start, error, step;  ///< 6 per active body
  BlockSolver solver;
  std::unique_ptr<NewtonRow[]> rows;
};

/// Improves lambda of the rows and u (consistent with each other) by the augmented Lagrangian of the Alart-Curnier law,
/// each stage solved by Newton's method; keeps the best. Returns the number of Newton steps.
int newton_rows(double tolerance, Row* first, Row* end, double* u, NewtonScratch& work) noexcept;

}  // namespace snug::physics::internal
