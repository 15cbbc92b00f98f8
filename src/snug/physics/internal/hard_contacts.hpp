// Hard contacts: the few contacts of an island that Newton's method does not settle, solved with the rest condensed.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "snug/physics/internal/contact_row.hpp"

namespace snug::physics::internal {

/// A dense contact problem: relative velocities xi = xi_0 + W lambda of a few contacts, W with what all other contacts
/// answer. docs/theory/contact.md, section 4.
class HardContacts {
 public:
  static constexpr int kMaxContacts = 32;
  static constexpr int kMaxSize = 3 * kMaxContacts;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxSize, kMaxSize>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxSize, 1>;

  std::vector<Row*> rows;  ///< their lambda is where it starts
  Matrix W;
  Vector xi_0;
  Vector lambda;  ///< the answer, N s

  HardContacts();
  /// Solves the law of all rows to `tolerance`, m/s, or as well as it can. Returns whether it did.
  bool solve(double tolerance);

 private:
  [[nodiscard]] double residual_of(const Vector& impulses) const;
  double evaluate(double penalty);
  bool solve_stage(double penalty, double tolerance, int& iterations);

  Vector xi_, error_, start_, center_, law_;
  Matrix system_;
  std::vector<double> mobility_n_, mobility_t_;  ///< (m/s)/(N s), of each contact on the diagonal of W
  std::vector<AugmentedLaw> laws_;
};

}  // namespace snug::physics::internal
