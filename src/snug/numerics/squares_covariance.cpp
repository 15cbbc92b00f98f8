// shared_information, shared_step, squares_covariance: how well least squares of simulations know their shared
// unknowns.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "snug/numerics/batched_least_squares.hpp"
#include "snug/numerics/dense.hpp"

namespace snug::numerics {
namespace {

/// The sum of squares around the start of a problem, along the axes of its inverse information.
class RisingSquares {
 public:
  RisingSquares(const BatchedProblem& at, const BatchedDerivatives& found) : at_(at), found_(found) {
    for (const Eigen::MatrixXd& J : found_.jacobians) {
      const auto own = J.rightCols(std::max<Eigen::Index>(0, J.cols() - at.start.size()));
      own_normal_.push_back(own.transpose() * own);
    }
    const auto steps = at.step.asDiagonal();
    const Eigen::MatrixXd information = steps * shared_information(found_, at.start.size()) * steps;
    const Eigenpairs axes = symmetric_eigenpairs(invert_symmetric(information));
    directions_ = steps * axes.vectors;
    deviation_ = axes.values.cwiseMax(0.0).cwiseSqrt();
  }

  [[nodiscard]] const Eigen::MatrixXd& directions() const { return directions_; }  ///< columns
  [[nodiscard]] const Eigen::VectorXd& deviation() const { return deviation_; }    ///< along each of them

  struct Rise {
    double found = 0.0;   ///< of the sum of squares
    double square = 0.0;  ///< of the way, in deviations
  };
  /// At these lengths along some of the axes, there and back: 2 i and 2 i + 1 are those of axis along[i].
  [[nodiscard]] std::vector<Rise> rises(const std::vector<Eigen::Index>& along, const Eigen::VectorXd& length) const {
    std::vector<Rise> result;
    std::vector<BatchedProblem::Job> jobs;
    for (const Eigen::Index k : along) {
      for (const double sign : {1.0, -1.0}) {
        const Eigen::VectorXd way = sign * length[k] * directions_.col(k);
        const Eigen::VectorXd there = (at_.start + way).cwiseMax(at_.lower).cwiseMin(at_.upper);
        const double share = (there - at_.start).cwiseQuotient(at_.step).norm() / way.cwiseQuotient(at_.step).norm();
        result.push_back({0.0, std::pow(length[k] / deviation_[k] * share, 2)});
        for (std::size_t i = 0; i < at_.terms.size(); ++i) jobs.push_back({i, there, found_.own[i]});
      }
    }
    const std::vector<Eigen::VectorXd> residuals = at_.evaluate(jobs);
    for (std::size_t j = 0; j < jobs.size(); ++j) {
      const std::size_t i = jobs[j].term;
      if (residuals[j].size() == found_.residuals[i].size())
        result[j / at_.terms.size()].found += squares(i, residuals[j]) - squares(i, found_.residuals[i]);
    }
    return result;
  }

 private:
  /// Of the residuals of a term, less what its own unknowns can take of them.
  [[nodiscard]] double squares(std::size_t term, const Eigen::VectorXd& r) const {
    const Eigen::MatrixXd& normal = own_normal_[term];
    if (normal.size() == 0) return r.squaredNorm();
    const Eigen::VectorXd slope = found_.jacobians[term].rightCols(normal.cols()).transpose() * r;
    return r.squaredNorm() - slope.dot(solve_symmetric(normal, slope).col(0));
  }

  const BatchedProblem& at_;
  const BatchedDerivatives& found_;
  std::vector<Eigen::MatrixXd> own_normal_;  ///< J^T J of each term's own unknowns
  Eigen::MatrixXd directions_;
  Eigen::VectorXd deviation_;
};

}  // namespace

Eigen::MatrixXd shared_information(const BatchedDerivatives& at, Eigen::Index n) {
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::MatrixXd& R : at.reduced) {
    if (R.cols() <= n) continue;
    Eigen::MatrixXd shared = R.leftCols(n);
    const Eigen::Index count = R.cols() - 1 - n;
    if (count > 0) {
      const Eigen::MatrixXd own = R.middleCols(n, count);
      shared -= own * solve_by_qr(own, shared);
    }
    information += shared.transpose() * shared;
  }
  return information;
}

Eigen::VectorXd shared_step(const BatchedDerivatives& at, const std::vector<Eigen::VectorXd>& changes, Eigen::Index n) {
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(n);
  for (std::size_t i = 0; i < at.jacobians.size(); ++i) {
    const Eigen::MatrixXd& J = at.jacobians[i];
    if (J.cols() < n || changes[i].size() != J.rows()) continue;
    Eigen::MatrixXd shared = J.leftCols(n);
    if (J.cols() > n) {
      const Eigen::MatrixXd own = J.rightCols(J.cols() - n);
      shared -= own * solve_by_qr(own, shared);
    }
    slope += shared.transpose() * changes[i];
  }
  return -solve_symmetric(shared_information(at, n), slope).col(0);
}

Eigen::MatrixXd squares_covariance(const BatchedProblem& at, const BatchedDerivatives& found, double excess) {
  // At two deviations along each axis the sum of squares has to have risen by four. Where it rises by less than half of
  // that the axis is longer, and is looked at again from there. What it strays from its parabola (root mean square q
  // over axes and sides; of a cliff a hundred) it strays at its minimum, too: a point as good by chance is anywhere
  // within sqrt(q) deviations, q/3 of variance.
  constexpr int kRounds = 6;
  constexpr double kMost = 4.0;     // times as far as in the round before
  constexpr double kRough = 8.0;    // times as far, by what all axes stray alone: looked at again, too
  constexpr double kLeast = 0.01;   // of the steps of differences, to start from: nothing nearer was looked at
  constexpr double kCliff = 100.0;  // ten deviations: no chance makes such a point as good
  constexpr double kMostExcess = 400.0;
  const RisingSquares squares(at, found);
  const Eigen::VectorXd first = squares.deviation();
  const auto n = first.size();
  Eigen::VectorXd length = first.cwiseMax(kLeast), share = Eigen::VectorXd::Ones(n), deviation = first,
                  strayed = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> open(static_cast<std::size_t>(n));
  std::iota(open.begin(), open.end(), Eigen::Index{0});
  for (int round = 0; round < kRounds && !open.empty(); ++round) {
    const std::vector<RisingSquares::Rise> rises = squares.rises(open, 2.0 * length);
    for (std::size_t i = 0; i < open.size(); ++i) {
      const Eigen::Index k = open[i];
      const auto &there = rises[2 * i], &back = rises[2 * i + 1];
      const double of_parabola = (there.found + back.found) / std::max(there.square + back.square, 1e-12);
      share[k] = of_parabola < 0.5 ? std::max(of_parabola, std::pow(first[k] / (kMost * length[k]), 2)) : 1.0;
      strayed[k] = 0.0;
      for (const RisingSquares::Rise& rise : {there, back})
        strayed[k] += std::pow(std::min(std::abs(rise.found - share[k] * rise.square), kCliff), 2);
    }
    const double q = std::sqrt(strayed.sum() / static_cast<double>(2 * n));
    double wander = q / 3.0;
    if (q > 1.0) wander += std::clamp(excess, 0.0, kMostExcess);  // a rough sum has several local minima
    deviation = first.cwiseProduct(((1.0 + wander) * share.cwiseInverse()).cwiseSqrt());
    open.clear();
    for (Eigen::Index k = 0; k < n; ++k)
      if (deviation[k] > (share[k] < 1.0 ? 2.0 : kRough) * length[k]) open.push_back(k);
    for (const Eigen::Index k : open) length[k] = std::min(deviation[k], kMost * length[k]);
  }
  return squares.directions() * deviation.cwiseAbs2().asDiagonal() * squares.directions().transpose();
}

}  // namespace snug::numerics
