// Contact Newton: finishes the islands on which Gauss-Seidel converges slowly.
#pragma once

#include <cstddef>
#include <vector>

#include "snug/physics/internal/contact_row.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::physics::internal {

/// What Newton's method keeps of one contact: impulses in the row's frame, N s.
struct NewtonRow {
  double center[3];  ///< about which the augmented law is taken
  double lambda[3];  ///< of the augmented law
  double best[3];    ///< with the least residual so far
  double slope[9];   ///< -d lambda / d relative velocity, row-major
};

struct NewtonScratch {
  static constexpr int kMaxBodies = 32;  ///< of an island; larger ones are left to Gauss-Seidel
  static constexpr int kMaxRows = 512;

  explicit NewtonScratch(std::size_t bodies);

  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(i) * active.size() + static_cast<std::size_t>(j);
  }
  [[nodiscard]] bool has_block(int i, int j) const { return is_filled[index(i, j)] != 0; }
  [[nodiscard]] Matrix6& block(int i, int j) { return blocks[index(i, j)]; }
  /// The block, zero when it is new.
  [[nodiscard]] Matrix6& open_block(int i, int j) {
    if (!has_block(i, j)) {
      is_filled[index(i, j)] = 1;
      block(i, j).setZero();
    }
    return block(i, j);
  }

  std::vector<int> active;                              ///< the island's bodies, by active index
  std::vector<int> local;                               ///< of each active body: its place in `active`, or -1
  std::vector<double> u, u_free, u_start, error, step;  ///< 6 per active body
  std::vector<Matrix6> blocks;
  std::vector<char> is_filled;
  std::vector<NewtonRow> rows;
};

/// Improves lambda of the rows and u (consistent with each other) by the augmented Lagrangian of the Alart-Curnier law,
/// each stage solved by Newton's method; keeps the best. Returns the number of Newton steps, 0 for too large an island.
int newton_rows(double tolerance, Row* first, Row* end, double* u, NewtonScratch& work) noexcept;

}  // namespace snug::physics::internal
