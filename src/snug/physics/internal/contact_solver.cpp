// Contact solver: velocities that satisfy Signorini, Newton and the exact Coulomb disc at all contacts of an island.
#include <algorithm>
#include <cmath>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

using Pair = double __attribute__((vector_size(16)));

inline Pair load(const double* p) { return *reinterpret_cast<const Pair*>(p); }
inline void store(double* p, Pair value) { *reinterpret_cast<Pair*>(p) = value; }

inline Pair dot(const double* row, const double* u) {
  return load(row) * load(u) + load(row + 2) * load(u + 2) + load(row + 4) * load(u + 4);
}

inline void add_scaled(double* u, const double (&rows)[3][6], const double (&d)[3]) {
  const Pair d0{d[0], d[0]}, d1{d[1], d[1]}, d2{d[2], d[2]};
  for (int k = 0; k < 6; k += 2) {
    store(u + k, load(u + k) + (load(rows[0] + k) * d0 + load(rows[1] + k) * d1 + load(rows[2] + k) * d2));
  }
}

inline void contact_velocity(const Row& row, const double* u, double (&xi)[3]) {
  Pair s0{}, s1{}, s2{};
  if (row.ia >= 0) {
    const double* ua = u + 6 * row.ia;
    s0 = dot(row.a[0], ua), s1 = dot(row.a[1], ua), s2 = dot(row.a[2], ua);
  }
  if (row.ib >= 0) {
    const double* ub = u + 6 * row.ib;
    s0 += dot(row.b[0], ub), s1 += dot(row.b[1], ub), s2 += dot(row.b[2], ub);
  }
  xi[0] = row.bias[0] + (s0[0] + s0[1]);
  xi[1] = row.bias[1] + (s1[0] + s1[1]);
  xi[2] = row.bias[2] + (s2[0] + s2[1]);
}

inline void apply(const Row& row, const double (&d)[3], double* u) {
  if (row.ia >= 0) add_scaled(u + 6 * row.ia, row.a, d);
  if (row.ib >= 0) add_scaled(u + 6 * row.ib, row.b, d);
}

inline void project_to_disc(double radius, double& x, double& y) {
  const double square = x * x + y * y;
  if (square > radius * radius) {
    const double scale = radius / std::sqrt(square);
    x *= scale;
    y *= scale;
  }
}

/// Impulses of a sliding contact: a few exact alternations of the normal and the tangential law.
inline void solve_sliding(const Row& row, const double (&xi)[3], double (&lambda)[3]) {
  const double* W = row.W;
  double d[3] = {0.0, 0.0, 0.0};
  for (int i = 0; i < 3; ++i) {
    const double normal = xi[0] - row.target + row.gamma * row.lambda[0] + W[0] * d[0] + W[1] * d[1] + W[2] * d[2];
    lambda[0] = std::max(0.0, row.lambda[0] + d[0] - normal / W[0]);
    d[0] = lambda[0] - row.lambda[0];
    const double v1 = xi[1] + W[1] * d[0] + W[3] * d[1] + W[4] * d[2];
    const double v2 = xi[2] + W[2] * d[0] + W[4] * d[1] + W[5] * d[2];
    lambda[1] = row.lambda[1] + d[1] - row.step_t * v1;
    lambda[2] = row.lambda[2] + d[2] - row.step_t * v2;
    project_to_disc(row.mu * lambda[0], lambda[1], lambda[2]);
    d[1] = lambda[1] - row.lambda[1];
    d[2] = lambda[2] - row.lambda[2];
  }
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
  double xi[3];
  contact_velocity(row, u, xi);
  double lambda[3];
  solve_local(row, xi, lambda);
  const double d[3] = {lambda[0] - row.lambda[0], lambda[1] - row.lambda[1], lambda[2] - row.lambda[2]};
  if (d[0] == 0.0 && d[1] == 0.0 && d[2] == 0.0) return 0.0;
  apply(row, d, u);
  row.lambda[0] = lambda[0], row.lambda[1] = lambda[1], row.lambda[2] = lambda[2];
  return std::max({row.W[0] * std::abs(d[0]), row.W[3] * std::abs(d[1]), row.W[5] * std::abs(d[2])});
}

/// Alart-Curnier natural map of one contact in units of velocity: zero exactly at a solution.
inline double natural_map(const Row& row, const double* u) {
  double xi[3];
  contact_velocity(row, u, xi);
  const double normal = xi[0] - row.target + row.gamma * row.lambda[0];
  const double rn = std::abs(row.lambda[0] - std::max(0.0, row.lambda[0] - normal / row.W[0])) * row.W[0];
  double p1 = row.lambda[1] - row.step_t * xi[1];
  double p2 = row.lambda[2] - row.step_t * xi[2];
  project_to_disc(row.mu * row.lambda[0], p1, p2);
  const double r1 = row.lambda[1] - p1, r2 = row.lambda[2] - p2;
  return std::max(rn, std::sqrt(r1 * r1 + r2 * r2) / row.step_t);
}

}  // namespace

double relative_velocity(const Row& row, int axis, const double* u) noexcept {
  Pair s{};
  if (row.ia >= 0) s = dot(row.a[axis], u + 6 * row.ia);
  if (row.ib >= 0) s += dot(row.b[axis], u + 6 * row.ib);
  return row.bias[axis] + (s[0] + s[1]);
}

void finish_row(Row& row) noexcept {
  double* W = row.W;
  const auto product = [&row](int i, int j) {
    Pair sum{};
    if (row.ia >= 0) sum = dot(row.a[i], row.a[j]);
    if (row.ib >= 0) sum += dot(row.b[i], row.b[j]);
    return sum[0] + sum[1];
  };
  W[0] = product(0, 0) + row.gamma, W[1] = product(0, 1), W[2] = product(0, 2);
  W[3] = product(1, 1), W[4] = product(1, 2), W[5] = product(2, 2);
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

SolveResult solve_rows(const StepSettings& settings, Row* first, Row* end, double* u) noexcept {
  for (Row* row = first; row != end; ++row) apply(*row, row->lambda, u);  // warm start
  SolveResult result;
  while (result.sweeps < settings.max_sweeps) {
    double change = 0.0;
    if (result.sweeps % 2 == 0) {
      for (Row* row = first; row != end; ++row) change = std::max(change, relax(*row, u));
    } else {
      for (Row* row = end; row != first;) change = std::max(change, relax(*--row, u));
    }
    ++result.sweeps;
    result.residual = change;
    if (change > settings.tolerance) continue;
    // A contact satisfies its law right after its visit; later visits moved it by at most the sum of their changes.
    result.residual = change * static_cast<double>(end - first);
    if (result.residual <= settings.tolerance) return result;
    double residual = 0.0;
    for (const Row* row = first; row != end; ++row) residual = std::max(residual, natural_map(*row, u));
    result.residual = residual;
    if (residual <= settings.tolerance) return result;
  }
  result.has_converged = false;
  return result;
}

void correct_positions(const StepSettings& settings, Row* first, Row* end, const Contact* contacts, const double* u,
                       double* shift) noexcept {
  const double dt = settings.dt;
  // Old overlaps are pushed out no faster than this; what this step's impacts overshot is undone at once.
  constexpr double kRecoverySpeed = 0.2;
  double worst = 0.0;
  for (Row* row = first; row != end; ++row) {
    const Contact& contact = contacts[row->contact];
    const double gap = contact.phi + 0.5 * dt * (contact.approach + relative_velocity(*row, 0, u));
    const double error = row->gap_end - gap;
    const double cap = dt * (0.5 * std::abs(contact.approach) + kRecoverySpeed);
    row->gap_end = std::min(error, cap);  // from here on: wanted displacement
    row->position_lambda = 0.0;
    if (!row->is_rigid) continue;
    worst = std::max(worst, row->is_bounce ? std::abs(error) : error);
  }
  if (worst <= settings.position_slop) return;
  for (int sweep = 0; sweep < 50; ++sweep) {
    double change = 0.0;
    for (Row* row = first; row != end; ++row) {
      if (!row->is_rigid) continue;
      double moved = 0.0;
      for (int k = 0; k < 6; ++k) {
        if (row->ia >= 0) moved += row->a[0][k] * shift[6 * row->ia + k];
        if (row->ib >= 0) moved += row->b[0][k] * shift[6 * row->ib + k];
      }
      double lambda = row->position_lambda + (row->gap_end - moved) / row->W[0];
      if (!row->is_bounce) lambda = std::max(0.0, lambda);
      const double d = lambda - row->position_lambda;
      if (d == 0.0) continue;
      row->position_lambda = lambda;
      for (int k = 0; k < 6; ++k) {
        if (row->ia >= 0) shift[6 * row->ia + k] += row->a[0][k] * d;
        if (row->ib >= 0) shift[6 * row->ib + k] += row->b[0][k] * d;
      }
      change = std::max(change, std::abs(d) * row->W[0]);
    }
    if (change <= 0.1 * settings.position_slop) break;
  }
}

}  // namespace snug::physics::internal
