// Scene: questions about a belief: where a box lies, what stands over it, what the container holds.
#include "snug/planning/scene.hpp"

#include <algorithm>
#include <cmath>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/cell/joint_pace.hpp"
#include "snug/packing/load_check.hpp"
#include "snug/skills/primitives.hpp"

namespace snug::planning {

geometry::Aabb in_container(const Pose& X_WT, const geometry::Aabb& region) {
  const Vector3 middle = X_WT.inverse() * (0.5 * (region.lower + region.upper));
  const Vector3 half = X_WT.R.cwiseAbs().transpose() * (0.5 * (region.upper - region.lower));
  return {middle - half, middle + half};
}

const char* name_of(Location location) {
  switch (location) {
    case Location::Aligner:
      return "aligner";
    case Location::Bench:
      return "bench";
    case Location::Container:
      return "container";
    case Location::Elsewhere:
      return "elsewhere";
  }
  return "";
}

CellPlan make_cell_plan(const model::Scenario& scenario, const motion::Tracking& tracking) {
  CellPlan cell{skills::make_layout(scenario, cell::find_pan_axis(scenario)), make_tool_reach(scenario),
                scenario.place_limits};
  cell.layout.is_fast = motion::is_fast(tracking);
  if (!cell.layout.is_fast) cell.limits.hold_factor = cell.limits.hold_guard = 0.0;
  return cell;
}

Matrix3 rotation_at_aligner(const Scene& scene, model::ItemIndex item) {
  const Matrix3& R_WA = scene.rules().aligner->X_WA.R;
  const Matrix3& R_WP = scene.X_WP(item).R;
  return R_WA * packing::rotation(packing::nearest_orientation(R_WA.transpose() * skills::leveling(R_WP) * R_WP));
}

double slack_of(const BelievedBox& box) { return 2.0 * std::sqrt(std::max(0.0, box.covariance(0, 0))); }

bool is_upright(const Matrix3& R_WP, double max_lean) { return R_WP.row(2).cwiseAbs().maxCoeff() > std::cos(max_lean); }

const model::Sequence& Scene::sequence() const { return *model::find_sequence(belief.nominal(), belief.sequence); }

std::vector<std::optional<Pose>> Scene::believed_poses() const {
  std::vector<std::optional<Pose>> poses;
  for (const std::optional<BelievedBox>& one : belief.boxes) {
    poses.push_back(one ? std::optional<Pose>(one->X_WP) : std::nullopt);
  }
  return poses;
}

skills::PlannedBox Scene::planned_box(model::ItemIndex item) const {
  return skills::make_planned_box(belief.nominal(), sequence(), item);
}

Pose Scene::arrival_of(model::ItemIndex item) const {
  return cell::arrival_pose(belief.nominal(), sequence().items[item.slot()]);
}

packing::ContainerState Scene::container_state(model::ItemIndex without) const {
  packing::ContainerState state = packing::make_container_state(*model::find_container(rules(), rules().target));
  const Pose X_TW = cell.layout.X_WT.inverse();
  const Vector3 half = 0.5 * state.inner_size + Vector3::Constant(rules().recovery.footprint);
  for (const model::ItemIndex item : belief.sent) {
    if (!box(item) || item == without) continue;
    const Pose X_TP = X_TW * X_WP(item);
    if (std::abs(X_TP.p.x()) > half.x() || std::abs(X_TP.p.y()) > half.y() || X_TP.p.z() < 0.0) continue;
    state.boxes.push_back({belief.items[item.slot()], X_TP});
  }
  state.obstacles = obstacle_extents();
  for (const model::ItemIndex item : belief.skipped) state.skipped.push_back(belief.items[item.slot()].id);
  state.skips_left = std::max(0, belief.skips_left);
  return state;
}

std::vector<packing::Extent> Scene::obstacle_extents() const {
  std::vector<packing::Extent> extents;
  for (const geometry::Aabb& region : belief.obstacles) {
    const geometry::Aabb in_T = in_container(cell.layout.X_WT, region);
    extents.push_back({in_T.lower, in_T.upper});
  }
  return extents;
}

packing::Item Scene::item_as_it_stands(model::ItemIndex item) const {
  packing::Item one = belief.items[item.slot()];
  const Matrix3& R = locate(item) == Location::Aligner ? rules().aligner->X_WA.R : cell.layout.X_WT.R;
  one.arrival = packing::nearest_orientation(R.transpose() * X_WP(item).R);
  return one;
}

Location Scene::locate(model::ItemIndex item) const {
  const settings::RecoverySettings& recovery = rules().recovery;
  const Pose& X = X_WP(item);
  const Vector3 size = planned_box(item).size;
  const Pose X_AW = rules().aligner->X_WA.inverse();
  const auto corner_at_plates = [&](const Pose& X_WB) {  // of its extents, whatever face it stands on
    const Pose X_AB = X_AW * X_WB;
    return Vector3(X_AB.p - 0.5 * (X_AB.R.cwiseAbs() * size));
  };
  const double off = (corner_at_plates(X) - corner_at_plates(arrival_of(item))).norm();
  if (off < recovery.at_aligner && is_upright(X.R, rules().skills.pick.max_lean)) return Location::Aligner;
  const Vector3 p_TP = cell.layout.X_WT.inverse() * X.p;
  const Vector3 half = 0.5 * model::find_container(rules(), rules().target)->inner_size;
  if (std::abs(p_TP.x()) < half.x() + recovery.footprint && std::abs(p_TP.y()) < half.y() + recovery.footprint) {
    return Location::Container;
  }
  if (cell.layout.flip_place) {
    const Vector3 p_FP = X.p - cell.layout.flip_place->p_WF;
    const double bottom = p_FP.z() + skills::lowest_corner(X.R, size);
    if (p_FP.head<2>().norm() < recovery.on_bench && std::abs(bottom) < recovery.on_surface) return Location::Bench;
  }
  return Location::Elsewhere;
}

cell::ContainerFit Scene::fit_of(model::ItemIndex item) const {
  const Vector3 inner = model::find_container(rules(), rules().target)->inner_size;
  return cell::fit_in(inner, planned_box(item).size, cell.layout.X_WT.inverse() * X_WP(item));
}

bool Scene::is_seen_outside(model::ItemIndex item) const {
  if (!box(item) || !box(item)->was_seen) return false;
  const double slack = slack_of(*box(item));
  const cell::ContainerFit fit = fit_of(item);
  return locate(item) != Location::Container || fit.outside > cell::kPackedBeyondWall + slack ||
         fit.above_rim > cell::kPackedAboveRim + slack;
}

bool Scene::is_seen_sticking_out(model::ItemIndex item) const {
  if (is_seen_outside(item)) return true;
  return box(item) && box(item)->was_seen &&
         fit_of(item).above_rim > packing::LoadLimits{}.above + slack_of(*box(item));
}

bool Scene::is_under_obstacle(model::ItemIndex item) const {
  const packing::Extent own =
      packing::bounding_extent({belief.items[item.slot()], cell.layout.X_WT.inverse() * X_WP(item)});
  return std::ranges::any_of(obstacle_extents(), [&](const packing::Extent& one) {
    const Vector3 shared = own.high.cwiseMin(one.high) - own.low.cwiseMax(one.low);
    return shared.head<2>().minCoeff() > rules().recovery.under_obstacle && one.high.z() > own.high.z();
  });
}

bool Scene::is_under_box(model::ItemIndex item) const {
  constexpr double kSunk = 0.020;  // m, of the one above into this one: boxes give way and are seen with errors
  const Pose X_TW = cell.layout.X_WT.inverse();
  const auto extent_of = [&](model::ItemIndex one) {
    return packing::bounding_extent({belief.items[one.slot()], X_TW * X_WP(one)});
  };
  const packing::Extent own = extent_of(item);
  for (std::size_t i = 0; i < belief.boxes.size(); ++i) {
    const model::ItemIndex other(i);
    if (other == item || !box(other)) continue;
    const packing::Extent one = extent_of(other);
    const Vector3 shared = own.high.cwiseMin(one.high) - own.low.cwiseMax(one.low);
    const bool is_over = shared.head<2>().minCoeff() > rules().recovery.under_obstacle;
    if (is_over && one.low.z() > own.high.z() - kSunk) return true;
  }
  return false;
}

bool Scene::can_be_picked(model::ItemIndex item) const {
  if (!box(item) || !is_upright(X_WP(item).R, rules().skills.pick.max_lean)) return false;
  if (is_under_obstacle(item) || is_under_box(item)) return false;
  if (!cell.reaches) return true;
  const auto waypoints = plan_pick(belief.nominal(), cell.layout, planned_box(item), X_WP(item), X_WP(item),
                                   travel_bottom(item), skills::PickKind::FromAfar);
  return std::ranges::all_of(waypoints, [&](const motion::Waypoint& one) {
    return cell.reaches({one.X_WE, one.X_WE});
  });
}

double Scene::packed_top(model::ItemIndex without) const {
  const Pose X_TW = cell.layout.X_WT.inverse();
  double top = 0.0;
  for (const packing::Extent& one : obstacle_extents()) top = std::max(top, one.high.z());
  for (std::size_t i = 0; i < belief.items.size(); ++i) {
    const model::ItemIndex item(i);
    if (!box(item) || item == without) continue;
    top = std::max(top, packing::bounding_extent({belief.items[i], X_TW * X_WP(item)}).high.z());
  }
  return top;
}

double Scene::travel_bottom(model::ItemIndex without) const {
  return skills::travel_bottom(cell.layout, packed_top(without));
}

double Scene::tilt_of(model::ItemIndex item) const {
  return packing::lean_of(cell.layout.X_WT.R.transpose() * X_WP(item).R);
}

double Scene::size_error(model::ItemIndex item) const {
  const std::string& id = belief.items[item.slot()].id;
  return (model::find_parcel(belief.nominal(), id)->size - model::find_parcel(rules(), id)->size).cwiseAbs().maxCoeff();
}

}  // namespace snug::planning
