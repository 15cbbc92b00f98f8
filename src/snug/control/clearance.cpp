// Clearance: how near parts of an arm come to each other, and where.
#include "snug/control/clearance.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "snug/core/input_error.hpp"
#include "snug/geometry/bounds.hpp"
#include "snug/geometry/manifold.hpp"

namespace snug::control {
namespace {

ArmShape arm_shape(int segment, const Pose& X_SB, const model::PlacedShape& placed) {
  return {segment, X_SB * placed.X_BG, placed.shape, geometry::bounding_radius(placed.shape)};
}

int find_part(const std::vector<ArmPart>& parts, const std::string& name, const std::string& where) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].name == name) return static_cast<int>(i);
    names.push_back(parts[i].name);
  }
  const std::string_view near = find_nearest(name, names);
  throw InputError(where, "self_collision", "'" + name + "'",
                   near.empty() ? fmt::format("a part of the arm with shapes: {}", fmt::join(names, ", "))
                                : fmt::format("did you mean '{}'?", near));
}

}  // namespace

Nearest nearest_points(std::span<const ArmShape> A, const Pose& X_WA, std::span<const ArmShape> B, const Pose& X_WB,
                       double range) noexcept {
  Nearest nearest;
  nearest.distance = range;
  for (const ArmShape& a : A) {
    const Pose X_WGa = X_WA * a.X_SG;
    for (const ArmShape& b : B) {
      const Pose X_WGb = X_WB * b.X_SG;
      const double reach = a.radius + b.radius + nearest.distance;
      if ((X_WGa.p - X_WGb.p).squaredNorm() > reach * reach && reach > 0.0) continue;
      geometry::PairCache cache;
      geometry::Manifold manifold;
      geometry::collide(a.shape, X_WGa, b.shape, X_WGb, std::max(0.0, nearest.distance), cache, manifold);
      for (int i = 0; i < manifold.count; ++i) {
        const geometry::ManifoldPoint& point = manifold.points[static_cast<std::size_t>(i)];
        if (point.phi > nearest.distance || (nearest.index >= 0 && point.phi == nearest.distance)) continue;
        nearest = {0, point.phi, point.p_WA, point.p_WB, manifold.n_AB_W};
      }
    }
  }
  return nearest;
}

Clearance::Clearance(const robot::ArmModel& arm, std::span<const CarriedShapes> carried,
                     std::span<const model::SelfCollisionPair> pairs, const std::string& where) {
  for (const robot::Link& link : arm.links) {
    if (link.shapes.empty()) continue;
    ArmPart part{link.name, link.segment, {}};
    for (const model::PlacedShape& shape : link.shapes)
      part.shapes.push_back(arm_shape(link.segment, link.X_SL, shape));
    parts_.push_back(std::move(part));
  }
  for (const CarriedShapes& load : carried) {
    ArmPart part{load.name, arm.last_segment(), {}};
    for (const model::PlacedShape& shape : load.shapes) part.shapes.push_back(arm_shape(part.segment, arm.X_SE, shape));
    parts_.push_back(std::move(part));
  }
  for (const model::SelfCollisionPair& pair : pairs) {
    pairs_.push_back(
        {find_part(parts_, pair.link_a, where), find_part(parts_, pair.link_b, where), pair.interaction, pair.safety});
  }
}

std::string Clearance::name_of(int pair) const {
  const Pair& p = pairs_[static_cast<std::size_t>(pair)];
  return parts_[static_cast<std::size_t>(p.part_a)].name + " - " + parts_[static_cast<std::size_t>(p.part_b)].name;
}

Nearest Clearance::nearest(const robot::ArmPose& at, int pair) const noexcept {
  const Pair& p = pairs_[static_cast<std::size_t>(pair)];
  const ArmPart& a = parts_[static_cast<std::size_t>(p.part_a)];
  const ArmPart& b = parts_[static_cast<std::size_t>(p.part_b)];
  Nearest nearest = nearest_points(a.shapes, at.X_WS[static_cast<std::size_t>(a.segment)], b.shapes,
                                   at.X_WS[static_cast<std::size_t>(b.segment)], p.interaction);
  if (nearest.index >= 0) nearest.index = pair;
  return nearest;
}

}  // namespace snug::control
