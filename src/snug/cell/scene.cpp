// Scene: the bodies of a scenario without robot: free, driven by springs, dropped; stepped one time step at a time.
#include "snug/cell/scene.hpp"

#include <algorithm>

#include "snug/cell/resume.hpp"
#include "snug/cell/scene_input.hpp"
#include "snug/core/check.hpp"

namespace snug::cell {
namespace {

/// The world with one shapeless kinematic body per spring, its holder.
CellWorld with_holders(const model::Scenario& scenario, std::vector<physics::BodyId>& holders) {
  CellWorld world = build_world(scenario, {});
  for (const model::Spring& spring : scenario.springs) {
    physics::BodyModel holder;
    holder.name = "holder of " + spring.name;
    holder.kind = physics::BodyKind::Kinematic;
    holder.X_WB = spring.X_WH;
    holders.push_back(physics::BodyId{static_cast<int>(world.model.bodies.size())});
    world.model.bodies.push_back(std::move(holder));
    world.types.emplace_back();
  }
  world.model.finalize();
  return world;
}

bool is_due(double time, double now) { return now >= time - 1e-12; }

}  // namespace

Scene::Scene(const model::Scenario& scenario, int threads)
    : scenario_(scenario),
      world_(with_holders(scenario, holders_)),
      state_(make_initial_state(scenario, world_)),
      work_(world_.model, threads),
      drop_plan_(plan_drops(scenario)) {
  for (const model::Spring& spring : scenario_.springs) {
    springs_.emplace_back(cup::as_matrix(spring.stiffness), cup::as_matrix(spring.damping), Pose{}, spring.X_BS,
                          Pose{});
  }
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    elements_.push_back({&springs_[i], holders_[i], Pose{}, find_body(world_, scenario_.springs[i].body)});
  }
  if (scenario_.initial_state) resume(*scenario_.initial_state, world_, state_);
  // What appeared in the steps before.
  const double before = state_.time(world_.model) - world_.model.settings.dt;
  for (const model::Body& body : scenario_.bodies) {
    has_appeared_.push_back(body.appears_at <= 0.0 || is_due(body.appears_at, before));
  }
  while (dropped_ < drop_plan_.boxes.size() && is_due(drop_time(dropped_), before)) ++dropped_;
}

double Scene::drop_time(std::size_t index) const {
  return scenario_.drops->start + static_cast<double>(index) * scenario_.drops->interval;
}

void Scene::let_bodies_appear() {
  const double now = state_.time(world_.model);
  for (std::size_t i = 0; i < scenario_.bodies.size(); ++i) {
    const model::Body& body = scenario_.bodies[i];
    if (has_appeared_[i] || !is_due(body.appears_at, now)) continue;
    has_appeared_[i] = true;
    physics::set_present(state_, world_.bodies[i], true);
    physics::set_pose(world_.model, state_, world_.bodies[i], body.X_WB);
    physics::set_twist(world_.model, state_, world_.bodies[i], body.V_WB);
  }
  if (!scenario_.drops) return;
  while (dropped_ < drop_plan_.boxes.size() && is_due(drop_time(dropped_), now)) drop_next();
}

void Scene::drop_next() {
  const model::Drops& drops = *scenario_.drops;
  const Pose& X_WT = model::find_container(scenario_, drops.container)->X_WT;
  double highest = X_WT.p.z();
  for (std::size_t i = 0; i < state_.bodies.size(); ++i) {
    if (world_.model.bodies[i].kind != physics::BodyKind::Dynamic || !state_.bodies[i].is_present) continue;
    const Pose X_WB = physics::pose_of(world_.model, state_, physics::BodyId{static_cast<int>(i)});
    const auto* box = std::get_if<geometry::Box>(&world_.model.bodies[i].geoms[0].shape);
    if (box != nullptr) highest = std::max(highest, X_WB.p.z() + (X_WB.R.cwiseAbs() * box->half).z());
  }
  const DropPlan::Box& plan = drop_plan_.boxes[dropped_];
  const physics::BodyId body = world_.drops[dropped_++];
  const Vector3& size = scenario_.parcel_types[static_cast<std::size_t>(plan.type)].size;
  Pose X_WP = X_WT * Pose{exp_rotation(Vector3(0.0, 0.0, plan.yaw)), plan.p_TP_xy};
  X_WP.p.z() = highest + drops.clearance + 0.5 * size.z();
  physics::set_present(state_, body, true);
  physics::set_pose(world_.model, state_, body, X_WP);
}

void Scene::restore(const SceneState& state) {
  SNUG_CHECK(state.world.bodies.size() == state_.bodies.size(), "a snapshot is of the same scene");
  state_ = state.world;
  dropped_ = state.dropped;
  has_appeared_ = state.has_appeared;
  lost_ = state.lost;
}

physics::StepReport Scene::advance() {
  let_bodies_appear();
  const double end = static_cast<double>(state_.step_index + 1) * world_.model.settings.dt;
  targets_.clear();
  add_body_targets(scenario_, world_, end, targets_);
  for (std::size_t i = 0; i < holders_.size(); ++i) {
    targets_.push_back({holders_[i], model::holder_at(scenario_.springs[i], end).X_WH});
  }
  physics::WorldInput input;
  input.kinematic = targets_;
  input.elements = elements_;
  wrenches_.clear();
  add_wrenches(scenario_, world_, state_, wrenches_);
  input.wrenches = wrenches_;
  const physics::StepReport report = physics::step(world_.model, input, state_, work_);
  if (report.status == physics::StepStatus::LostBody) lost_.push_back(take_lost(world_, state_, report.culprit));
  return report;
}

}  // namespace snug::cell
