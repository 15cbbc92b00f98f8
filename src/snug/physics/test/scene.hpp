// Scenes of the physics tests: boxes, a plane, a container.
#pragma once

#include <limits>
#include <string>

#include "snug/physics/world.hpp"

namespace snug::physics::test {

inline const Vector3 kBox(0.2, 0.2, 0.1);  ///< m
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

inline BodyModel box(const Vector3& size, double mass, const Vector3& p_WB) {
  BodyModel body;
  body.name = "box";
  body.inertia.mass = mass;
  const Vector3 square = size.cwiseAbs2();
  body.inertia.inertia =
      (Vector3(square.y() + square.z(), square.x() + square.z(), square.x() + square.y()) * mass / 12.0).asDiagonal();
  body.geoms = {{geometry::Box{0.5 * size}, Pose{}, 0, true}};
  body.X_WB.p = p_WB;
  return body;
}

inline BodyModel fixed_box(const Vector3& size, const Vector3& p_WB) {
  BodyModel body = box(size, 1.0, p_WB);
  body.kind = BodyKind::Static;
  body.geoms[0].material = 1;
  return body;
}

/// Material 0 boxes, 1 fixed things; without sleeping unless asked for. Bodies are added, then finalize().
inline WorldModel world(const ContactLaw& box_box, const ContactLaw& box_fixed) {
  WorldModel model;
  model.material_count = 2;
  model.laws = {box_box, box_fixed, box_fixed, box_fixed};
  model.settings.sleep.enabled = false;
  return model;
}

/// Body 0: ground with its top at z = 0.
inline WorldModel on_plane(const ContactLaw& law, const std::vector<BodyModel>& boxes) {
  WorldModel model = world(law, law);
  model.bodies.push_back(fixed_box({20.0, 20.0, 1.0}, {0.0, 0.0, -0.5}));
  for (const BodyModel& body : boxes) model.bodies.push_back(body);
  model.finalize();
  return model;
}

/// Bodies 0-4: floor and walls of 0.57 x 0.37 x 0.25 m.
inline WorldModel in_container(const std::vector<BodyModel>& boxes) {
  WorldModel model = world({0.2, 0.05, 0.0, 0.0}, {0.24, 0.1, 0.0, 0.0});
  model.bodies.push_back(fixed_box({0.59, 0.39, 0.01}, {0.0, 0.0, -0.005}));
  model.bodies.push_back(fixed_box({0.01, 0.39, 0.25}, {-0.29, 0.0, 0.125}));
  model.bodies.push_back(fixed_box({0.01, 0.39, 0.25}, {0.29, 0.0, 0.125}));
  model.bodies.push_back(fixed_box({0.57, 0.01, 0.25}, {0.0, -0.19, 0.125}));
  model.bodies.push_back(fixed_box({0.57, 0.01, 0.25}, {0.0, 0.19, 0.125}));
  for (const BodyModel& body : boxes) model.bodies.push_back(body);
  model.finalize();
  return model;
}

struct Simulation {
  const WorldModel& model;
  WorldState state;
  Workspace work;
  explicit Simulation(const WorldModel& m) : model(m), state(make_state(m)), work(m) {}
  StepReport step(const WorldInput& input = {}) { return physics::step(model, input, state, work); }
  void steps(int count) {
    for (int i = 0; i < count; ++i) (void)step();
  }
  BodyState& body(int i) { return state.bodies[static_cast<std::size_t>(i)]; }
};

/// Bodies 1-3: a stack; 4: alone in the air.
inline WorldModel tall_stack() {
  const Vector3 size(0.2, 0.2, 0.1);
  return on_plane({0.2, 0.0, 0.0, 0.0}, {box(size, 0.5, {0.0, 0.0, 0.05}), box(size, 0.5, {0.0, 0.0, 0.15}),
                                         box(size, 0.5, {0.0, 0.0, 0.25}), box(size, 0.5, {2.0, 0.0, 1.0})});
}

/// Steps until something is wrong, at most 20.
inline StepReport step_until_wrong(Simulation& run, const WorldInput& input = {}) {
  StepReport report;
  for (int i = 0; i < 20; ++i) {
    report = run.step(input);
    if (report.status != StepStatus::Converged && report.status != StepStatus::NotConverged) break;
  }
  return report;
}

}  // namespace snug::physics::test
