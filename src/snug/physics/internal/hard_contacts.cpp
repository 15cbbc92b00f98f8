// Hard contacts: the few contacts of an island that Newton's method does not settle, solved with the rest condensed.
#include "snug/physics/internal/hard_contacts.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace snug::physics::internal {
namespace {

constexpr double kFirstPenalty = 30.0;
constexpr double kLeastPenalty = 0.1;
constexpr double kLargestPenalty = 1e8;
constexpr double kGrowth = 3.0;
constexpr int kMaxIterations = 80;  ///< in all; what is solved at all takes 20 on average
constexpr int kMaxStageIterations = 25;
constexpr int kMaxHalvings = 8;

using Block3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Index at(std::size_t contact) { return 3 * static_cast<Eigen::Index>(contact); }

}  // namespace

HardContacts::HardContacts() {
  rows.reserve(kMaxContacts);
  mobility_n_.resize(kMaxContacts);
  mobility_t_.resize(kMaxContacts);
  laws_.resize(kMaxContacts);
}

double HardContacts::residual_of(const Vector& impulses) const {
  const Vector xi = xi_0 + W * impulses;
  double worst = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double* x = xi.data() + at(i);
    worst = std::max(worst, natural_map(*rows[i], {x[0], x[1], x[2]}, impulses.data() + at(i)));
  }
  return worst;
}

/// Error xi - xi_0 - W lambda(xi) of the augmented law at xi_; returns its norm.
double HardContacts::evaluate(double penalty) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double* x = xi_.data() + at(i);
    augmented_law(*rows[i], penalty / mobility_n_[i], penalty / mobility_t_[i], center_.data() + at(i),
                  {x[0], x[1], x[2]}, laws_[i]);
    for (int k = 0; k < 3; ++k) law_[at(i) + k] = laws_[i].lambda[k];
  }
  error_ = xi_ - xi_0;
  error_.noalias() -= W * law_;
  return error_.norm();
}

bool HardContacts::solve_stage(double penalty, double tolerance, int& iterations) {
  const Eigen::Index size = at(rows.size());
  double error = evaluate(penalty);
  for (int iteration = 0; iteration < kMaxStageIterations; ++iteration) {
    if (error <= tolerance) return true;
    ++iterations;
    system_.setIdentity(size, size);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (laws_[i].lambda[0] <= 0.0) continue;
      const Eigen::Map<const Block3> slope(laws_[i].slope);
      system_.middleCols<3>(at(i)).noalias() += W.middleCols<3>(at(i)) * slope;
    }
    const Vector step = Eigen::PartialPivLU<Matrix>(system_).solve(error_);
    start_ = xi_;
    double length = 1.0, next = 0.0;
    bool is_less = false;
    for (int halving = 0; halving < kMaxHalvings && !is_less; ++halving, length *= 0.5) {
      xi_ = start_ - length * step;
      next = evaluate(penalty);
      is_less = next < (1.0 - 1e-4 * length) * error;
    }
    if (!is_less) return false;
    error = next;
  }
  return error <= tolerance;
}

bool HardContacts::solve(double tolerance) {
  const Eigen::Index size = at(rows.size());
  lambda.resize(size);
  law_.resize(size);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (int k = 0; k < 3; ++k) lambda[at(i) + k] = rows[i]->lambda[k];
    // The rest may hold a contact all but still: the penalty stays within reach of that of the contact alone.
    constexpr double kLeast = 1e-6;
    const double n = W(at(i), at(i)), t = std::max(W(at(i) + 1, at(i) + 1), W(at(i) + 2, at(i) + 2));
    mobility_n_[i] = std::max(n, kLeast * rows[i]->W[0]);
    mobility_t_[i] = std::max(t, kLeast / rows[i]->step_t);
  }
  double penalty = kFirstPenalty, residual = residual_of(lambda), best = residual;
  Vector best_lambda = lambda;
  for (int iterations = 0; iterations < kMaxIterations && penalty > kLeastPenalty && best > tolerance; ++iterations) {
    center_ = lambda;
    xi_ = xi_0 + W * lambda;
    if (!solve_stage(penalty, std::min(0.1 * tolerance, 0.01 * residual), iterations)) {
      penalty /= kGrowth;
      continue;
    }
    lambda = law_;
    residual = residual_of(lambda);
    penalty = std::min(kLargestPenalty, penalty * kGrowth);
    if (residual >= best) continue;
    best = residual;
    best_lambda = lambda;
  }
  lambda = best_lambda;
  return best <= tolerance;
}

}  // namespace snug::physics::internal
