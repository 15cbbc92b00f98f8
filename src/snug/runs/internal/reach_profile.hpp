// ReachProfile: where an arm can hold its tool pointing down, by distance and height from its first axis.
#pragma once

#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/robot/arm.hpp"

namespace snug::runs::internal {

/// Of the arm by itself: nothing else stands there. What an arm with a vertical first axis reaches does not depend on
/// the direction, as far as that axis turns.
class ReachProfile {
 public:
  /// Heights `lowest` to `highest`: m, of E over the root link. Throws InputError where the first axis is not vertical.
  ReachProfile(const model::Scenario& scenario, double lowest, double highest, int threads);

  /// m, how far E can be moved in distance or height before the arm does not reach there; below 0: it does not there.
  [[nodiscard]] double depth(double distance, double height) const;
  /// m, of E from the axis, at most.
  [[nodiscard]] double reach() const { return reach_; }
  /// m, of the first axis in the root link: x and y.
  [[nodiscard]] const Eigen::Vector2d& axis() const { return p_BA_; }
  /// rad, about the root link's z: the direction in which the first joint is half way between its limits.
  [[nodiscard]] double middle() const { return middle_; }
  /// rad, to either side of it.
  [[nodiscard]] double half_turn() const { return half_turn_; }

 private:
  void measure_depths(const std::vector<char>& flags);
  [[nodiscard]] double node(int column, int row) const {
    return depth_[static_cast<std::size_t>(row * columns_ + column)];
  }

  Eigen::Vector2d p_BA_ = Eigen::Vector2d::Zero();
  double middle_ = 0.0, half_turn_ = 0.0, reach_ = 0.0;
  double step_ = 0.0, lowest_ = 0.0;
  int columns_ = 0, rows_ = 0;
  std::vector<double> depth_;  ///< row by row, from below
};

}  // namespace snug::runs::internal
