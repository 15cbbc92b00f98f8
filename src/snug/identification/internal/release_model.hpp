// ReleaseModel: one recorded release beside its simulation, and the numbers that are looked for.
#pragma once

#include <string>
#include <vector>

#include "snug/identification/damping.hpp"
#include "snug/identification/free_swing.hpp"

namespace snug::identification::internal {

/// Which numbers are looked for, and where they stay when the data do not know them.
struct Unknowns {
  std::vector<Matrix6> damping;
  std::vector<Matrix6> stiffness;
  Eigen::VectorXd prior;  ///< damping first
  Eigen::VectorXd scale;
  std::vector<std::string> names, units;
};

[[nodiscard]] Unknowns make_unknowns(const DampingOptions& options, const Matrix6& K);

/// Sum of bases times numbers from `first` on.
[[nodiscard]] Matrix6 sum_of(const std::vector<Matrix6>& bases, const Eigen::VectorXd& theta, Eigen::Index first);

/// One release against its simulation.
class ReleaseModel {
 public:
  ReleaseModel(const Release& release, const Unknowns& unknowns, const DampingOptions& options, bool is_moving);

  [[nodiscard]] Eigen::Index own() const { return is_moving_ ? 12 : 6; }

  /// Rows after those of the samples: what is known of the start.
  [[nodiscard]] Eigen::Index more_rows() const { return release_.X_ES_start ? 6 : 0; }

  /// Six numbers a sample, in units of the noise: place in E, turn in S. `own`: body twist of S1 from the start as
  /// known (or the first measured pose) to the true one, in units of millimetre and milliradian, and first velocity of
  /// S1.
  void evaluate(const Eigen::VectorXd& theta, const Eigen::VectorXd& own, std::size_t samples, Eigen::VectorXd& r,
                Eigen::MatrixXd* J) const;

  [[nodiscard]] double position_noise() const { return position_; }
  [[nodiscard]] double rotation_noise() const { return rotation_; }

 private:
  static constexpr double kOwnScale = 1e-3;
  static constexpr double kKnownBetter = 20.0;  // a start held for a second at 360 Hz: the mean of 400 samples

  const Release& release_;
  const Unknowns& unknowns_;
  bool is_moving_;
  FreeSwing swing_;
  Matrix6 coupling_;
  SwingDirections directions_;
  Matrix6 to_S_;
  double position_ = 1.0, rotation_ = 1.0;
};

}  // namespace snug::identification::internal
