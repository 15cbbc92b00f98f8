// ForeignObjects: where there is room for one, and what presses on it.
#include "snug/simulated_plant/foreign_objects.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "snug/geometry/bounds.hpp"

namespace snug::simulated_plant {
namespace {

constexpr double kGrid = 0.010;      ///< m, between places
constexpr double kBeside = 0.003;    ///< m, to walls and boxes
constexpr double kUnderRim = 0.010;  ///< m
constexpr double kDrop = 0.001;      ///< m, over what it is put on

bool is_object(const Fault& fault) { return fault.kind == FaultKind::Object; }

}  // namespace

model::Scenario with_objects(model::Scenario scenario, const std::vector<Fault>& faults) {
  const auto count = std::ranges::count_if(faults, is_object);
  for (int i = 0; i < count && !scenario.parcels.empty(); ++i) {
    model::Body body;
    body.name = "object" + std::to_string(i + 1);
    body.shapes = {{geometry::Box{0.5 * kForeignSize}, Pose{}}};
    body.material = scenario.parcels.front().material;
    body.inertia.mass = kForeignMass;
    const Vector3 square = kForeignSize.cwiseAbs2();
    body.inertia.inertia =
        (Vector3(square.y() + square.z(), square.x() + square.z(), square.x() + square.y()) * kForeignMass / 12.0)
            .asDiagonal();
    body.appears_at = std::numeric_limits<double>::infinity();
    scenario.bodies.push_back(std::move(body));
  }
  return scenario;
}

ForeignObjects::ForeignObjects(const cell::Simulation& simulation, const std::vector<Fault>& faults, std::uint64_t seed)
    : simulation_(simulation), rng_(Rng(seed).split("foreign objects")) {
  const model::Scenario& scenario = simulation.scenario();
  if (const model::Container* container = model::find_container(scenario, scenario.target)) X_WT_ = container->X_WT;
  const auto& bodies = simulation.world().bodies;
  const auto count = static_cast<std::size_t>(std::ranges::count_if(faults, is_object));
  if (scenario.parcels.empty()) return;
  for (std::size_t i = bodies.size() - count; i < bodies.size(); ++i) {
    objects_.push_back({cell::name_of(simulation.world(), bodies[i]), bodies[i], false, false, {}, {}, 0.0});
  }
}

std::vector<Pose> ForeignObjects::free_places(const cell::CellState& state) const {
  const model::Scenario& scenario = simulation_.scenario();
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr) return {};
  const cell::CellWorld& world = simulation_.world();
  std::vector<geometry::Aabb> others;  // in T
  const auto add = [&](physics::BodyId id) {
    if (!state.world.bodies[static_cast<std::size_t>(id.index)].is_present) return;
    const Pose X_TB = X_WT_.inverse() * physics::pose_of(world.model, state.world, id);
    others.push_back(geometry::bounds(world.model.bodies[static_cast<std::size_t>(id.index)].geoms[0].shape, X_TB));
  };
  for (const physics::BodyId id : world.parcels) add(id);
  for (const ForeignObject& one : objects_) add(one.body);
  std::vector<Pose> places;
  for (const bool is_turned : {false, true}) {
    const Matrix3 R = exp_rotation(Vector3(0.0, 0.0, is_turned ? 1.57079632679489662 : 0.0));
    const Vector3 half =
        0.5 * (is_turned ? Vector3(kForeignSize.y(), kForeignSize.x(), kForeignSize.z()) : kForeignSize);
    const Vector3 room = 0.5 * container->inner_size - half - Vector3::Constant(kBeside);
    for (double y = -room.y(); y <= room.y(); y += kGrid) {
      for (double x = -room.x(); x <= room.x(); x += kGrid) {
        const Vector3 reach = half + Vector3(kBeside, kBeside, 0.0);
        double base = 0.0;
        for (const geometry::Aabb& b : others) {
          const bool is_under = b.lower.x() < x + reach.x() && b.upper.x() > x - reach.x() &&
                                b.lower.y() < y + reach.y() && b.upper.y() > y - reach.y();
          if (is_under) base = std::max(base, b.upper.z());
        }
        const auto carries = [&](const geometry::Aabb& b) {
          return base - b.upper.z() < 1e-9 && b.lower.x() < x - half.x() && b.upper.x() > x + half.x() &&
                 b.lower.y() < y - half.y() && b.upper.y() > y + half.y();
        };
        if (base > 0.0 && std::ranges::none_of(others, carries)) continue;
        if (base + 2.0 * half.z() > container->inner_size.z() - kUnderRim) continue;
        places.push_back(Pose{R, Vector3(x, y, base + half.z() + kDrop)});
      }
    }
  }
  return places;
}

const ForeignObject* ForeignObjects::put(cell::CellState& state) {
  const auto next = std::ranges::find_if(objects_, [](const ForeignObject& one) { return !one.is_in; });
  if (next == objects_.end()) return nullptr;
  const std::vector<Pose> places = free_places(state);
  if (places.empty()) return nullptr;
  next->X_TB = next->X_TB_put = places[static_cast<std::size_t>(rng_.index(static_cast<int>(places.size())))];
  next->is_in = true;
  next->has_rested = false;
  next->peak_force = 0.0;
  physics::set_present(state.world, next->body, true);
  physics::set_pose(simulation_.world().model, state.world, next->body, X_WT_ * next->X_TB);
  physics::set_twist(simulation_.world().model, state.world, next->body, Twist{});
  return &*next;
}

void ForeignObjects::note_rest() {
  for (ForeignObject& one : objects_) {
    if (!one.is_in || one.has_rested) continue;
    one.has_rested = true;
    one.X_TB_put = one.X_TB;
  }
}

void ForeignObjects::take_out(cell::CellState& state) {
  for (ForeignObject& one : objects_) {
    if (!one.is_in) continue;
    one.is_in = false;
    physics::set_present(state.world, one.body, false);
  }
}

void ForeignObjects::watch(const cell::CellState& state, const cell::CellWorkspace& work) {
  for (ForeignObject& one : objects_) {
    if (!one.is_in) continue;
    one.X_TB = X_WT_.inverse() * physics::pose_of(simulation_.world().model, state.world, one.body);
    if (!one.has_rested) continue;
    double force = 0.0;
    for (const physics::ContactReport& contact : work.physics.contacts()) {
      if (contact.a != one.body && contact.b != one.body) continue;
      const physics::BodyId other = contact.a == one.body ? contact.b : contact.a;
      const auto& world = simulation_.world();
      const bool presses = other == world.tool || std::ranges::find(world.parcels, other) != world.parcels.end();
      if (presses) force += contact.force_W.norm();
    }
    one.peak_force = std::max(one.peak_force, force);
  }
}

}  // namespace snug::simulated_plant
