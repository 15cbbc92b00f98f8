// CellLayout: what the plans of all items of a cell have in common.
#include "snug/skills/cell_layout.hpp"

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/geometry/bounds.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/skills/highest_fixed_point.hpp"

namespace snug::skills {
namespace {

constexpr double kLevel = 1e-3;  ///< rad
constexpr double kSag = 0.005;   ///< m, more than a box hangs below where it is planned to

/// The bounds in W of a level box, shrunk to a rectangle that lies wholly on its upper face when it is turned about the
/// vertical.
geometry::Aabb upper_face(const geometry::Box& box, const Pose& X_WG) {
  geometry::Aabb top = geometry::bounds(box, X_WG);
  const Vector3 half = 0.5 * (top.upper - top.lower);
  double share = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 direction = X_WG.R.col(axis).cwiseAbs();
    if (direction.z() > 0.5) continue;
    share = std::min(share, box.half[axis] / direction.head<2>().dot(half.head<2>()));
  }
  const Eigen::Vector2d less = (1.0 - share) * half.head<2>();
  top.lower.head<2>() += less;
  top.upper.head<2>() -= less;
  return top;
}

/// In W, of the boxes that fixed bodies are made of, where one face lies level.
std::vector<geometry::Aabb> flat_tops(const model::Scenario& scenario) {
  std::vector<geometry::Aabb> tops;
  for (const model::Body& body : scenario.bodies) {
    if (body.kind != model::BodyKind::Static) continue;
    for (const model::PlacedShape& placed : body.shapes) {
      const Pose X_WG = body.X_WB * placed.X_BG;
      const bool is_level = X_WG.R.row(2).cwiseAbs().maxCoeff() > std::cos(kLevel);
      const auto* box = std::get_if<geometry::Box>(&placed.shape);
      if (is_level && box != nullptr) tops.push_back(upper_face(*box, X_WG));
    }
  }
  return tops;
}

/// The axis of W that is nearest to the way from `from` to `to`.
Vector3 main_direction(const Vector3& from, const Vector3& to) {
  const Vector3 way = to - from;
  const int axis = std::abs(way.x()) >= std::abs(way.y()) ? 0 : 1;
  return std::copysign(1.0, way[axis]) * Vector3::Unit(axis);
}

/// The highest surface that is large enough, near the way from aligner to container.
std::optional<FlipPlace> find_flip_place(const std::vector<geometry::Aabb>& tops, const Vector3& from,
                                         const Vector3& to, const settings::PivotParams& params) {
  const Vector3 middle = 0.5 * (from + to), direction = main_direction(from, to);
  std::optional<FlipPlace> best;
  double best_distance = 0.0;
  for (const geometry::Aabb& top : tops) {
    // A flipped box is let go further on in `direction` and dragged back to its place: room on that side only.
    const Vector3 low =
        top.lower + Vector3::Constant(params.surface_room) + params.surface_drag * (-direction).cwiseMax(0.0);
    const Vector3 high =
        top.upper - Vector3::Constant(params.surface_room) - params.surface_drag * direction.cwiseMax(0.0);
    if (low.x() > high.x() || low.y() > high.y()) continue;
    const Vector3 nearest(std::clamp(middle.x(), low.x(), high.x()), std::clamp(middle.y(), low.y(), high.y()),
                          top.upper.z());
    const double distance = (nearest - middle).head<2>().norm();
    const bool is_higher = best && nearest.z() > best->p_WF.z() + 1e-6;
    const bool is_as_high = best && std::abs(nearest.z() - best->p_WF.z()) <= 1e-6;
    if (best && !is_higher && !(is_as_high && distance < best_distance)) continue;
    best = FlipPlace{nearest, direction};
    best_distance = distance;
  }
  return best;
}

}  // namespace

CellLayout make_layout(const model::Scenario& scenario, const std::optional<motion::PanAxis>& pan_axis) {
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (!scenario.aligner || !scenario.tool || container == nullptr) {
    throw InputError(scenario.source_name, "", "", "a cell with an aligner, a tool and a target container");
  }
  CellLayout layout;
  layout.X_WT = container->X_WT;
  layout.rim = container->has_walls ? container->inner_size.z() : 0.0;
  layout.fixed_top = highest_fixed_point(scenario);
  layout.flip_place =
      find_flip_place(flat_tops(scenario), scenario.aligner->X_WA.p, container->X_WT.p, scenario.skills.pivot);
  layout.pan_axis = pan_axis;
  layout.travel = scenario.skills.travel;
  layout.cup_growth = std::max(0.0, scenario.cup.free_length - scenario.cup.hold_length);
  layout.neutral_yaw = motion::yaw_of(scenario.controller.X_WE_start.R).value_or(0.0);
  return layout;
}

double crossing_clearance(const CellLayout& layout) {
  return layout.is_fast ? layout.travel.turning_clearance + kSag : layout.travel.clearance;
}

double travel_bottom(const CellLayout& layout, double packed_top) {
  const double rim = layout.X_WT.p.z() + std::max(layout.rim, packed_top);
  return std::max(rim, layout.fixed_top) + crossing_clearance(layout);
}

}  // namespace snug::skills
