// SensorZero: what a sensor reads without a load, constant or drifting from row to row of a file.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <vector>

namespace snug::identification::internal {

/// In units of the reading's standard deviation: straight between knots; the differences of neighbouring knots are
/// kept small. Constant: one knot.
class SensorZero {
 public:
  /// Of a file's rows, from those with is_used[i].
  SensorZero(const std::vector<bool>& is_used, bool drifts);

  [[nodiscard]] Eigen::Index knots() const { return knots_; }
  [[nodiscard]] bool is_used(std::size_t row) const { return is_used_[row]; }
  [[nodiscard]] std::size_t rows() const { return is_used_.size(); }
  /// What `knots` say at a row.
  [[nodiscard]] double at(std::size_t row, const Eigen::VectorXd& knots) const;
  /// Adds `value` to the knots beside a row, by their weights.
  template <class Row>
  void add(std::size_t row, const Row& value, Eigen::MatrixXd& to_knots) const;
  /// Solves for the knots.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& at_knots) const { return normal_.solve(at_knots); }

 private:
  struct Place {
    Eigen::Index knot = 0;  ///< and the one after it
    double after = 0.0;     ///< weight of that
  };
  [[nodiscard]] Place place_of(std::size_t row) const;

  std::vector<bool> is_used_;
  Eigen::Index knots_ = 1;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> normal_;
};

template <class Row>
void SensorZero::add(std::size_t row, const Row& value, Eigen::MatrixXd& to_knots) const {
  const Place place = place_of(row);
  to_knots.row(place.knot) += (1.0 - place.after) * value;
  if (place.after > 0.0) to_knots.row(place.knot + 1) += place.after * value;
}

/// Least squares of one component's readings on `Columns` columns and the zero, which is eliminated.
template <int Columns>
struct ZeroedSums {
  using Square = Eigen::Matrix<double, Columns, Columns>;
  using Vector = Eigen::Matrix<double, Columns, 1>;
  Square A = Square::Zero();
  Vector b = Vector::Zero();
  double squares = 0.0;
  Eigen::MatrixXd G, g;  // of the knots

  explicit ZeroedSums(const SensorZero& zero)
      : G(Eigen::MatrixXd::Zero(zero.knots(), Columns)), g(Eigen::MatrixXd::Zero(zero.knots(), 1)) {}
  template <class Row>
  void add(const SensorZero& zero, std::size_t row, const Row& columns, double reading) {
    A.noalias() += columns.transpose() * columns;
    b.noalias() += columns.transpose() * reading;
    squares += reading * reading;
    zero.add(row, columns, G);
    zero.add(row, Eigen::Matrix<double, 1, 1>(reading), g);
  }
  void eliminate(const SensorZero& zero) {
    const Eigen::MatrixXd of_g = zero.solve(g);
    A -= G.transpose() * zero.solve(G);
    b -= G.transpose() * of_g.col(0);
    squares -= g.col(0).dot(of_g.col(0));
  }
  /// The knots that go with these coefficients.
  [[nodiscard]] Eigen::VectorXd find_knots(const SensorZero& zero, const Vector& coefficients) const {
    return zero.solve(g - G * coefficients);
  }
};

/// A x = b in scaled columns; a ridge of 1e-9 keeps at zero what the rows do not know.
template <int Columns>
[[nodiscard]] Eigen::Matrix<double, Columns, 1> solve_ridged(const Eigen::Matrix<double, Columns, Columns>& A,
                                                             const Eigen::Matrix<double, Columns, 1>& b) {
  using Square = Eigen::Matrix<double, Columns, Columns>;
  const Eigen::Matrix<double, Columns, 1> size = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Square kept = size.asDiagonal() * A * size.asDiagonal() + 1e-9 * Square::Identity();
  return size.asDiagonal() * kept.ldlt().solve(size.asDiagonal() * b);
}

}  // namespace snug::identification::internal
