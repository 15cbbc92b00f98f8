// QpSolver: small dense convex quadratic programmes, and why one has no solution.
#pragma once

#include <Eigen/Core>
#include <memory>

namespace snug::numerics {

inline constexpr int kMaxQpVariables = 8;
inline constexpr int kMaxQpRows = 128;

using QpVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxQpVariables, 1>;
using QpMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxQpVariables, kMaxQpVariables>;
using QpRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMaxQpRows, kMaxQpVariables>;
using QpRowVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxQpRows, 1>;

/// minimise 1/2 x'H x + g'x subject to A x >= b. H symmetric positive definite. Rows may repeat, depend on each other
/// and be of any length; an entry of b that is minus infinity switches its row off.
struct QpProblem {
  QpMatrix H;
  QpVector g;
  QpRows A;
  QpRowVector b;

  /// All zero, without rows.
  void reset(int variables);
  /// Appends the row a'x >= bound.
  template <class Row>
  void add_row(const Eigen::MatrixBase<Row>& a, double bound) {
    const Eigen::Index i = grow();
    A.row(i) = a;
    b[i] = bound;
  }
  [[nodiscard]] int row_count() const { return static_cast<int>(b.size()); }

 private:
  Eigen::Index grow();
};

enum class QpStatus {
  Solved,
  Infeasible,  ///< no x fulfils all rows; `worst_row` and `violation` say how far from it
  NotFinite,   ///< a number of the problem is not one
  NotConvex,   ///< H is not positive definite (to rounding)
  Failed,      ///< the pivoting stopped without a solution that passes the check of its residual
};

struct QpResult {
  QpStatus status = QpStatus::Failed;
  QpVector x;               ///< Solved: the minimiser. Infeasible: where the largest violation is smallest
  QpRowVector multipliers;  ///< of the rows, >= 0. Infeasible: of the violated rows, they sum to a contradiction
  int rounds = 0;           ///< times that a violated row was added
  /// Largest of |H x + g - A'multipliers| / (1 + |g|), violation of a row / length of the row, and complementarity; the
  /// last two relative to 1 + |x| + |b|.
  double residual = 0.0;
  int worst_row = -1;      ///< Infeasible: the row with the largest part in the contradiction
  double violation = 0.0;  ///< Infeasible: b - A x of that row at `x`, in the unit of b
};

/// Dual active rows: starts from the unconstrained minimum, adds the row violated most, and solves the dual of the rows
/// added so far as a linear complementarity problem with a packaged pivoting method (docs/theory/controller.md). Holds
/// scratch memory only: results do not depend on what was solved before. One per thread.
class QpSolver {
 public:
  QpSolver();
  ~QpSolver();
  QpSolver(QpSolver&&) noexcept;
  QpSolver& operator=(QpSolver&&) noexcept;

  void solve(const QpProblem& problem, QpResult& result);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace snug::numerics
