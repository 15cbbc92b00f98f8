// ObstacleMemory: what is believed to be in the container that is no box of the session, from look to look.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "snug/perception/observation.hpp"

namespace snug::session {

/// A box where it is believed to be: points on it are no obstacle.
struct Solid {
  Pose X_WP;
  Vector3 size = Vector3::Zero();  ///< m
};

/// One that was seen, for people and files.
struct ObstacleReport {
  int number = 1;                                             ///< from 1, in the order in which they were first seen
  double seen = 0.0;                                          ///< s, of the plant, at first
  std::optional<double> gone;                                 ///< s: its place was seen and is empty
  Vector3 low_T = Vector3::Zero(), high_T = Vector3::Zero();  ///< m, as it was seen last, without its uncertainty
};

/// "seen from (12, -40) to (98, 25) mm of the container, up to 61 mm over its floor"
[[nodiscard]] std::string describe(const ObstacleReport& report);

class ObstacleMemory {
 public:
  struct Believed {
    int number = 1;
    std::vector<perception::Column> columns;
    double deviation = 0.0;  ///< m
    std::size_t whole = 0;   ///< columns when it was seen last
  };
  /// `X_WT`: the container. Obstacles stand on its floor.
  explicit ObstacleMemory(const Pose& X_WT) : X_WT_(X_WT) {}

  /// What a look has of obstacles: without columns that lie in one of `boxes` or within 10 mm of it, or less than that
  /// over the floor, and without what is too small then. Empty as well where the look does not tell.
  [[nodiscard]] std::vector<perception::Obstacle> find_foreign(const perception::Observation& look,
                                                               std::span<const Solid> boxes) const;
  /// One of them is neither believed in nor among `others`.
  [[nodiscard]] bool has_news(const std::vector<perception::Obstacle>& foreign,
                              const std::vector<perception::Obstacle>& others = {}) const;
  /// Takes over what a look tells: `foreign`, those that count. Columns that are not seen now are forgotten where what
  /// is behind them is seen, where a box is believed to be, and all of them after a look that sees everything.
  void see(const perception::Observation& look, const std::vector<perception::Obstacle>& foreign,
           std::span<const Solid> boxes);

  [[nodiscard]] const std::vector<Believed>& obstacles() const { return obstacles_; }
  [[nodiscard]] const std::vector<ObstacleReport>& reports() const { return reports_; }
  /// A few level boxes in W that cover all of them from the floor up, grown by two standard deviations.
  [[nodiscard]] std::vector<geometry::Aabb> regions() const;

 private:
  [[nodiscard]] bool is_believed(const perception::Obstacle& one) const;
  void note(const Believed& one, double time);

  Pose X_WT_;
  int count_ = 0;
  std::vector<Believed> obstacles_;
  std::vector<ObstacleReport> reports_;
};

/// Regions as bodies that fixed things are made of: cut back where they would reach into a box beside them, and lifted
/// off boxes under them, so that boxes that stand there are not pushed away.
[[nodiscard]] std::vector<geometry::Aabb> clear_of(std::vector<geometry::Aabb> regions, std::span<const Solid> boxes);

}  // namespace snug::session
