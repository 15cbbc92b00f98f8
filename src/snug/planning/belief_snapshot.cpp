// BeliefSnapshot: the worlds of a belief, and what tells two beliefs apart.
#include "snug/planning/belief_snapshot.hpp"

#include <algorithm>
#include <unordered_set>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/hash.hpp"
#include "snug/model/scenario_changes.hpp"
#include "snug/planning/belief_json.hpp"

namespace snug::planning {
namespace {

/// Times the scenario's: 0.1 mm/s by default. What is drawn for a world moves boxes by far more.
constexpr double kCoarseTolerance = 10.0;

/// Without boxes and orders that do not come: they would take time and change what is drawn of those that do.
model::Scenario order_alone(model::Scenario scenario, const std::string& sequence) {
  std::unordered_set<std::string> wanted;
  for (const model::Item& item : cell::require_sequence(scenario, sequence).items) wanted.insert(item.parcel);
  if (wanted.empty()) return scenario;
  std::erase_if(scenario.parcels, [&](const model::Parcel& one) { return !wanted.contains(one.id); });
  std::erase_if(scenario.sequences, [&](const model::Sequence& one) { return one.name != sequence; });
  return scenario;
}

}  // namespace

std::vector<World> draw_worlds(const model::Scenario& scenario, const std::string& sequence, std::uint64_t seed,
                               int samples) {
  const Rng rng(seed);
  const model::Scenario nominal = cell::with_fixed_arrivals(order_alone(scenario, sequence), sequence);
  const double longest = scenario.rehearsal.coarse_steps * scenario.time_step;
  const auto coarse = [longest](const model::Scenario& fine) {
    model::Scenario result = model::with_time_step(fine, longest);
    result.solver.tolerance *= kCoarseTolerance;
    return result;
  };
  std::vector<World> worlds{{coarse(nominal), {}, 1.0}};
  for (int i = 0; i < samples; ++i) {
    const Rng own = rng.split("sample " + std::to_string(i));
    worlds.push_back({coarse(cell::draw_scenario(nominal, sequence, own)), {}, 1.0});
  }
  const std::size_t items = cell::require_sequence(worlds[0].scenario, sequence).items.size();
  for (World& world : worlds) world.X_WP.resize(items);
  return worlds;
}

void set_obstacles(const BeliefSnapshot& belief, World& world) {
  world.scenario.bodies.resize(belief.scenario.bodies.size());
  int number = 0;
  for (const geometry::Aabb& one : belief.obstacle_bodies) {
    model::Body body;
    body.name = "obstacle" + std::to_string(++number);
    body.kind = model::BodyKind::Static;
    body.material = world.scenario.parcels.front().material;
    body.X_WB.p = 0.5 * (one.lower + one.upper);
    body.shapes = {{geometry::Box{0.5 * (one.upper - one.lower)}, Pose{}}};
    world.scenario.bodies.push_back(std::move(body));
  }
}

double stiffness_after(const settings::BeliefParams& params, int stiffenings) {
  double stiffness = 1.0;
  for (int i = 0; i < stiffenings; ++i) stiffness = std::min(params.stiffest, stiffness * params.stiffer);
  return stiffness;
}

void stiffen(const settings::BeliefParams& params, int from, int to, World& world) {
  for (int i = from; i < to; ++i) {
    cell::stiffen(world.scenario, stiffness_after(params, i + 1) / stiffness_after(params, i));
  }
}

std::uint64_t hash(const BeliefSnapshot& belief) {
  Hash hash;
  hash.add(format_belief(belief));
  return hash.value();
}

}  // namespace snug::planning
