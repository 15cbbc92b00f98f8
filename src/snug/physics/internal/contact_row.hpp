// Contact row: one frictional contact in whitened coordinates, and its small kernels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace snug::physics::internal {

/// What a row is: a touching point, or the resistance of a pair to rolling or spinning on each other
/// (turning_rows.cpp).
enum class RowKind : std::uint8_t { Contact, Rolling, Spinning };

/// One frictional contact in whitened coordinates: rows n, t1, t2.
struct alignas(64) Row {
  double j[3][12];      ///< J T: of body A, then of B; of one that does not move without meaning
  double lambda[3];     ///< impulses, N s
  double bias[3];       ///< relative velocity from kinematic bodies, m/s
  double target;        ///< least allowed normal velocity (regularised when compliant), m/s
  std::int32_t ia, ib;  ///< active body or -1
  double W[6];          ///< Delassus block: nn, n1, n2, 11, 12, 22 (with regularisation in nn)
  double W_inverse[6];
  double gamma;  ///< compliance in nn, (m/s)/(N s)
  double mu;
  double step_t;         ///< 1 / largest eigenvalue of the tangential block
  double gap_end;        ///< wanted gap after the step, m
  std::int32_t contact;  ///< turning: the first of the pair
  RowKind kind;
  bool is_rigid;
  bool is_bounce;
  bool is_changed;  ///< lambda is not what the state remembers

  [[nodiscard]] const double* a(int axis) const { return j[axis]; }
  [[nodiscard]] const double* b(int axis) const { return j[axis] + 6; }
};

using Pair = double __attribute__((vector_size(16)));

inline Pair load(const double* p) { return *reinterpret_cast<const Pair*>(p); }
inline void store(double* p, Pair value) { *reinterpret_cast<Pair*>(p) = value; }

inline Pair dot(const double* row, const double* u) {
  return load(row) * load(u) + load(row + 2) * load(u + 2) + load(row + 4) * load(u + 4);
}

/// u += rows^T d, rows that lie 12 numbers behind each other.
inline void add_scaled(double* u, const double* rows, const double (&d)[3]) {
  const Pair d0{d[0], d[0]}, d1{d[1], d[1]}, d2{d[2], d[2]};
  for (int k = 0; k < 6; k += 2) {
    store(u + k, load(u + k) + (load(rows + k) * d0 + load(rows + 12 + k) * d1 + load(rows + 24 + k) * d2));
  }
}

inline void contact_velocity(const Row& row, const double* u, double (&xi)[3]) {
  Pair s0{}, s1{}, s2{};
  if (row.ia >= 0) {
    const double* ua = u + 6 * row.ia;
    s0 = dot(row.a(0), ua), s1 = dot(row.a(1), ua), s2 = dot(row.a(2), ua);
  }
  if (row.ib >= 0) {
    const double* ub = u + 6 * row.ib;
    s0 += dot(row.b(0), ub), s1 += dot(row.b(1), ub), s2 += dot(row.b(2), ub);
  }
  xi[0] = row.bias[0] + (s0[0] + s0[1]);
  xi[1] = row.bias[1] + (s1[0] + s1[1]);
  xi[2] = row.bias[2] + (s2[0] + s2[1]);
}

/// Relative velocity along one axis.
inline double relative_velocity(const Row& row, int axis, const double* u) {
  Pair s{};
  if (row.ia >= 0) s = dot(row.a(axis), u + 6 * row.ia);
  if (row.ib >= 0) s += dot(row.b(axis), u + 6 * row.ib);
  return row.bias[axis] + (s[0] + s[1]);
}

inline void apply(const Row& row, const double (&d)[3], double* u) {
  if (row.ia >= 0) add_scaled(u + 6 * row.ia, row.a(0), d);
  if (row.ib >= 0) add_scaled(u + 6 * row.ib, row.b(0), d);
}

inline void project_to_disc(double radius, double& x, double& y) {
  const double square = x * x + y * y;
  if (square > radius * radius) {
    const double scale = radius / std::sqrt(square);
    x *= scale;
    y *= scale;
  }
}

/// Alart-Curnier natural map of one contact in units of velocity, for the relative velocity xi and the impulse lambda:
/// zero exactly at a solution.
inline double natural_map(const Row& row, const double (&xi)[3], const double* lambda) {
  const double normal = xi[0] - row.target + row.gamma * lambda[0];
  const double rn = std::abs(lambda[0] - std::max(0.0, lambda[0] - normal / row.W[0])) * row.W[0];
  double p1 = lambda[1] - row.step_t * xi[1];
  double p2 = lambda[2] - row.step_t * xi[2];
  project_to_disc(row.mu * lambda[0], p1, p2);
  const double r1 = lambda[1] - p1, r2 = lambda[2] - p2;
  return std::max(rn, std::sqrt(r1 * r1 + r2 * r2) / row.step_t);
}

/// An open contact that stays open, as most of a pile do: what its tangents do is of no concern.
inline bool stays_open(const Row& row, const double* u) {
  return row.lambda[0] == 0.0 && row.lambda[1] == 0.0 && row.lambda[2] == 0.0 &&
         relative_velocity(row, 0, u) >= row.target;
}

inline double natural_map(const Row& row, const double* u) {
  if (stays_open(row, u)) return 0.0;
  double xi[3];
  contact_velocity(row, u, xi);
  return natural_map(row, xi, row.lambda);
}

/// Sliding impulses are projected onto the disc: they are on its edge up to rounding.
inline bool is_at_friction_limit(double mu, double normal, double tangential_1, double tangential_2) {
  const double limit = mu * normal;
  const double square = tangential_1 * tangential_1 + tangential_2 * tangential_2;
  return normal > 0.0 && square >= limit * limit * (1.0 - 1e-9);
}

inline double worst_residual(const Row* first, const Row* end, const double* u) {
  double worst = 0.0;
  for (const Row* row = first; row != end; ++row) worst = std::max(worst, natural_map(*row, u));
  return worst;
}

/// One sweep of Gauss-Seidel; returns the largest change of relative velocity, m/s.
double sweep_rows(Row* first, Row* end, double* u, bool is_forward) noexcept;

/// One forward sweep that starts at each row from its impulse and `momentum` times what the sweep before changed of it.
/// `before`: 3 numbers of each row, its impulse before that sweep, renewed here. u belongs to the impulses with that
/// momentum. `uphill`: positive where the sweep goes back on what the momentum adds. Returns the largest change of
/// relative velocity, m/s.
double sweep_with_momentum(Row* first, Row* end, double* u, double momentum, double* before, double& uphill) noexcept;

/// Delassus block, its inverse and the tangential step, from a, b and gamma.
void finish_row(Row& row) noexcept;

}  // namespace snug::physics::internal
