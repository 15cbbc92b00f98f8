// CellWorld: a Scenario as bodies of the physics, with the names to find them again.
#include "snug/cell/world_builder.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/core/rng.hpp"

namespace snug::cell {
namespace {

using physics::BodyId;
using physics::BodyModel;
using physics::Geom;

physics::Bearing bearing_of(model::Bearing bearing) {
  switch (bearing) {
    case model::Bearing::Corners:
      return physics::Bearing::Corners;
    case model::Bearing::Edges:
      return physics::Bearing::Edges;
    case model::Bearing::Face:
      break;
  }
  return physics::Bearing::Face;
}

physics::ContactLaw law_of(const model::Scenario& scenario, int a, int b) {
  physics::ContactLaw law;
  const auto params = model::find_contact(scenario, model::MaterialId{a}, model::MaterialId{b});
  if (!params) return law;  // a pair that cannot meet
  law.friction = params->friction;
  law.restitution = params->restitution;
  law.stiffness = params->stiffness.value_or(0.0);
  law.damping = params->damping.value_or(0.0);
  law.travel = params->travel.value_or(0.0);
  law.stiffness_beyond = params->stiffness_beyond.value_or(0.0);
  law.full_area = params->full_area.value_or(0.0);
  law.edge_share = params->edge_share.value_or(law.edge_share);
  law.rolling_resistance = params->rolling_resistance;
  law.torsional_friction = params->torsional_friction;
  law.damping_ratio = params->damping_ratio.value_or(0.0);
  law.edge_friction = params->edge_friction;
  law.bearing = bearing_of(params->bearing);
  return law;
}

void fill_laws(const model::Scenario& scenario, physics::WorldModel& world) {
  world.material_count = std::max(1, static_cast<int>(scenario.materials.size()));
  world.laws.clear();
  for (int a = 0; a < world.material_count; ++a) {
    for (int b = 0; b < world.material_count; ++b) {
      world.laws.push_back(scenario.materials.empty() ? physics::ContactLaw{} : law_of(scenario, a, b));
    }
  }
}

void fill_settings(const model::Scenario& scenario, physics::WorldModel& world) {
  world.gravity = scenario.gravity;
  physics::StepSettings& to = world.settings;
  const model::SolverSettings& from = scenario.solver;
  to.dt = scenario.time_step;
  to.tolerance = from.tolerance;
  to.max_sweeps = from.max_sweeps;
  to.restitution_threshold = from.restitution_threshold;
  to.position_slop = from.position_slop;
  to.contact_margin = from.contact_margin;
  to.sleep = {from.sleep.enabled, from.sleep.linear_speed, from.sleep.angular_speed, from.sleep.time};
}

std::vector<Geom> geoms_of(const std::vector<model::PlacedShape>& shapes, model::MaterialId material,
                           bool touches_held_body = true) {
  std::vector<Geom> geoms;
  for (const model::PlacedShape& placed : shapes) {
    geoms.push_back({placed.shape, placed.X_BG, material.index, touches_held_body});
  }
  return geoms;
}

physics::BodyKind kind_of(model::BodyKind kind) {
  switch (kind) {
    case model::BodyKind::Static:
      return physics::BodyKind::Static;
    case model::BodyKind::Kinematic:
      return physics::BodyKind::Kinematic;
    case model::BodyKind::Dynamic:
      break;
  }
  return physics::BodyKind::Dynamic;
}

BodyId add(CellWorld& world, BodyModel body, std::string type = "") {
  world.model.bodies.push_back(std::move(body));
  world.types.push_back(std::move(type));
  return BodyId{static_cast<int>(world.model.bodies.size()) - 1};
}

BodyModel static_body(std::string name, const Pose& X_WB, std::vector<Geom> geoms) {
  BodyModel body;
  body.name = std::move(name);
  body.kind = physics::BodyKind::Static;
  body.X_WB = X_WB;
  body.geoms = std::move(geoms);
  return body;
}

BodyModel box_body(std::string name, const Vector3& size, const SpatialInertia& inertia, model::MaterialId material) {
  BodyModel body;
  body.name = std::move(name);
  body.inertia = inertia;
  body.geoms = {{geometry::Box{0.5 * size}, Pose{}, material.index, true}};
  return body;
}

SpatialInertia uniform_box(double mass, const Vector3& size) {
  SpatialInertia inertia;
  inertia.mass = mass;
  const Vector3 square = size.cwiseAbs2();
  inertia.inertia =
      (Vector3(square.y() + square.z(), square.x() + square.z(), square.x() + square.y()) * mass / 12.0).asDiagonal();
  return inertia;
}

void add_tool(const model::Scenario& scenario, CellWorld& world) {
  if (!scenario.tool) return;
  BodyModel body;
  body.name = "tool";
  body.kind = physics::BodyKind::Kinematic;
  body.X_WB = scenario.controller.X_WE_start;
  body.geoms = geoms_of(scenario.tool->rod_shapes, scenario.tool->rod_material);
  for (const Geom& geom : geoms_of(scenario.tool->cup_shapes, scenario.tool->cup_material, false)) {
    body.geoms.push_back(geom);
  }
  world.tool = add(world, std::move(body));
}

/// What hangs behind the sensor is the tool, which add_tool adds.
void add_arm(const model::Scenario& scenario, const robot::ArmModel& arm, const robot::JointVector& q,
             CellWorld& world) {
  const robot::ArmPose at = robot::forward(arm, q);
  const int sensor = robot::find_link(arm, scenario.robot->sensor_frame);
  for (int i = 0; i < static_cast<int>(arm.links.size()); ++i) {
    const robot::Link& link = arm.links[static_cast<std::size_t>(i)];
    if (link.shapes.empty() || robot::is_behind(arm, i, sensor)) continue;
    BodyModel body;
    body.name = "robot/" + link.name;
    body.kind = link.segment == 0 ? physics::BodyKind::Static : physics::BodyKind::Kinematic;
    body.X_WB = robot::link_pose(arm, at, i);
    body.geoms = geoms_of(link.shapes, scenario.tool->rod_material);
    world.arm.push_back({add(world, std::move(body)), i});
  }
}

}  // namespace

DropPlan plan_drops(const model::Scenario& scenario) {
  DropPlan plan;
  if (!scenario.drops) return plan;
  const model::Drops& drops = *scenario.drops;
  const model::Container& container = *model::find_container(scenario, drops.container);
  Rng rng = Rng(drops.seed).split("drops");
  for (int i = 0; i < drops.count; ++i) {
    DropPlan::Box box;
    const std::string& type = drops.types[static_cast<std::size_t>(rng.index(static_cast<int>(drops.types.size())))];
    while (scenario.parcel_types[static_cast<std::size_t>(box.type)].name != type) ++box.type;
    const Vector3& size = scenario.parcel_types[static_cast<std::size_t>(box.type)].size;
    Vector3 room;
    do {  // yaw, then place, both uniform among those that fit
      box.yaw = rng.uniform(0.0, 2.0 * std::numbers::pi);
      const double c = std::abs(std::cos(box.yaw)), s = std::abs(std::sin(box.yaw));
      room = 0.5 * (container.inner_size - Vector3(c * size.x() + s * size.y(), s * size.x() + c * size.y(), 0.0));
    } while (room.x() < 0.0 || room.y() < 0.0);
    const double y = rng.uniform(-room.y(), room.y()), x = rng.uniform(-room.x(), room.x());
    box.p_TP_xy = Vector3(x, y, 0.0);
    plan.boxes.push_back(box);
  }
  return plan;
}

CellWorld build_world(const model::Scenario& scenario, const WorldOptions& options) {
  CellWorld world;
  fill_settings(scenario, world.model);
  fill_laws(scenario, world.model);
  for (const model::Container& container : scenario.containers) {
    const BodyId id = add(
        world, static_body(container.name, container.X_WT, geoms_of(model::make_walls(container), container.material)));
    if (container.name == scenario.target) world.container = id;
  }
  if (scenario.aligner && !scenario.aligner->plates.empty()) {
    add(world,
        static_body("aligner", scenario.aligner->X_WA, geoms_of(scenario.aligner->plates, scenario.aligner->material)));
  }
  for (const model::Body& from : scenario.bodies) {
    BodyModel body;
    body.name = from.name;
    body.kind = kind_of(from.kind);
    body.inertia = from.inertia;
    body.X_WB = from.X_WB;
    body.geoms = geoms_of(from.shapes, from.material);
    for (Geom& geom : body.geoms) geom.surface_velocity = from.surface_velocity;
    world.bodies.push_back(add(world, std::move(body)));
  }
  if (options.with_tool) add_tool(scenario, world);
  if (options.arm != nullptr) add_arm(scenario, *options.arm, options.q, world);
  if (options.sequence != nullptr) {
    for (const model::Item& item : options.sequence->items) {
      const model::Parcel& parcel = *model::find_parcel(scenario, item.parcel);
      world.parcels.push_back(
          add(world, box_body(parcel.id, model::collision_size(scenario, parcel), parcel.inertia, parcel.material),
              parcel.type));
    }
  }
  const DropPlan drops = plan_drops(scenario);
  for (std::size_t i = 0; i < drops.boxes.size(); ++i) {
    const model::ParcelType& type = scenario.parcel_types[static_cast<std::size_t>(drops.boxes[i].type)];
    world.drops.push_back(add(world,
                              box_body("drop" + std::to_string(i + 1), type.size, uniform_box(type.mass, type.size),
                                       scenario.drops->material),
                              type.name));
  }
  world.model.finalize();
  return world;
}

physics::WorldState make_initial_state(const model::Scenario& scenario, const CellWorld& world) {
  physics::WorldState state = physics::make_state(world.model);
  for (const BodyId id : world.parcels) physics::set_present(state, id, false);
  for (const BodyId id : world.drops) physics::set_present(state, id, false);
  for (std::size_t i = 0; i < scenario.bodies.size(); ++i) {
    const model::Body& body = scenario.bodies[i];
    physics::set_twist(world.model, state, world.bodies[i], body.V_WB);
    if (body.appears_at > 0.0) physics::set_present(state, world.bodies[i], false);
  }
  int group = -1;  // those that start asleep wake together
  for (std::size_t i = 0; i < scenario.bodies.size(); ++i) {
    if (!scenario.bodies[i].is_asleep) continue;
    if (group < 0) group = world.bodies[i].index;
    state.bodies[static_cast<std::size_t>(world.bodies[i].index)].sleep_group = group;
  }
  return state;
}

BodyId find_body(const CellWorld& world, std::string_view name) {
  for (std::size_t i = 0; i < world.model.bodies.size(); ++i) {
    if (world.model.bodies[i].name == name) return BodyId{static_cast<int>(i)};
  }
  return {};
}

const std::string& name_of(const CellWorld& world, physics::BodyId body) {
  return world.model.bodies[static_cast<std::size_t>(body.index)].name;
}

}  // namespace snug::cell
