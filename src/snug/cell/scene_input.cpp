// Scene input: motions and forces that the scenario prescribes, for one step.
#include "snug/cell/scene_input.hpp"

#include <algorithm>

namespace snug::cell {

void add_body_targets(const model::Scenario& scenario, const CellWorld& world, double end,
                      std::vector<physics::KinematicTarget>& targets) {
  for (std::size_t i = 0; i < scenario.bodies.size(); ++i) {
    const model::Body& body = scenario.bodies[i];
    if (body.kind != model::BodyKind::Kinematic || (!body.path && body.V_WB == Twist{})) continue;
    physics::KinematicTarget target{world.bodies[i], model::kinematic_pose_at(body, end), std::nullopt};
    if (body.path) target.V_WB_end = model::kinematic_twist_at(body, end);
    targets.push_back(target);
  }
}

void add_wrenches(const model::Scenario& scenario, const CellWorld& world, const physics::WorldState& state,
                  std::vector<physics::ExternalWrench>& wrenches) {
  const double dt = world.model.settings.dt;
  const double now = state.time(world.model);
  for (const model::AppliedWrench& applied : scenario.wrenches) {
    const double share = (std::min(applied.end, now + dt) - std::max(applied.start, now)) / dt;
    if (!(share > 1e-9)) continue;  // a step may begin a rounding before the end
    const physics::BodyId body = find_body(world, applied.body);
    if (!state.bodies[static_cast<std::size_t>(body.index)].is_present) continue;
    const Pose X_WB = physics::pose_of(world.model, state, body);
    const Matrix3 R = applied.is_in_body ? X_WB.R : Matrix3(Matrix3::Identity());
    Wrench wrench;
    wrench.force = std::min(share, 1.0) * (R * applied.force);
    wrench.torque = std::min(share, 1.0) * (R * applied.torque);
    if (applied.p_BQ) {
      const Vector3& com = world.model.bodies[static_cast<std::size_t>(body.index)].inertia.com;
      wrench.torque += (X_WB.R * (*applied.p_BQ - com)).cross(wrench.force);
    }
    wrenches.push_back({body, wrench});
  }
}

}  // namespace snug::cell
