// Uncertainty: what nobody knows exactly about a cell, and scenarios drawn from it.
#include "snug/task/uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/ensemble.hpp"
#include "snug/core/check.hpp"
#include "snug/motion/unwinding.hpp"

namespace snug::task {
namespace {

constexpr double kLongestEdge = 0.3;  ///< m, of boxes

void fix_arrival(const model::Scenario& scenario, model::Item& item) {
  if (item.yaw) return;
  const Matrix3 R_AP = scenario.aligner->X_WA.R.transpose() * arrival_pose(scenario, item).R;
  double best = -4.0;
  for (int turn = 0; turn < 4; ++turn) {
    const double yaw = turn * 0.5 * std::numbers::pi;
    const double trace = (model::standing_rotation(item.up, item.up_sign, yaw).transpose() * R_AP).trace();
    if (trace <= best) continue;
    best = trace;
    item.yaw = yaw;
  }
}

void scale(model::CupElasticity& elasticity, double by) {
  elasticity.lateral *= by;
  elasticity.axial *= by;
  elasticity.bend *= by;
  elasticity.torsion *= by;
  elasticity.coupling *= by;
}

}  // namespace

Pose arrival_pose(const model::Scenario& scenario, const model::Item& item) {
  SNUG_CHECK(scenario.aligner.has_value(), "boxes arrive at an aligner");
  const Pose first = cell::pose_at_aligner(scenario, item, std::nullopt);
  return cell::pose_at_aligner(scenario, item, Pose{motion::upright_tool(0.0), first.p});
}

model::Scenario sample(const model::Scenario& scenario, const std::string& sequence, const Uncertainty& uncertainty,
                       Rng rng) {
  model::Scenario changed = scenario;
  const auto draw = [&rng](double half_width) { return rng.uniform(-half_width, half_width); };
  for (model::Sequence& one : changed.sequences) {
    if (one.name != sequence) continue;
    for (model::Item& item : one.items) {
      fix_arrival(scenario, item);
      item.shift_A.x() = draw(uncertainty.position);
      item.shift_A.y() = draw(uncertainty.position);
      item.turn = draw(uncertainty.yaw);
    }
  }
  // The plates stand back, so that no box begins inside them.
  const double back = uncertainty.position + kLongestEdge * uncertainty.yaw;
  for (model::PlacedShape& plate : changed.aligner->plates) plate.X_BG.p -= Vector3(back, back, 0.0);
  for (model::Parcel& parcel : changed.parcels) {
    for (int i = 0; i < 3; ++i)
      parcel.size[i] = std::max(0.5 * parcel.size[i], parcel.size[i] + draw(uncertainty.size));
    for (int i = 0; i < 3; ++i) {
      const double room = 0.45 * parcel.size[i];
      parcel.inertia.com[i] = std::clamp(parcel.inertia.com[i] + draw(uncertainty.com), -room, room);
    }
  }
  for (model::ContactPair& pair : changed.contact_pairs) pair.params.friction *= 1.0 + draw(uncertainty.friction);
  cell::draw_masses(changed, uncertainty.mass, rng.split("mass"));
  scale(changed.cup.stiffness, 1.0 + draw(uncertainty.cup));
  scale(changed.cup.damping, 1.0 + draw(uncertainty.cup));
  return changed;
}

}  // namespace snug::task
