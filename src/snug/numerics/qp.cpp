// QpSolver: small dense convex quadratic programmes, and why one has no solution.
#include "snug/numerics/qp.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "snug/core/check.hpp"

namespace snug::numerics {
namespace {

// A row counts as fulfilled up to this, in the metric of H, relative to the size of what is subtracted: some thousand
// times the rounding of eight products.
constexpr double kRowTolerance = 1e-12;
// A row depends on active ones where less than this of its unit length is across them: far above the rounding of their
// factors, and a multiplier of its inverse is no use to anybody.
constexpr double kDependent = 1e-9;
// Accepted residual of the KKT conditions. Above it the result is Failed, never silently poor.
constexpr double kResidualTolerance = 1e-6;
// Weight of the distance from the point before in the search for the smallest violation, and how often at most.
constexpr double kProximalWeight = 1e-2;
constexpr int kProximalSteps = 30;
// Relative to the length of the row and the size of the numbers: a violation below it is rounding.
constexpr double kInfeasible = 1e-8;

}  // namespace

void QpProblem::reset(int variables) {
  SNUG_CHECK(variables >= 1 && variables <= kMaxQpVariables, "more variables than a QP has room for");
  H.setZero(variables, variables);
  g.setZero(variables);
  A.resize(0, variables);
  b.resize(0);
}

Eigen::Index QpProblem::grow() {
  const Eigen::Index i = b.size();
  SNUG_CHECK(i < kMaxQpRows, "more rows than a QP has room for");
  A.conservativeResize(i + 1, A.cols());
  b.conservativeResize(i + 1);
  return i;
}

struct QpSolver::Work {
  QpRows rows;         ///< in y = L'x, each of unit length
  QpRowVector bounds;  ///< of these
  QpRowVector lengths;
  std::vector<int> active;                   ///< rows that hold with equality, independent of each other
  std::vector<double> z;                     ///< their multipliers
  Eigen::HouseholderQR<QpMatrix> active_qr;  ///< of the active rows as columns
  QpProblem phase_one;
  QpResult phase_one_result;

  Work() {
    active.reserve(kMaxQpVariables + 1);
    z.reserve(kMaxQpVariables + 1);
  }

  enum class End { Solved, NoSolution, NotFinite, NotConvex };
  [[nodiscard]] End solve_dual(const QpProblem& problem, QpResult& result);
  [[nodiscard]] bool add(int added, const QpVector& y_free, QpVector& y);
  void factor_active();
  void solve_active(const QpVector& y_free, QpVector& y);
  void fill_phase_one(const QpProblem& problem, double scale);
  void find_violation(const QpProblem& problem, QpResult& result);
};

namespace {

bool is_finite(const QpProblem& problem) {
  if (!problem.H.allFinite() || !problem.g.allFinite() || !problem.A.allFinite()) return false;
  return std::all_of(problem.b.begin(), problem.b.end(), [](double bound) {
    return std::isfinite(bound) || bound == -std::numeric_limits<double>::infinity();
  });
}

/// Largest violation of the KKT conditions, as QpResult::residual says.
double kkt_residual(const QpProblem& problem, const QpResult& result) {
  const QpVector slope = problem.H * result.x + problem.g - problem.A.transpose() * result.multipliers;
  const double size = 1.0 + problem.g.lpNorm<Eigen::Infinity>();
  double residual = slope.lpNorm<Eigen::Infinity>() / size;
  for (Eigen::Index i = 0; i < problem.b.size(); ++i) {
    const double length = problem.A.row(i).norm();
    if (length == 0.0 || !std::isfinite(problem.b[i])) continue;
    const double gap = (problem.A.row(i).dot(result.x) - problem.b[i]) / length;
    const double scale = 1.0 + std::abs(problem.b[i]) / length + result.x.norm();
    residual = std::max(residual, -gap / scale);
    residual = std::max(residual, std::min(std::abs(gap) / scale, result.multipliers[i] * length / size));
  }
  return residual;
}

}  // namespace

/// The active rows once more from y_free: what the steps summed up loses digits.
void QpSolver::Work::solve_active(const QpVector& y_free, QpVector& y) {
  factor_active();
  const Eigen::Index k = static_cast<Eigen::Index>(active.size());
  QpVector gaps(k);
  for (Eigen::Index j = 0; j < k; ++j) {
    const int row = active[static_cast<std::size_t>(j)];
    gaps[j] = bounds[row] - rows.row(row).dot(y_free);
  }
  const auto R = active_qr.matrixQR().topRows(k).template triangularView<Eigen::Upper>();
  R.transpose().solveInPlace(gaps);
  y.setZero();
  y.head(k) = gaps;
  y.applyOnTheLeft(active_qr.householderQ());
  y += y_free;
  R.solveInPlace(gaps);
  std::copy(gaps.begin(), gaps.end(), z.begin());
}

void QpSolver::Work::factor_active() {
  QpMatrix columns(rows.cols(), static_cast<Eigen::Index>(active.size()));
  for (std::size_t j = 0; j < active.size(); ++j) {
    columns.col(static_cast<Eigen::Index>(j)) = rows.row(active[j]).transpose();
  }
  active_qr.compute(columns);
}

/// Steps to the point nearest to y_free that holds the active rows and `added`; active rows that do not bear there are
/// dropped on the way, as each one's multiplier reaches zero. False: there is no such point.
bool QpSolver::Work::add(int added, const QpVector& y_free, QpVector& y) {
  double z_added = 0.0;
  while (true) {
    const Eigen::Index k = static_cast<Eigen::Index>(active.size()), n = rows.cols();
    factor_active();
    QpVector direction = rows.row(added).transpose();  // split by Q: along the active rows, and across them
    direction.applyOnTheLeft(active_qr.householderQ().adjoint());
    QpVector change = direction.head(k);  // of the active rows' multipliers, negative, for one unit of the added one's
    active_qr.matrixQR().topRows(k).triangularView<Eigen::Upper>().solveInPlace(change);
    direction.head(k).setZero();
    const double curvature = direction.squaredNorm();
    const bool is_dependent = k == n || curvature <= kDependent * kDependent;
    direction.applyOnTheLeft(active_qr.householderQ());
    const double gap = bounds[added] - rows.row(added).dot(y);
    double step = is_dependent ? std::numeric_limits<double>::infinity() : gap / curvature;
    std::size_t dropped = active.size();
    for (std::size_t j = 0; j < active.size(); ++j) {
      const double slope = change[static_cast<Eigen::Index>(j)];
      if (!(slope > 0.0) || !(z[j] < step * slope)) continue;
      step = std::max(0.0, z[j] / slope);
      dropped = j;
    }
    if (!std::isfinite(step)) return false;
    z_added += step;
    if (!is_dependent) y += step * direction;
    for (std::size_t j = 0; j < active.size(); ++j) z[j] -= step * change[static_cast<Eigen::Index>(j)];
    if (dropped == active.size()) break;
    active.erase(active.begin() + static_cast<std::ptrdiff_t>(dropped));
    z.erase(z.begin() + static_cast<std::ptrdiff_t>(dropped));
  }
  active.push_back(added);
  z.push_back(z_added);
  solve_active(y_free, y);
  return y.allFinite();
}

QpSolver::Work::End QpSolver::Work::solve_dual(const QpProblem& problem, QpResult& result) {
  const Eigen::Index n = problem.g.size(), m = problem.b.size();
  result.multipliers.setZero(m);
  result.rounds = 0;
  active.clear();
  z.clear();
  if (!is_finite(problem)) return End::NotFinite;
  const Eigen::LLT<QpMatrix> cholesky(problem.H);
  const double largest = problem.H.diagonal().maxCoeff();
  if (cholesky.info() != Eigen::Success || !(largest > 0.0)) return End::NotConvex;
  const QpMatrix& L = cholesky.matrixLLT();  // its lower half
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!(L(i, i) > 1e-8 * std::sqrt(largest))) return End::NotConvex;
  }

  QpVector y_free = -problem.g;
  L.triangularView<Eigen::Lower>().solveInPlace(y_free);
  rows.resize(m, n);
  bounds.resize(m);
  lengths.resize(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    QpVector row = problem.A.row(i).transpose();
    const bool is_empty = row.isZero(0.0);
    if (is_empty && problem.b[i] > 0.0) return End::NoSolution;
    L.triangularView<Eigen::Lower>().solveInPlace(row);
    lengths[i] = is_empty ? 1.0 : row.norm();
    rows.row(i) = row.transpose() / lengths[i];
    bounds[i] = is_empty ? -std::numeric_limits<double>::infinity() : problem.b[i] / lengths[i];
  }

  QpVector y = y_free;
  const double reach = y_free.norm();
  bool is_solved = false;
  for (result.rounds = 0; result.rounds <= 4 * m; ++result.rounds) {
    Eigen::Index worst = -1;
    double worst_gap = 0.0;
    for (Eigen::Index i = 0; i < m; ++i) {
      if (!std::isfinite(bounds[i])) continue;
      const double gap = rows.row(i).dot(y) - bounds[i];
      if (gap < -kRowTolerance * (1.0 + std::abs(bounds[i]) + reach) && gap < worst_gap) {
        worst_gap = gap;
        worst = i;
      }
    }
    if (worst < 0) {
      is_solved = true;
      break;
    }
    // Violated although it is among those solved for: rounding. The residual will say whether it matters.
    if (std::ranges::find(active, static_cast<int>(worst)) != active.end()) {
      is_solved = true;
      break;
    }
    if (!add(static_cast<int>(worst), y_free, y)) return End::NoSolution;
  }
  if (!is_solved) return End::NoSolution;
  result.x = y;
  L.transpose().triangularView<Eigen::Upper>().solveInPlace(result.x);
  for (std::size_t j = 0; j < active.size(); ++j) {
    result.multipliers[active[j]] = std::max(0.0, z[j]) / lengths[active[j]];
  }
  return End::Solved;
}

/// min t with A x + |row| t >= b, t >= 0, the bounds scaled to one; plus the distance from the x before.
void QpSolver::Work::fill_phase_one(const QpProblem& problem, double scale) {
  const Eigen::Index n = problem.g.size();
  phase_one.reset(static_cast<int>(n) + 1);
  phase_one.H = kProximalWeight * QpMatrix::Identity(n + 1, n + 1);
  phase_one.g[n] = 1.0;
  Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMaxQpVariables> row(n + 1);
  for (Eigen::Index i = 0; i < problem.b.size(); ++i) {
    const double length = problem.A.row(i).norm();
    row.head(n) = problem.A.row(i) / (length > 0.0 ? length : 1.0);
    row[n] = 1.0;
    phase_one.add_row(row, length > 0.0 ? problem.b[i] / (length * scale) : -std::numeric_limits<double>::infinity());
  }
  row.setZero();
  row[n] = 1.0;
  phase_one.add_row(row, 0.0);
}

/// Proximal steps on that linear programme: they end at its solution after a few.
void QpSolver::Work::find_violation(const QpProblem& problem, QpResult& result) {
  const Eigen::Index n = problem.g.size(), m = problem.b.size();
  result.status = QpStatus::Failed;
  result.x.setZero(n);
  for (Eigen::Index i = 0; i < m; ++i) {
    if (problem.A.row(i).isZero(0.0) && problem.b[i] > 0.0) {  // 0 >= b
      result.status = QpStatus::Infeasible;
      result.worst_row = static_cast<int>(i);
      result.violation = problem.b[i];
      result.multipliers[i] = 1.0;
      return;
    }
  }
  if (n == kMaxQpVariables || m == kMaxQpRows) return;  // no room for one more
  double scale = 0.0;
  for (Eigen::Index i = 0; i < m; ++i) {
    const double length = problem.A.row(i).norm();
    if (length > 0.0 && std::isfinite(problem.b[i])) scale = std::max(scale, std::abs(problem.b[i]) / length);
  }
  if (!(scale > 0.0)) return;  // x = 0 would do
  fill_phase_one(problem, scale);
  double t = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kProximalSteps; ++i) {
    if (solve_dual(phase_one, phase_one_result) != End::Solved) return;
    const double gain = t - phase_one_result.x[n];
    t = phase_one_result.x[n];
    if (!(gain > 1e-3 * kInfeasible)) break;
    phase_one.g = -kProximalWeight * phase_one_result.x;
    phase_one.g[n] += 1.0;
  }
  if (!(t > kInfeasible)) return;
  result.status = QpStatus::Infeasible;
  result.x = scale * phase_one_result.x.head(n);
  result.multipliers = phase_one_result.multipliers.head(m);
  Eigen::Index worst = 0;
  result.multipliers.maxCoeff(&worst);
  for (Eigen::Index i = 0; i < m; ++i) {
    if (result.multipliers[i] > 0.0) result.multipliers[i] /= problem.A.row(i).norm();
  }
  result.worst_row = static_cast<int>(worst);
  result.violation = problem.b[worst] - problem.A.row(worst).dot(result.x);
}

QpSolver::QpSolver() : work_(std::make_unique<Work>()) {}
QpSolver::~QpSolver() = default;
QpSolver::QpSolver(QpSolver&&) noexcept = default;
QpSolver& QpSolver::operator=(QpSolver&&) noexcept = default;

void QpSolver::solve(const QpProblem& problem, QpResult& result) {
  SNUG_CHECK(problem.H.rows() == problem.g.size() && problem.H.cols() == problem.g.size(), "H and g do not fit");
  SNUG_CHECK(problem.A.rows() == problem.b.size() && problem.A.cols() == problem.g.size(), "A, b and g do not fit");
  result.worst_row = -1;
  result.violation = 0.0;
  result.residual = 0.0;
  const Work::End end = work_->solve_dual(problem, result);
  if (end == Work::End::NotFinite || end == Work::End::NotConvex) {
    result.x.setZero(problem.g.size());
    result.status = end == Work::End::NotFinite ? QpStatus::NotFinite : QpStatus::NotConvex;
    return;
  }
  if (end == Work::End::Solved) {
    result.residual = kkt_residual(problem, result);
    result.status = QpStatus::Solved;
    if (result.residual <= kResidualTolerance) return;
  }
  work_->find_violation(problem, result);
}

}  // namespace snug::numerics
