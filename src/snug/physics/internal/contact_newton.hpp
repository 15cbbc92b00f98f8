// Contact Newton: solves the contacts of islands on which Gauss-Seidel converges slowly. docs/theory/contact.md,
// section 4.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "snug/physics/internal/block_solver.hpp"
#include "snug/physics/internal/contact_row.hpp"
#include "snug/physics/internal/row_clusters.hpp"

namespace snug::physics::internal {

/// Natural-map residuals, m/s.
struct Residuals {
  double wanted = 0.0;    ///< worked for while that is cheap: what keeps islands at rest quiet
  double accepted = 0.0;  ///< at which the island counts as solved
};

enum class ContactStatus : char { Unknown, Open, Sticks, Slides };

/// What Newton's method keeps of one contact.
struct NewtonRow {
  AugmentedLaw law;
  double center[3];  ///< N s, about which the augmented law is taken
  double best[3];    ///< N s, with the least residual so far
  double penalty;    ///< of the generalized step, in units of 1 / W
  double residual;   ///< m/s, as measured last
  ContactStatus status;
};

/// Rows behind each other with the same bodies, and where these stand in the linear system.
struct NewtonPatch {
  int first = 0, count = 0;
  int connection = -1;  ///< of the two bodies, or -1 when only one moves
  PanelBlock aa, bb, ab, ba;
};

struct ClusterScratch;

struct NewtonScratch {
  /// `levels`: how often parts of an island are looked at in parts again.
  NewtonScratch(std::size_t bodies, std::size_t rows, int levels = 2);
  ~NewtonScratch();
  NewtonScratch(NewtonScratch&&) noexcept;

  std::vector<int> active;                              ///< the island's bodies, by active index
  std::vector<int> local;                               ///< of each active body: its place in `active`, or -1
  std::vector<double> u, u_free, u_start, error, step;  ///< 6 per active body
  std::vector<double> right;                            ///< 6 per body of the island
  BlockSolver solver;
  std::unique_ptr<NewtonRow[]> rows;
  std::vector<NewtonPatch> patches;
  std::unique_ptr<ClusterScratch> clusters;
};

struct ClusterScratch {
  RowClusters rows;
  NewtonScratch newton;
};

/// Improves lambda of the rows and u (consistent with each other) until the residual is accepted, or keeps the best.
/// Returns the number of Newton steps.
int newton_rows(const Residuals& residuals, Row* first, Row* end, double* u, NewtonScratch& work) noexcept;

}  // namespace snug::physics::internal
