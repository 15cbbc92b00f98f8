// PlaceTask: what packing needs of the place of a robot and an aligner, by lengths and heights.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/runs/cell_place.hpp"
#include "snug/runs/internal/footprint.hpp"

namespace snug::runs::internal {

/// The corner of the aligner in which boxes stand.
struct CornerPlace {
  Eigen::Vector2d p_W = Eigen::Vector2d::Zero();  ///< m
  double yaw = 0.0;                               ///< rad
  [[nodiscard]] Eigen::Vector2d at(const Vector3& p_A) const {
    return p_W + Eigen::Rotation2Dd(yaw) * Eigen::Vector2d(p_A.head<2>());
  }
};

/// The tool with the pose over it from which it comes there.
struct NeededPose {
  Pose X_WE, X_WE_over;
  std::string what;
};

struct PlaceTask {
  Pose X_WT;                            ///< of the container
  Footprint container;                  ///< outside
  std::vector<Eigen::Vector2d> points;  ///< m, in W: of the container, where boxes can stand
  std::array<double, 4>
      heights{};  ///< m, of E over the container's floor: layer_heights, the last as far over the rim as motions keep
  std::vector<Vector3> picks_A;     ///< m, middle of the upper face of each item, in the aligner
  Eigen::Vector2d stand;            ///< m, what boxes take up from the aligner's corner
  double lowest_pick = 0.0;         ///< m, of E over the aligner's support
  double highest_pick = 0.0;        ///< m, the same, from where the highest box is approached
  double pick_length = 0.0;         ///< m, E over the lip that picks
  double tool_yaw = 0.0;            ///< rad, at its start
  std::vector<Footprint> carrying;  ///< faces on which boxes can stand at the aligner
  std::vector<Footprint> blocking;  ///< static bodies that rise above them, other than those that move

  [[nodiscard]] Footprint outline_of(const CornerPlace& corner) const;
  /// Middle of all picks, m.
  [[nodiscard]] Eigen::Vector2d pick_middle(const CornerPlace& corner) const;
  /// Nothing stands there, and something carries the boxes where anything does anywhere.
  [[nodiscard]] bool is_free(const CornerPlace& corner) const;
};

/// m, kept free between container, aligner and base.
inline constexpr double kFreeBetween = 0.06;
/// m, of the foot of a robot.
inline constexpr double kHalfFoot = 0.1;
/// m, from where a pick is approached.
inline constexpr double kOverPick = 0.15;

/// Throws InputError for what place_cell needs and the scenario lacks.
[[nodiscard]] PlaceTask make_place_task(const model::Scenario& scenario, const PlaceOptions& options);

/// In the scenario as it is.
[[nodiscard]] std::vector<NeededPose> find_needed(const model::Scenario& scenario, const PlaceTask& task);

}  // namespace snug::runs::internal
