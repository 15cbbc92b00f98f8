// SimulatedPlant: faults made to happen: seals broken, boxes moved, robots stopped.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "snug/simulated_plant/simulated_plant.hpp"

namespace snug::simulated_plant {
namespace {

constexpr double kCarried = 0.30;  ///< m, level, from where boxes are picked: the box is on its way
constexpr double kAside = 0.030;   ///< m
constexpr double kLowest = 0.002;  ///< m, over what it is put on
constexpr int kDirections = 8;

}  // namespace

void SimulatedPlant::note(const char* kind, int item, std::string text) {
  state_.event_log.note({simulation_.time(state_),
                         "fault",
                         simulation_.sequence().items[static_cast<std::size_t>(item)].parcel,
                         std::string(kind) + ": " + std::move(text),
                         {}});
}

/// What hangs from the cup falls, and nothing seals until the vacuum is switched off.
void SimulatedPlant::break_suction() {
  const double least_hold_factor = state_.gripper.least_hold_factor;  // of the item's whole way
  state_.gripper = cell::GripperState{};
  state_.gripper.cannot_seal = true;
  state_.gripper.least_hold_factor = least_hold_factor;
}

/// 30 mm to the side where it has to be lifted least, over whatever is there.
void SimulatedPlant::move_aside(int item, FaultKind kind) {
  const cell::CellWorld& world = simulation_.world();
  const auto pose_of = [&](physics::BodyId body) { return physics::pose_of(world.model, state_.world, body); };
  const auto half_of = [&](physics::BodyId body, const Matrix3& R) {
    const auto& box = std::get<geometry::Box>(world.model.bodies[static_cast<std::size_t>(body.index)].geoms[0].shape);
    return Vector3(R.cwiseAbs() * box.half);
  };
  const physics::BodyId self = world.parcels[static_cast<std::size_t>(item)];
  std::vector<physics::BodyId> others = world.parcels;
  for (const ForeignObject& object : objects_.objects()) others.push_back(object.body);
  std::erase_if(others, [&](physics::BodyId body) {
    return body.index == self.index || !state_.world.bodies[static_cast<std::size_t>(body.index)].is_present;
  });
  const Pose X_WP = pose_of(self);
  const Vector3 half = half_of(self, X_WP.R);
  Pose best = X_WP;
  double least = 1.0;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kDirections;
    Vector3 p = X_WP.p + kAside * Vector3(std::cos(angle), std::sin(angle), 0.0);
    for (const physics::BodyId other : others) {
      const Pose X_other = pose_of(other);
      const Vector3 room = half + half_of(other, X_other.R), off = (p - X_other.p).cwiseAbs();
      const bool is_beside = off.x() < room.x() && off.y() < room.y() && off.z() < room.z();
      if (is_beside) p.z() = std::max(p.z(), X_other.p.z() + room.z() + kLowest);
    }
    const model::Container& container = *model::find_container(simulation_.scenario(), simulation_.scenario().target);
    const Vector3 p_TP = container.X_WT.inverse() * p;
    const Vector3 beyond = p_TP.cwiseAbs() + half - 0.5 * container.inner_size;
    double lift = p.z() - X_WP.p.z();
    if (container.has_walls && std::max(beyond.x(), beyond.y()) > 0.0) lift += 0.5;  // never into a wall
    if (lift >= least) continue;
    least = lift;
    best = {X_WP.R, p};
  }
  if (least >= 0.5) best.p = X_WP.p + Vector3(0.0, 0.0, kLowest);
  physics::set_pose(world.model, state_.world, self, best);
  note(name_of(kind), item,
       fmt::format("moved {:.0f} mm aside and lifted {:.0f} mm", 1e3 * (best.p - X_WP.p).head<2>().norm(),
                   1e3 * (best.p.z() - X_WP.p.z())));
}

void SimulatedPlant::inject() {
  if (current_ < 0) return;
  const cell::CellWorld& world = simulation_.world();
  const physics::BodyId body = world.parcels[static_cast<std::size_t>(current_)];
  const bool is_held = state_.gripper.cup.body == body.index;
  if (is_held && pending_.no_seal) {
    pending_.no_seal = false;
    break_suction();
    note("noseal", current_, "the lip leaks");
    return;
  }
  const Vector3 p_picked = simulation_.scenario().aligner ? simulation_.scenario().aligner->X_WA.p : Vector3::Zero();
  const bool is_carried = is_held && (X_WE().p - p_picked).head<2>().norm() > kCarried;
  if (is_carried && pending_.stop) {
    pending_.stop = false;
    note("stop", current_, "protective stop");
    runner_.stop(plant::EndReason::ProtectiveStop, 0.0, 0.0, "injected");
  }
  if (is_carried && pending_.drop) {
    pending_.drop = false;
    break_suction();
    note("drop", current_, "it falls from the cup");
  }
  if (is_let_go()) inject_let_go();
}

void SimulatedPlant::inject_let_go() {
  while (pending_.displace || pending_.push) {
    if (move_boxes()) return begin_rest(false);
  }
  if (put_and_take_objects()) begin_rest(true);
}

bool SimulatedPlant::is_let_go() const {
  const cell::CellWorld& world = simulation_.world();
  const physics::BodyId body = world.parcels[static_cast<std::size_t>(current_)];
  // The last motion of an item ends with the box let go and the tool over it, or leaves from there.
  const model::Container* container = model::find_container(simulation_.scenario(), simulation_.scenario().target);
  if (container == nullptr || !state_.world.bodies[static_cast<std::size_t>(body.index)].is_present) return false;
  const Vector3 p_TP = container->X_WT.inverse() * physics::pose_of(world.model, state_.world, body).p;
  const bool is_in = p_TP.z() > 0.0 && (p_TP.cwiseAbs() - 0.5 * container->inner_size).head<2>().maxCoeff() < 0.0;
  return is_in && plan_.program.waypoints.back().motion_class == motion::MotionClass::PostPlace &&
         state_.gripper.cup.body != body.index &&
         (state_.controller.phase == motion::ControllerPhase::Finished || runner_.has_passed_perception());
}

bool SimulatedPlant::move_boxes() {
  const cell::CellWorld& world = simulation_.world();
  int item = current_;
  if (pending_.push && !pending_.displace) {
    const Vector3 p = physics::pose_of(world.model, state_.world, world.parcels[static_cast<std::size_t>(current_)]).p;
    double nearest = 1e9;
    item = -1;
    for (const cell::BoxResult& box : boxes()) {
      const int other = item_of(box.id);
      if (other == current_ || box.state != cell::BoxState::Packed) continue;
      const Vector3 p_other =
          physics::pose_of(world.model, state_.world, world.parcels[static_cast<std::size_t>(other)]).p;
      if ((p_other - p).norm() >= nearest) continue;
      nearest = (p_other - p).norm();
      item = other;
    }
  }
  const FaultKind kind = pending_.displace ? FaultKind::Displace : FaultKind::Push;
  (pending_.displace ? pending_.displace : pending_.push) = false;
  if (item < 0) return false;
  move_aside(item, kind);
  return true;
}

bool SimulatedPlant::put_and_take_objects() {
  const bool is_clearing = std::exchange(clear_is_due_, false);
  if (is_clearing) {
    objects_.take_out(state_);
    note("clear", current_, "foreign objects are taken out");
  }
  const int due = std::exchange(objects_due_, 0);
  for (int i = 0; i < due; ++i) {
    const ForeignObject* object = objects_.put(state_);
    if (object == nullptr) {
      note("object", current_, "no room for it in the container");
      continue;
    }
    const Vector3 p = 1e3 * object->X_TB.p, size = 1e3 * kForeignSize;
    note("object", current_,
         fmt::format("{}, {:.0f} x {:.0f} x {:.0f} mm, is put at ({:.0f}, {:.0f}, {:.0f}) mm", object->name, size.x(),
                     size.y(), size.z(), p.x(), p.y(), p.z()));
  }
  return is_clearing || due > 0;
}

}  // namespace snug::simulated_plant
