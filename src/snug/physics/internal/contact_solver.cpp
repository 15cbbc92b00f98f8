// Contact solver: velocities that satisfy Signorini, Newton and the exact Coulomb disc at all contacts of an island.
#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

/// Sweeps go on for as long as two of them leave less than `slow` of the change before, else Newton's method takes
/// over. Small islands get more of them: they cost less than a linear system, and share the load of flat faces more
/// evenly. Of islands that are likely to be swept with momentum anyway, most of all rows would be unsolved still.
struct Patience {
  int least;
  double slow;
};
constexpr std::ptrdiff_t kSmallIsland = 256;  ///< rows
constexpr Patience kSmall{6, 0.8}, kLarge{3, 0.3}, kHeap{1, 0.3};

Patience patience_with(std::ptrdiff_t rows) {
  if (rows <= kSmallIsland) return kSmall;
  return rows < kSharedGroup ? kLarge : kHeap;
}

constexpr int kMostSweeps = 20;  ///< before Newton's method

/// Impulses of a sliding contact: the normal law, then the tangential law for its answer. The visits of later sweeps do
/// the rest: three rounds of the two at once take longer than they save.
inline void solve_sliding(const Row& row, const double (&xi)[3], double (&lambda)[3]) {
  const double* W = row.W;
  const double normal = xi[0] - row.target + row.gamma * row.lambda[0];
  lambda[0] = std::max(0.0, row.lambda[0] - normal / W[0]);
  const double d = lambda[0] - row.lambda[0];
  lambda[1] = row.lambda[1] - row.step_t * (xi[1] + W[1] * d);
  lambda[2] = row.lambda[2] - row.step_t * (xi[2] + W[2] * d);
  project_to_disc(row.mu * lambda[0], lambda[1], lambda[2]);
}

/// Impulses of one contact with all others fixed: separating, sticking (exact 3x3 solve) or sliding.
inline void solve_local(const Row& row, const double (&xi)[3], double (&lambda)[3]) {
  const double* W = row.W;
  const double* l = row.lambda;
  const double normal = xi[0] - row.target + row.gamma * l[0];
  // Without any impulse here: does the contact open?
  if (normal - (W[0] * l[0] + W[1] * l[1] + W[2] * l[2]) >= 0.0) {
    lambda[0] = lambda[1] = lambda[2] = 0.0;
    return;
  }
  const double* V = row.W_inverse;
  lambda[0] = l[0] - (V[0] * normal + V[1] * xi[1] + V[2] * xi[2]);
  lambda[1] = l[1] - (V[1] * normal + V[3] * xi[1] + V[4] * xi[2]);
  lambda[2] = l[2] - (V[2] * normal + V[4] * xi[1] + V[5] * xi[2]);
  const double limit = row.mu * lambda[0];
  if (lambda[0] >= 0.0 && lambda[1] * lambda[1] + lambda[2] * lambda[2] <= limit * limit) return;
  solve_sliding(row, xi, lambda);
}

/// One visit; returns the size of the change in relative velocity, m/s.
inline double relax(Row& row, double* u) {
  if (stays_open(row, u)) return 0.0;
  double xi[3];
  contact_velocity(row, u, xi);
  double lambda[3];
  solve_local(row, xi, lambda);
  const double d[3] = {lambda[0] - row.lambda[0], lambda[1] - row.lambda[1], lambda[2] - row.lambda[2]};
  if (d[0] == 0.0 && d[1] == 0.0 && d[2] == 0.0) return 0.0;
  apply(row, d, u);
  row.lambda[0] = lambda[0], row.lambda[1] = lambda[1], row.lambda[2] = lambda[2];
  row.is_changed = true;
  return std::max({row.W[0] * std::abs(d[0]), row.W[3] * std::abs(d[1]), row.W[5] * std::abs(d[2])});
}

}  // namespace

double sweep_rows(Row* first, Row* end, double* u, bool is_forward) noexcept {
  double change = 0.0;
  if (is_forward) {
    for (Row* row = first; row != end; ++row) change = std::max(change, relax(*row, u));
  } else {
    for (Row* row = end; row != first;) change = std::max(change, relax(*--row, u));
  }
  return change;
}

double sweep_with_momentum(Row* first, Row* end, double* u, double momentum, double* before, double& uphill) noexcept {
  double change = 0.0;
  uphill = 0.0;
  for (Row* row = first; row != end; ++row, before += 3) {
    double old[3], start[3];
    for (int k = 0; k < 3; ++k) {
      old[k] = row->lambda[k];
      row->lambda[k] = start[k] = old[k] + momentum * (old[k] - before[k]);
      before[k] = old[k];
    }
    (void)relax(*row, u);
    const double mobility[3] = {row->W[0], row->W[3], row->W[5]};
    for (int k = 0; k < 3; ++k) {
      const double d = row->lambda[k] - old[k];
      change = std::max(change, mobility[k] * std::abs(d));
      uphill += mobility[k] * (start[k] - row->lambda[k]) * d;
    }
  }
  return change;
}

void finish_row(Row& row) noexcept {
  double* W = row.W;
  const auto product = [&row](int i, int j) {
    Pair sum{};
    if (row.ia >= 0) sum = dot(row.a(i), row.a(j));
    if (row.ib >= 0) sum += dot(row.b(i), row.b(j));
    return sum[0] + sum[1];
  };
  W[0] = product(0, 0) + row.gamma, W[1] = product(0, 1), W[2] = product(0, 2);
  W[3] = product(1, 1), W[4] = product(1, 2), W[5] = product(2, 2);
  if (row.kind == RowKind::Spinning) W[5] = W[3];  // its third axis is none: nothing moves along it
  const double c0 = W[3] * W[5] - W[4] * W[4];
  const double c1 = W[2] * W[4] - W[1] * W[5];
  const double c2 = W[1] * W[4] - W[2] * W[3];
  const double scale = 1.0 / (W[0] * c0 + W[1] * c1 + W[2] * c2);
  double* V = row.W_inverse;
  V[0] = c0 * scale, V[1] = c1 * scale, V[2] = c2 * scale;
  V[3] = (W[0] * W[5] - W[2] * W[2]) * scale;
  V[4] = (W[1] * W[2] - W[0] * W[4]) * scale;
  V[5] = (W[0] * W[3] - W[1] * W[1]) * scale;
  const double mean = 0.5 * (W[3] + W[5]);
  const double half = 0.5 * (W[3] - W[5]);
  row.step_t = 1.0 / (mean + std::sqrt(half * half + W[4] * W[4]));
}

SolveResult solve_rows(const StepSettings& settings, const Residuals& residuals, Row* first, Row* end, double* u,
                       NewtonScratch& newton) noexcept {
  const Patience patience = patience_with(end - first);
  bool is_newton_done = false;
  double changes[2] = {};                                        // of the last two sweeps
  apply_impulses(first, end, u, pool_of(newton.group.threads));  // warm start
  SolveResult result;
  while (result.iterations < settings.max_sweeps) {
    const double change = sweep_rows(first, end, u, result.iterations % 2 == 0);
    ++result.iterations;
    result.residual = change;
    if (change <= residuals.wanted) {
      // Right after its visit a contact misses its law by about its own change (a sliding one, visited once: by what
      // friction changes in the normal velocity); later visits moved it by at most the sum of their changes.
      result.residual = change * static_cast<double>(end - first + 1);
      if (result.residual <= residuals.wanted) return result;
      result.residual = worst_residual(newton.group.threads, first, end, u);
      if (result.residual <= residuals.wanted) return result;
    }
    const bool is_slow = change > patience.slow * changes[0];
    changes[0] = std::exchange(changes[1], change);
    if (!is_newton_done) {
      if (result.iterations < patience.least || (!is_slow && result.iterations < kMostSweeps)) continue;
      is_newton_done = true;
      result.iterations += newton_rows(residuals, first, end, u, newton);
      result.is_infeasible = newton.is_infeasible;
      result.residual = newton.residual;
    } else {
      result.residual = worst_residual(newton.group.threads, first, end, u);
    }
    if (result.residual <= residuals.accepted) return result;
    if (result.is_infeasible) break;
  }
  result.has_converged = false;
  return result;
}

}  // namespace snug::physics::internal
