// Obstacles: how high the fixed things of a cell reach, which a tool passes over on its way.
#include "snug/skills/highest_fixed_point.hpp"

#include <algorithm>

#include "snug/core/check.hpp"
#include "snug/geometry/bounds.hpp"

namespace snug::skills {
namespace {

void raise(double& top, const std::vector<model::PlacedShape>& shapes, const Pose& X_WB) {
  for (const model::PlacedShape& placed : shapes) {
    top = std::max(top, geometry::bounds(placed.shape, X_WB * placed.X_BG).upper.z());
  }
}

}  // namespace

double highest_fixed_point(const model::Scenario& scenario) {
  SNUG_CHECK(scenario.aligner.has_value(), "boxes arrive at an aligner");
  const model::Aligner& aligner = *scenario.aligner;
  double top = std::max(aligner.X_WA.p.z(), aligner.support_height);
  raise(top, aligner.plates, aligner.X_WA);
  for (const model::Body& body : scenario.bodies) {
    if (body.kind == model::BodyKind::Static) raise(top, body.shapes, body.X_WB);
  }
  for (const model::Container& container : scenario.containers) {
    if (container.name != scenario.target) raise(top, model::make_walls(container), container.X_WT);
  }
  return top;
}

}  // namespace snug::skills
