// PoseCheck: what is wrong where an arm stands: joints near their limits, a singularity, links and tool near other
// things.
#include "snug/runs/internal/pose_check.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/cell/world_builder.hpp"
#include "snug/geometry/manifold.hpp"

namespace snug::runs::internal {
namespace {

// Beyond a limit by less than this is the rounding of a controller that keeps it.
constexpr double kMarginRounding = 1e-6;
/// m, by which a tick may fall short of a safety distance: the controller's dampers keep it to first order.
constexpr double kDamperSlack = 0.001;

std::vector<Obstacle> find_obstacles(const model::Scenario& scenario) {
  std::vector<Obstacle> obstacles;
  for (const physics::BodyModel& body : cell::build_world(scenario, {nullptr, false, nullptr, {}}).model.bodies) {
    if (body.kind != physics::BodyKind::Static) continue;
    for (const physics::Geom& geom : body.geoms) {
      const Pose X_WG = body.X_WB * geom.X_BG;
      obstacles.push_back({body.name, geom.shape, X_WG, geometry::bounds(geom.shape, X_WG)});
    }
  }
  return obstacles;
}

std::vector<Mover> find_movers(const model::Scenario& scenario, const robot::ArmModel& arm, double allowance) {
  std::vector<Mover> movers;
  const int sensor = robot::find_link(arm, scenario.robot->sensor_frame);
  for (int i = 0; i < static_cast<int>(arm.links.size()); ++i) {
    const robot::Link& link = arm.links[static_cast<std::size_t>(i)];
    if (link.segment == 0 || link.shapes.empty() || robot::is_behind(arm, i, sensor)) continue;
    Mover mover{link.name, link.segment, {}, 0.0};
    for (const model::PlacedShape& shape : link.shapes) mover.shapes.push_back({shape.shape, link.X_SL * shape.X_BG});
    movers.push_back(std::move(mover));
  }
  const auto carried = [&](const char* name, const std::vector<model::PlacedShape>& shapes, double slack) {
    Mover mover{name, arm.joint_count(), {}, slack};
    for (const model::PlacedShape& shape : shapes) mover.shapes.push_back({shape.shape, arm.X_SE * shape.X_BG});
    movers.push_back(std::move(mover));
  };
  if (scenario.tool) {
    carried("gripper", scenario.tool->rod_shapes, 0.0);
    carried("cup", scenario.tool->cup_shapes, allowance);
  }
  return movers;
}

}  // namespace

bool PoseMargin::is_kept() const { return margin + allowance >= -kMarginRounding; }

PoseCheck::PoseCheck(const model::Scenario& scenario, const robot::ArmModel& arm, const control::Clearance& clearance,
                     double allowance, double range)
    : arm_(arm),
      clearance_(clearance),
      range_(range),
      damper_safety_(scenario.robot->damper.safety),
      obstacles_(find_obstacles(scenario)),
      movers_(find_movers(scenario, arm, allowance)) {}

void PoseCheck::look_at_limit(int index, double q, const Note& note) const {
  const robot::Joint& joint = arm_.joints[static_cast<std::size_t>(index)];
  const double range = joint.upper - joint.lower;
  if (!std::isfinite(range)) return;
  note({CheckKind::JointLimit, joint.name, std::min(q - joint.lower, joint.upper - q) - damper_safety_ * range,
        joint.kind == robot::JointKind::Revolute ? "rad" : "m", 0.0});
}

void PoseCheck::look_at_singularity(double measure, const Note& note) const {
  note({CheckKind::Singularity, "tool", measure - kSingularPose, "1", 0.0});
}

void PoseCheck::look_at_distances(const robot::ArmPose& at, const std::vector<Obstacle>& packed,
                                  double packed_allowance, const Note& note) const {
  for (int i = 0; i < static_cast<int>(clearance_.pairs().size()); ++i) {
    const control::Nearest nearest = clearance_.nearest(at, i);
    if (nearest.index < 0) continue;
    note({CheckKind::SelfCollision, clearance_.name_of(i),
          nearest.distance - clearance_.pairs()[static_cast<std::size_t>(i)].safety, "m", kDamperSlack});
  }
  for (const Mover& mover : movers_) {
    look_at(mover, at.X_WS[static_cast<std::size_t>(mover.segment)], packed, packed_allowance, note);
  }
}

void PoseCheck::look_at(const Mover& mover, const Pose& X_WS, const std::vector<Obstacle>& packed,
                        double packed_allowance, const Note& note) const {
  look_at_obstacles(mover, X_WS, obstacles_, mover.allowance, note);
  look_at_obstacles(mover, X_WS, packed, mover.allowance > 0.0 ? packed_allowance : 0.0, note);
}

void PoseCheck::look_at_obstacles(const Mover& mover, const Pose& X_WS, const std::vector<Obstacle>& obstacles,
                                  double allowance, const Note& note) const {
  for (const model::PlacedShape& placed : mover.shapes) {
    const Pose X_WG = X_WS * placed.X_BG;
    const geometry::Aabb bounds = geometry::bounds(placed.shape, X_WG).inflated(range_);
    for (const Obstacle& obstacle : obstacles) {
      if (!bounds.overlaps(obstacle.bounds)) continue;
      geometry::PairCache cache;
      geometry::Manifold manifold;
      geometry::collide(obstacle.shape, obstacle.X_WG, placed.shape, X_WG, range_, cache, manifold);
      double distance = range_;
      for (int i = 0; i < manifold.count; ++i) {
        distance = std::min(distance, manifold.points[static_cast<std::size_t>(i)].phi);
      }
      if (distance < range_) {
        note({CheckKind::Collision, mover.name + " - " + obstacle.name, distance, "m", allowance});
      }
    }
  }
}

}  // namespace snug::runs::internal
