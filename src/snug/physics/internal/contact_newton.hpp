// Contact Newton: solves the contacts of islands on which Gauss-Seidel converges slowly. docs/theory/contact.md,
// section 4.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "snug/core/worker_pool.hpp"
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
struct NewtonScratch;
class PackedSweeps;

/// Groups of as many rows are solved one after the other, each by all threads; smaller ones side by side.
constexpr std::ptrdiff_t kSharedGroup = 1000;

/// Threads for the groups of one island, and what each of them solves with; the first is the one that calls.
struct SolverThreads {
  WorkerPool* pool = nullptr;  ///< of as many threads as there are scratches
  std::vector<NewtonScratch*> scratches;
};
inline WorkerPool* pool_of(const SolverThreads* threads) { return threads != nullptr ? threads->pool : nullptr; }

/// What single steps and runs of sweeps work in: nothing in it outlasts them but the rows that were packed last. A
/// group and the parts that it is looked at in share it, since one thread solves them in turn.
struct StepScratch {
  StepScratch(std::size_t bodies, std::size_t rows);
  ~StepScratch();

  std::shared_ptr<FactorStore> factors;
  std::vector<double> u, u_start, error, step;  ///< 6 per active body
  std::unique_ptr<NewtonLaw[]> laws;            ///< of each row
  std::unique_ptr<double[]> before;             ///< 3 per row: impulses before the last sweep with momentum
  std::unique_ptr<PackedSweeps> packed;
  std::int64_t packings = 0;  ///< number of the last group packed
};

/// What a group of rows is solved with.
struct GroupScratch {
  static constexpr int kLevels = 2;  ///< how often parts of a group are looked at in parts again

  /// `levels`: of them that are left; for a part fewer than all.
  GroupScratch(std::size_t bodies, std::size_t rows, std::shared_ptr<StepScratch> steps, int levels = kLevels);
  ~GroupScratch();
  GroupScratch(GroupScratch&&) noexcept;

  std::shared_ptr<StepScratch> steps;
  ContactSystem system;
  std::unique_ptr<NewtonRow[]> rows;
  std::vector<double> u_free;  ///< 6 per active body
  std::unique_ptr<ClusterScratch> clusters;
  bool is_part;                            ///< of a larger group
  bool is_infeasible = false;              ///< the group that was solved last: no velocities keep its contacts apart
  const SolverThreads* threads = nullptr;  ///< for large groups; nullptr: only the one that calls
  const Vector3* centres = nullptr;        ///< of each active body, m, W; nullptr: large groups are not cut
};

struct ClusterScratch {
  RowClusters rows;
  GroupScratch group;
};

struct GroupOutcome {
  int iterations = 0;
  bool is_infeasible = false;
};

struct NewtonScratch {
  NewtonScratch(std::size_t bodies, std::size_t rows)
      : groups(bodies, rows), open_group(rows), group(bodies, rows, std::make_shared<StepScratch>(bodies, rows)) {}

  RowGroups groups;
  OpenGroup open_group;
  GroupScratch group;          ///< with the threads that may be used
  bool is_infeasible = false;  ///< the rows that were solved last
  double residual = 0.0;       ///< m/s, that they were left with
  GroupOutcome side_by_side;   ///< of the groups that this thread has solved beside others
};

/// Improves lambda of a group's rows and u (consistent with each other) until the residual is accepted, or keeps the
/// best. `open_group`: watches its idle rows; may be nullptr. `is_nearly_solved`: but for few rows. Returns the number
/// of Newton steps.
int solve_group(const Residuals& residuals, std::span<Row> rows, double* u, GroupScratch& work, OpenGroup* open_group,
                bool is_nearly_solved) noexcept;

/// On as many threads as there are. `threads` may be nullptr.
double worst_residual(const SolverThreads* threads, const Row* first, const Row* end, const double* u) noexcept;

/// u of all impulses added to that without, body by body in the order of the rows. `pool`: threads to use, or nullptr.
void apply_impulses(const Row* first, const Row* end, double* u, WorkerPool* pool) noexcept;

/// solve_group() for the rows of an island. Leaves their residual in `work`.
int newton_rows(const Residuals& residuals, Row* first, Row* end, double* u, NewtonScratch& work) noexcept;

}  // namespace snug::physics::internal
