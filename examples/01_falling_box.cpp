// 01: a box falls on a table. A world model, a state, a workspace, and the step between instants.
#include <cstdio>

#include "snug/physics/world.hpp"

using namespace snug;

int main() {
  physics::BodyModel table;
  table.name = "table";
  table.kind = physics::BodyKind::Static;
  table.geoms = {{geometry::Box{{0.5, 0.5, 0.05}}, Pose{}}};  // half sizes, m
  table.X_WB.p = Vector3(0.0, 0.0, -0.05);

  physics::BodyModel box;
  box.name = "box";
  const Vector3 size(0.17, 0.235, 0.094);
  const Vector3 square = size.cwiseAbs2();
  box.inertia.mass = 0.95;
  box.inertia.inertia = Matrix3(
      (Vector3(square.y() + square.z(), square.x() + square.z(), square.x() + square.y()) * box.inertia.mass / 12.0)
          .asDiagonal());
  box.geoms = {{geometry::Box{0.5 * size}, Pose{}}};
  box.X_WB.p = Vector3(0.0, 0.0, 0.25);
  box.X_WB.R = exp_rotation(Vector3(0.2, 0.1, 0.0));

  physics::WorldModel model;
  model.bodies = {table, box};
  model.laws = {{.friction = 0.3, .restitution = 0.1}};
  model.settings.dt = 1e-3;
  model.settings.sleep.enabled = false;  // so that the contacts are still there at the end
  model.finalize();

  physics::WorldState state = physics::make_state(model);  // copy it, and you have a snapshot
  physics::Workspace workspace(model);
  for (int i = 0; i <= 1000; ++i) {
    if (i % 100 == 0) {
      const Pose X_WB = physics::pose_of(model, state, physics::BodyId{1});
      std::printf("t %.1f s  z %7.4f m  energy %7.4f J\n", state.time(model), X_WB.p.z(),
                  physics::kinetic_energy(model, state) + physics::potential_energy(model, state));
    }
    const physics::StepReport report = physics::step(model, {}, state, workspace);
    if (report.status != physics::StepStatus::Converged) return 1;
  }
  for (const physics::ContactReport& contact : workspace.contacts()) {
    std::printf("%s carries %.3f N at (%.3f, %.3f)\n",
                model.bodies[static_cast<std::size_t>(contact.a.index)].name.c_str(),
                contact.n_AB_W.dot(contact.force_W), contact.p_WQ.x(), contact.p_WQ.y());
  }
  return 0;
}
