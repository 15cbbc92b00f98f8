// Scene: questions about a belief: where a box lies, what stands over it, what the container holds.
#pragma once

#include <optional>
#include <vector>

#include "snug/cell/item_event_log.hpp"
#include "snug/planning/belief_snapshot.hpp"
#include "snug/planning/reach.hpp"
#include "snug/skills/item_plan.hpp"

namespace snug::planning {

/// Where a box is that is to be picked.
enum class Location {
  Aligner,    ///< against its plates
  Bench,      ///< on the flat surface where boxes are turned
  Container,  ///< in the container or on its rim
  Elsewhere,  ///< somewhere the tool may reach
};
[[nodiscard]] const char* name_of(Location location);

/// What follows from a scenario and how it is driven alone.
struct CellPlan {
  skills::CellLayout layout;
  ToolReach reaches;
  settings::PlaceLimits limits;  ///< of the motions that are done: exactly tracked or not
};
/// Throws InputError for a scenario that cannot be packed, and where its robot's file cannot be read.
[[nodiscard]] CellPlan make_cell_plan(const model::Scenario& scenario, const motion::Tracking& tracking);

/// A view: it must not outlive what it is made of. Boxes that are asked for are in the cell where nothing else is said.
struct Scene {
  const BeliefSnapshot& belief;
  const CellPlan& cell;

  [[nodiscard]] const model::Scenario& rules() const { return belief.scenario; }
  [[nodiscard]] const model::Sequence& sequence() const;
  [[nodiscard]] const std::optional<BelievedBox>& box(model::ItemIndex item) const { return belief.boxes[item.slot()]; }
  [[nodiscard]] const Pose& X_WP(model::ItemIndex item) const { return box(item)->X_WP; }
  [[nodiscard]] std::vector<std::optional<Pose>> believed_poses() const;
  [[nodiscard]] skills::PlannedBox planned_box(model::ItemIndex item) const;
  /// X_WP, before it is seen.
  [[nodiscard]] Pose arrival_of(model::ItemIndex item) const;

  /// What is believed to be in the container; `without`: of all items but this one.
  [[nodiscard]] packing::ContainerState container_state(model::ItemIndex without = {}) const;
  /// How it stands now, as agents count.
  [[nodiscard]] packing::Item item_as_it_stands(model::ItemIndex item) const;
  [[nodiscard]] Location locate(model::ItemIndex item) const;
  [[nodiscard]] cell::ContainerFit fit_of(model::ItemIndex item) const;
  /// It is seen over the rim, beyond a wall, or not in the container at all. Of a box that is gone: false.
  [[nodiscard]] bool is_seen_outside(model::ItemIndex item) const;
  /// The same, or it is seen over the rim by more than a box of a finished load may stand.
  [[nodiscard]] bool is_seen_sticking_out(model::ItemIndex item) const;
  /// An obstacle lies on the box: it is neither picked nor pressed on.
  [[nodiscard]] bool is_under_obstacle(model::ItemIndex item) const;
  /// Another box stands on it: the tool would have to go through that one.
  [[nodiscard]] bool is_under_box(model::ItemIndex item) const;
  /// It stands on a face, nothing stands on it, and the tool reaches it.
  [[nodiscard]] bool can_be_picked(model::ItemIndex item) const;
  /// m, over the inner floor of the container: the highest point of all obstacles and of all boxes but one, those that
  /// were left outside too: what is carried passes over it.
  [[nodiscard]] double packed_top(model::ItemIndex without = {}) const;
  /// m, z in W below which nothing passes that crosses the cell.
  [[nodiscard]] double travel_bottom(model::ItemIndex without = {}) const;
  /// rad, from standing on a face in the container, turned about the vertical as it may be.
  [[nodiscard]] double tilt_of(model::ItemIndex item) const;
  /// m, the largest difference of the edges from what the scenario says of the item.
  [[nodiscard]] double size_error(model::ItemIndex item) const;

 private:
  [[nodiscard]] std::vector<packing::Extent> obstacle_extents() const;
};

/// How a box that lies, leans or hangs is put down to the aligner or on the bench: on the face that is nearest to
/// below.
[[nodiscard]] Matrix3 rotation_at_aligner(const Scene& scene, model::ItemIndex item);
/// In T, from W: the level box around.
[[nodiscard]] geometry::Aabb in_container(const Pose& X_WT, const geometry::Aabb& region);
/// Two standard deviations of where the box was seen, m.
[[nodiscard]] double slack_of(const BelievedBox& box);
/// Standing on one of its faces, or leaning by at most `max_lean` [rad], so that it can be picked from above.
[[nodiscard]] bool is_upright(const Matrix3& R_WP, double max_lean);

}  // namespace snug::planning
