// Feeder: brings the boxes of the sequence to the aligner, one after the other, for controllers that do not.
#include "snug/served_cell/feeder.hpp"

#include <cmath>
#include <optional>

#include "snug/cell/aligner_feed.hpp"

namespace snug::served_cell {
namespace {

constexpr double kToolRoom = 0.25;  ///< m, around E: gripper and cup

double radius_of(const model::Scenario& scenario, const model::Item& item) {
  return 0.5 * model::collision_size(scenario, *model::find_parcel(scenario, item.parcel)).norm();
}

}  // namespace

int Feeder::coming(const cell::Simulation& simulation) const {
  return next_ < static_cast<int>(simulation.sequence().items.size()) ? next_ : -1;
}

int Feeder::next(const cell::Simulation& simulation, const cell::CellState& state) const {
  const std::vector<model::Item>& items = simulation.sequence().items;
  if (next_ >= static_cast<int>(items.size()) || state.waiting_item >= 0) return -1;
  const model::Item& item = items[static_cast<std::size_t>(next_)];
  const model::Scenario& scenario = simulation.scenario();
  const Vector3 p_WP = cell::pose_at_aligner(scenario, item, 0).p;
  const double radius = radius_of(scenario, item);
  if (state.arm && (state.arm->machine.tool.X_WE.p - p_WP).norm() < radius + kToolRoom) return -1;
  for (std::size_t i = 0; i < items.size(); ++i) {
    const physics::BodyId other = simulation.world().parcels[i];
    if (!state.world.bodies[static_cast<std::size_t>(other.index)].is_present) continue;
    const Vector3 p_WO = physics::pose_of(simulation.world().model, state.world, other).p;
    if ((p_WO - p_WP).norm() < radius + radius_of(scenario, items[i])) return -1;
  }
  return next_;
}

bool Feeder::is_last_placed(const cell::Simulation& simulation, const cell::CellState& state) const {
  if (next_ == 0) return true;
  const physics::BodyId last = simulation.world().parcels[static_cast<std::size_t>(next_ - 1)];
  if (!state.world.bodies[static_cast<std::size_t>(last.index)].is_present) return true;
  const model::Container* target = model::find_container(simulation.scenario(), simulation.scenario().target);
  if (target == nullptr) return true;
  const Vector3 p_TP = target->X_WT.inverse() * physics::pose_of(simulation.world().model, state.world, last).p;
  return std::abs(p_TP.x()) < 0.5 * target->inner_size.x() && std::abs(p_TP.y()) < 0.5 * target->inner_size.y();
}

}  // namespace snug::served_cell
