// Simulation: cells taken up where they are believed to be, boxes brought, motions begun and broken off.
#include <algorithm>

#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::cell {

void Simulation::place(physics::BodyId body, const Pose& X_WB, CellState& state) const {
  physics::set_present(state.world, body, true);
  physics::set_pose(world_.model, state.world, body, X_WB);
  physics::set_twist(world_.model, state.world, body, Twist{});
}

CellState Simulation::take_up(const CellAnchor& anchor) const {
  CellState state = make_state();
  Pose X_WE = anchor.X_WE;
  if (arm_) {
    if (!anchor.q.empty()) state.arm = arm_->make_state(scenario_.seed, robot::joint_vector(anchor.q));
    X_WE = state.arm->machine.tool.X_WE;
    std::vector<physics::KinematicTarget> targets;
    arm_->aim(world_, robot::forward(arm_->model(), state.arm->machine.joints.q), targets);
    for (const physics::KinematicTarget& target : targets) {
      physics::set_pose(world_.model, state.world, target.body, target.X_WB_end);
    }
  }
  physics::set_pose(world_.model, state.world, world_.tool, X_WE);
  state.controller = motion::make_controller_state(X_WE);
  for (const CellAnchor::Box& box : anchor.boxes) {
    place(world_.parcels[static_cast<std::size_t>(box.item)], box.X_WP, state);
  }
  return state;
}

motion::ToolState Simulation::tool_of(const CellState& state) const {
  return arm_ ? state.arm->machine.tool : state.controller.command;
}

void Simulation::begin_motion(CellState& state) const {
  const motion::ToolState tool = tool_of(state);
  motion::ControllerState controller = motion::make_controller_state(tool.X_WE);
  controller.command = tool;
  controller.io = state.controller.io;
  controller.tick_count = state.controller.tick_count;
  controller.sensed = state.controller.sensed;
  state.controller = controller;
}

void Simulation::stand(CellState& state) const {
  if (arm_) arm_->stand(*state.arm);
  begin_motion(state);
  state.controller.command.V_WE = Twist{};
}

void Simulation::acknowledge(const CellWorkspace& work, CellState& state) const {
  if (arm_) arm_->acknowledge(work.arm, *state.arm);
}

void Simulation::bring(int item, CellState& state) const {
  const auto index = static_cast<std::size_t>(item);
  const auto radius = [this](std::size_t i) {
    return 0.5 * model::collision_size(scenario_, *model::find_parcel(scenario_, sequence_.items[i].parcel)).norm();
  };
  const Pose X_WP = pose_at_aligner(scenario_, sequence_.items[index], std::nullopt);
  for (std::size_t i = 0; i < sequence_.items.size(); ++i) {
    const physics::BodyId other = world_.parcels[i];
    if (!state.world.bodies[static_cast<std::size_t>(other.index)].is_present) continue;
    if (other.index == state.gripper.cup.body) continue;
    const Vector3 p = physics::pose_of(world_.model, state.world, other).p;
    const bool was_waiting = state.waiting_item == static_cast<int>(i);
    if (!was_waiting && (p - X_WP.p).norm() > radius(i) + radius(index)) continue;
    physics::set_present(state.world, other, false);
    state.event_log.box_removed(static_cast<int>(i), time(state));
  }
  place(world_.parcels[index], X_WP, state);
  state.waiting_item = item;
  state.event_log.box_appeared(item, time(state));
}

Wrench Simulation::tool_load(const CellState& state, const CellWorkspace& work) const {
  const Pose X_WE = tool_of(state).X_WE;
  Wrench F_W;
  const auto add = [&](const Vector3& force, const Vector3& p_W) {
    F_W.force += force;
    F_W.torque += (p_W - X_WE.p).cross(force);
  };
  for (const physics::ContactReport& contact : work.physics.contacts()) {
    if (contact.b == world_.tool) add(contact.force_W, contact.p_WQ);
    if (contact.a == world_.tool) add(-contact.force_W, contact.p_WQ);
  }
  if (arm_) {
    for (const physics::ContactReport& contact : work.arm.contacts) {
      if (contact.b == world_.tool) add(contact.force_W, contact.p_WQ);
    }
  }
  for (const physics::ElementUse& use : work.gripper.uses) {  // sealed cups and pushing lips
    physics::ElementQuery query;
    query.X_WE = X_WE * use.X_CE;
    query.V_WE = twist_at(tool_of(state).V_WE, X_WE.R * use.X_CE.p);
    query.X_WB = physics::pose_of(world_.model, state.world, use.body);
    query.V_WB = physics::twist_of(world_.model, state.world, use.body);
    query.p_WBcm = state.world.bodies[static_cast<std::size_t>(use.body.index)].p_WBcm;
    const Wrench on_body = wrench_from(use.element->evaluate(query).wrench);  // about its centre of mass
    add(-on_body.force, query.p_WBcm);
    F_W.torque -= on_body.torque;
  }
  return {X_WE.R.transpose() * F_W.force, X_WE.R.transpose() * F_W.torque};
}

}  // namespace snug::cell
