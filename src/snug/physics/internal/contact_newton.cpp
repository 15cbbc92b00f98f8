// Contact Newton: an island's groups, one after the other, until all of its contacts are solved.
#include "snug/physics/internal/contact_newton.hpp"

#include <algorithm>

#include "snug/physics/internal/chunks.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kRounds = 5;  ///< in which groups are found anew, since contacts between them have closed

/// Of groups that are solved side by side; with fewer, one thread has done them before another is there.
constexpr std::size_t kLeastSideBySide = 100;  // rows

bool is_small(const RowGroups& groups, std::size_t group) {
  return static_cast<std::ptrdiff_t>(groups.row_count(group)) < kSharedGroup;
}

/// One group of those found in `groups`, by what one thread works with.
GroupOutcome solve_open_group(const Residuals& residuals, const RowGroups& groups, std::size_t index, double* u,
                              NewtonScratch& work, bool is_nearly_solved, WorkerPool* pool) {
  const std::span<Row> rows = work.open_group.open(groups, index, pool);
  const int iterations = solve_group(residuals, rows, u, work.group, &work.open_group, is_nearly_solved);
  work.open_group.close();
  return {iterations, work.group.is_infeasible};
}

void add_outcome(const GroupOutcome& part, GroupOutcome& outcome) {
  outcome.iterations = std::max(outcome.iterations, part.iterations);
  outcome.is_infeasible |= part.is_infeasible;
}

/// All groups found: they share no body, so whether they are solved one after the other or side by side, and by which
/// thread, changes nothing.
GroupOutcome solve_groups(const Residuals& residuals, double* u, NewtonScratch& work, bool is_nearly_solved) {
  const RowGroups& groups = work.groups;
  const SolverThreads* threads = work.group.threads;
  GroupOutcome outcome;
  std::size_t small_rows = 0;
  for (std::size_t i = 0; i < groups.count(); ++i) {
    if (threads != nullptr && is_small(groups, i)) {
      small_rows += groups.row_count(i);
    } else {
      add_outcome(solve_open_group(residuals, groups, i, u, work, is_nearly_solved, pool_of(threads)), outcome);
    }
  }
  if (small_rows == 0) return outcome;
  const auto solve = [&](int index, int worker) {
    const auto group = static_cast<std::size_t>(index);
    if (!is_small(groups, group)) return;
    NewtonScratch& mine = *threads->scratches[static_cast<std::size_t>(worker)];
    add_outcome(solve_open_group(residuals, groups, group, u, mine, is_nearly_solved, nullptr), mine.side_by_side);
  };
  for (NewtonScratch* scratch : threads->scratches) scratch->side_by_side = {};
  const int count = static_cast<int>(groups.count());
  if (small_rows >= kLeastSideBySide) {
    threads->pool->run(count, solve);
  } else {
    for (int i = 0; i < count; ++i) solve(i, 0);
  }
  for (const NewtonScratch* scratch : threads->scratches) add_outcome(scratch->side_by_side, outcome);
  return outcome;
}

}  // namespace

double worst_residual(const SolverThreads* threads, const Row* first, const Row* end, const double* u) noexcept {
  return largest_of_ranges(
      pool_of(threads), static_cast<std::size_t>(end - first),
      [&](std::size_t begin, std::size_t past) { return worst_residual(first + begin, first + past, u); });
}

void apply_impulses(const Row* first, const Row* end, double* u, WorkerPool* pool) noexcept {
  if (pool == nullptr || !is_shared(*pool, static_cast<std::size_t>(end - first))) {
    for (const Row* row = first; row != end; ++row) apply(*row, row->lambda, u);
    return;
  }
  // Each half of the bodies takes its own from all rows.
  const Row& middle = first[(end - first) / 2];
  const int cut = std::max(middle.ia, middle.ib);
  pool->run(2, [&](int half, int) {
    const auto is_of_half = [&](int body) { return body >= 0 && (body < cut) == (half == 0); };
    for (const Row* row = first; row != end; ++row) {
      if (is_of_half(row->ia)) add_scaled(u + 6 * row->ia, row->a(0), row->lambda);
      if (is_of_half(row->ib)) add_scaled(u + 6 * row->ib, row->b(0), row->lambda);
    }
  });
}

int newton_rows(const Residuals& residuals, Row* first, Row* end, double* u, NewtonScratch& work) noexcept {
  int iterations = 0;
  work.is_infeasible = false;
  for (int round = 0; round < kRounds; ++round) {
    const bool is_first = round == 0;
    const double enough = is_first ? residuals.wanted : residuals.accepted;
    work.residual = work.groups.find(first, end, u, enough, pool_of(work.group.threads));
    if (!(work.residual > enough)) return iterations;  // the caller says what is not finite
    const GroupOutcome outcome = solve_groups(residuals, u, work, !is_first);
    work.is_infeasible = outcome.is_infeasible;
    iterations += outcome.iterations;
    if (work.is_infeasible) break;
  }
  const auto measure = [&] { work.residual = worst_residual(work.group.threads, first, end, u); };
  measure();
  if (work.is_infeasible || work.residual <= residuals.accepted) return iterations;
  iterations += solve_group(residuals, {first, end}, u, work.group, nullptr, true);
  measure();
  return iterations;
}

}  // namespace snug::physics::internal
