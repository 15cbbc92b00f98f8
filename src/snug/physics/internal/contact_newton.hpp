// Contact Newton: solves the contacts of islands on which Gauss-Seidel converges slowly. docs/theory/contact.md,
// section 4.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "snug/physics/internal/contact_row.hpp"
#include "snug/physics/internal/contact_system.hpp"
#include "snug/physics/internal/row_clusters.hpp"
#include "snug/physics/internal/row_groups.hpp"

namespace snug::physics::internal {

/// Natural-map residuals, m/s.
struct Residuals {
  double wanted = 0.0;    ///< worked for while that is cheap: what keeps islands at rest quiet
  double accepted = 0.0;  ///< at which the island counts as solved
};

struct ClusterScratch;
class PackedSweeps;

/// What a group of rows is solved with.
struct GroupScratch {
  /// `levels`: how often parts of a group are looked at in parts again.
  GroupScratch(std::size_t bodies, std::size_t rows, int levels = 2);
  ~GroupScratch();
  GroupScratch(GroupScratch&&) noexcept;

  ContactSystem system;
  std::unique_ptr<NewtonRow[]> rows;
  std::unique_ptr<double[]> before;                     ///< 3 per row: impulses before the last sweep with momentum
  std::unique_ptr<PackedSweeps> packed;                 ///< where there are clusters
  std::vector<double> u, u_free, u_start, error, step;  ///< 6 per active body
  std::unique_ptr<ClusterScratch> clusters;
  bool is_infeasible = false;  ///< the group that was solved last: no velocities keep its contacts apart
};

struct ClusterScratch {
  RowClusters rows;
  GroupScratch group;
};

struct NewtonScratch {
  NewtonScratch(std::size_t bodies, std::size_t rows) : groups(bodies, rows), group(bodies, rows) {}

  RowGroups groups;
  GroupScratch group;
  bool is_infeasible = false;  ///< the rows that were solved last
};

/// Improves lambda of a group's rows and u (consistent with each other) until the residual is accepted, or keeps the
/// best. `groups`: has the group open and watches its idle rows; may be nullptr. `is_nearly_solved`: but for few rows.
/// Returns the number of Newton steps.
int solve_group(const Residuals& residuals, std::span<Row> rows, double* u, GroupScratch& work, RowGroups* groups,
                bool is_nearly_solved) noexcept;

/// The same for the rows of an island.
int newton_rows(const Residuals& residuals, Row* first, Row* end, double* u, NewtonScratch& work) noexcept;

}  // namespace snug::physics::internal
