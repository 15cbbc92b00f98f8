// Contact Newton: finishes the islands on which Gauss-Seidel converges slowly. docs/theory/contact.md, section 4.
#include <algorithm>
#include <cmath>

#include "snug/physics/internal/contact_newton.hpp"

namespace snug::physics::internal {
namespace {

constexpr double kFirstPenalty = 30.0;  ///< in units of 1 / W of each contact
constexpr double kLeastPenalty = 0.3;
constexpr double kLargestPenalty = 1e8;
constexpr double kGrowth = 3.0;  ///< of the penalty after a solved stage, and its cut after a failed one
constexpr int kMaxIterations = 300;
constexpr int kMaxStageIterations = 20;
constexpr int kMaxHalvings = 6;

/// One island: rows, the bodies they touch, scratch.
struct Problem {
  Row* first;
  Row* end;
  NewtonScratch& work;
  double penalty = kFirstPenalty;
};

/// Impulse that the augmented law gives for this relative velocity, and minus its derivative.
void augmented_law(const Row& row, double penalty, const double (&xi)[3], NewtonRow& law) {
  std::fill_n(law.slope, 9, 0.0);
  std::fill_n(law.lambda, 3, 0.0);
  const double rigid = penalty / (row.W[0] - row.gamma);
  const double c = rigid / (1.0 + rigid * row.gamma);
  const double normal = law.center[0] / (1.0 + rigid * row.gamma) - c * (xi[0] - row.target);
  if (normal <= 0.0) return;
  const double t = penalty * row.step_t;
  const double z1 = law.center[1] - t * xi[1], z2 = law.center[2] - t * xi[2];
  const double square = z1 * z1 + z2 * z2, limit = row.mu * normal;
  law.lambda[0] = normal;
  law.slope[0] = c;
  if (square <= limit * limit) {
    law.lambda[1] = z1, law.lambda[2] = z2;
    law.slope[4] = law.slope[8] = t;
    return;
  }
  const double length = std::sqrt(square);
  const double d1 = z1 / length, d2 = z2 / length, turn = t * limit / length;
  law.lambda[1] = limit * d1, law.lambda[2] = limit * d2;
  law.slope[3] = row.mu * d1 * c, law.slope[6] = row.mu * d2 * c;
  law.slope[4] = turn * (1.0 - d1 * d1);
  law.slope[5] = law.slope[7] = -turn * d1 * d2;
  law.slope[8] = turn * (1.0 - d2 * d2);
}

/// Momentum error u - u_free - sum (J T)^T lambda(u) of every body at problem.work.u; returns its norm.
double evaluate(const Problem& problem) {
  NewtonScratch& work = problem.work;
  for (const int body : work.active) {
    for (int k = 6 * body; k < 6 * body + 6; ++k) {
      const auto i = static_cast<std::size_t>(k);
      work.error[i] = work.u[i] - work.u_free[i];
    }
  }
  NewtonRow* law = work.rows.get();
  for (const Row* row = problem.first; row != problem.end; ++row, ++law) {
    double xi[3];
    contact_velocity(*row, work.u.data(), xi);
    augmented_law(*row, problem.penalty, xi, *law);
    if (law->lambda[0] <= 0.0) continue;
    const double d[3] = {-law->lambda[0], -law->lambda[1], -law->lambda[2]};
    apply(*row, d, work.error.data());
  }
  double square = 0.0;
  for (const int body : work.active) {
    square += Eigen::Map<const Vector6>(work.error.data() + 6 * body).squaredNorm();
  }
  return std::sqrt(square);
}

/// M += sum over the three rows of a^T c.
void add_product(Matrix6& M, const double (&a)[3][6], const double (&c)[3][6]) {
  double* column = M.data();
  for (int j = 0; j < 6; ++j, column += 6) {
    const Pair c0{c[0][j], c[0][j]}, c1{c[1][j], c[1][j]}, c2{c[2][j], c[2][j]};
    for (int k = 0; k < 6; k += 2) {
      store(column + k, load(column + k) + (load(a[0] + k) * c0 + load(a[1] + k) * c1 + load(a[2] + k) * c2));
    }
  }
}

/// slope * rows.
void multiply(const double (&slope)[9], const double (&rows)[3][6], double (&out)[3][6]) {
  for (int i = 0; i < 3; ++i) {
    const Pair s0{slope[3 * i], slope[3 * i]}, s1{slope[3 * i + 1], slope[3 * i + 1]},
        s2{slope[3 * i + 2], slope[3 * i + 2]};
    for (int k = 0; k < 6; k += 2) {
      store(out[i] + k, load(rows[0] + k) * s0 + load(rows[1] + k) * s1 + load(rows[2] + k) * s2);
    }
  }
}

/// I + sum (J T)^T slope (J T), in blocks of the island's bodies.
void assemble(const Problem& problem) {
  NewtonScratch& work = problem.work;
  work.solver.set_identity();
  const NewtonRow* law = work.rows.get();
  for (const Row* row = problem.first; row != problem.end; ++row, ++law) {
    if (law->lambda[0] <= 0.0) continue;
    alignas(16) double force[3][6];
    if (law->connection >= 0) {
      const BlockSolver::Coupling coupling = work.solver.coupling(law->connection);
      multiply(law->slope, row->a, force);
      add_product(work.solver.diagonal(work.local[static_cast<std::size_t>(row->ia)]), row->a, force);
      add_product(coupling.ji, row->b, force);
      multiply(law->slope, row->b, force);
      add_product(work.solver.diagonal(work.local[static_cast<std::size_t>(row->ib)]), row->b, force);
      add_product(coupling.ij, row->a, force);
      continue;
    }
    const double (&rows)[3][6] = row->ia >= 0 ? row->a : row->b;
    multiply(law->slope, rows, force);
    add_product(work.solver.diagonal(work.local[static_cast<std::size_t>(std::max(row->ia, row->ib))]), rows, force);
  }
}

/// Newton step: solves the system for step, from error.
void solve_system(const Problem& problem) {
  NewtonScratch& work = problem.work;
  work.solver.factorize();
  const std::size_t count = work.active.size();
  for (std::size_t i = 0; i < count; ++i) std::copy_n(work.error.data() + 6 * work.active[i], 6, work.u_start.data() + 6 * i);
  work.solver.solve(work.u_start.data());
  for (std::size_t i = 0; i < count; ++i) std::copy_n(work.u_start.data() + 6 * i, 6, work.step.data() + 6 * work.active[i]);
}

/// Moves along the Newton step until the momentum error shrinks. Returns the new error, negative when it does not.
double search_line(const Problem& problem, double error) {
  NewtonScratch& work = problem.work;
  for (const int body : work.active) std::copy_n(work.u.data() + 6 * body, 6, work.u_start.data() + 6 * body);
  double length = 1.0;
  for (int halving = 0; halving < kMaxHalvings; ++halving, length *= 0.5) {
    for (const int body : work.active) {
      for (int k = 6 * body; k < 6 * body + 6; ++k) {
        const auto i = static_cast<std::size_t>(k);
        work.u[i] = work.u_start[i] - length * work.step[i];
      }
    }
    const double next = evaluate(problem);
    if (next < (1.0 - 1e-4 * length) * error) return next;
  }
  return -1.0;
}

/// Newton's method for the augmented law with the present centres and penalty. Counts its iterations.
bool solve_stage(const Problem& problem, double tolerance, int& iterations) {
  double error = evaluate(problem);
  for (int i = 0; i < kMaxStageIterations; ++i) {
    if (error <= tolerance) return true;
    ++iterations;
    assemble(problem);
    solve_system(problem);
    error = search_line(problem, error);
    if (error < 0.0) return false;
  }
  return error <= tolerance;
}

/// The bodies of the island, their velocities without its impulses, and which of them share contacts. False: the linear
/// system fills beyond memory.
bool start(Problem& problem, const double* u) {
  NewtonScratch& work = problem.work;
  for (const int body : work.active) work.local[static_cast<std::size_t>(body)] = -1;  // of the island before
  work.active.clear();
  for (const Row* row = problem.first; row != problem.end; ++row) {
    for (const int body : {row->ia, row->ib}) {
      if (body < 0 || work.local[static_cast<std::size_t>(body)] >= 0) continue;
      work.local[static_cast<std::size_t>(body)] = static_cast<int>(work.active.size());
      work.active.push_back(body);
      std::copy_n(u + 6 * body, 6, work.u_free.data() + 6 * body);
    }
  }
  work.solver.begin(static_cast<int>(work.active.size()));
  const Row* last = nullptr;
  int connection = -1;
  NewtonRow* law = work.rows.get();
  for (const Row* row = problem.first; row != problem.end; ++row, ++law) {
    const double d[3] = {-row->lambda[0], -row->lambda[1], -row->lambda[2]};
    apply(*row, d, work.u_free.data());
    const bool is_pair = row->ia >= 0 && row->ib >= 0;
    if (is_pair && (last == nullptr || last->ia != row->ia || last->ib != row->ib)) {
      connection = work.solver.connect(work.local[static_cast<std::size_t>(row->ia)],
                                       work.local[static_cast<std::size_t>(row->ib)]);
      last = row;
    }
    law->connection = is_pair ? connection : -1;
  }
  return work.solver.analyze();
}

/// u from the impulses of the rows.
void apply_impulses(const Problem& problem, double* u) {
  for (const int body : problem.work.active) {
    std::copy_n(problem.work.u_free.data() + 6 * body, 6, u + 6 * body);
  }
  for (const Row* row = problem.first; row != problem.end; ++row) apply(*row, row->lambda, u);
}

}  // namespace

NewtonScratch::NewtonScratch(std::size_t bodies, std::size_t row_capacity)
    : solver(bodies, row_capacity), rows(new NewtonRow[row_capacity]) {
  for (std::vector<double>* v : {&u, &u_free, &u_start, &error, &step}) v->assign(6 * bodies, 0.0);
  local.assign(bodies, -1);
  active.reserve(bodies);
}

int newton_rows(double tolerance, Row* first, Row* end, double* u, NewtonScratch& work) noexcept {
  Problem problem{first, end, work};
  if (!start(problem, u)) return 0;
  const auto each_row = [&](auto&& visit) {
    for (Row* row = first; row != end; ++row) visit(*row, work.rows[static_cast<std::size_t>(row - first)]);
  };
  double mobility = 0.0;  // turns momentum errors into velocities
  each_row([&](Row& row, NewtonRow& law) {
    row.is_changed = true;
    std::copy_n(row.lambda, 3, law.best);
    mobility = std::max({mobility, row.W[0] - row.gamma, row.W[3], row.W[5]});
  });
  double residual = worst_residual(first, end, u), best = residual;
  int iterations = 0;
  while (iterations < kMaxIterations && problem.penalty > kLeastPenalty && residual > tolerance) {
    each_row([](const Row& row, NewtonRow& law) { std::copy_n(row.lambda, 3, law.center); });
    for (const int body : work.active) std::copy_n(u + 6 * body, 6, work.u.data() + 6 * body);
    if (!solve_stage(problem, std::min(0.1 * tolerance, 0.01 * residual) / std::sqrt(mobility), iterations)) {
      problem.penalty /= kGrowth;
      continue;
    }
    each_row([](Row& row, const NewtonRow& law) { std::copy_n(law.lambda, 3, row.lambda); });
    apply_impulses(problem, u);
    residual = worst_residual(first, end, u);
    problem.penalty = std::min(kLargestPenalty, problem.penalty * kGrowth);
    if (residual >= best) continue;
    best = residual;
    each_row([](const Row& row, NewtonRow& law) { std::copy_n(row.lambda, 3, law.best); });
  }
  if (residual > best) {
    each_row([](Row& row, const NewtonRow& law) { std::copy_n(law.best, 3, row.lambda); });
    apply_impulses(problem, u);
  }
  return iterations;
}

}  // namespace snug::physics::internal
