// ToteScene: planned by an agent, put down, simulated until they rest.
#include "bench/figures/internal/tote_scenes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "snug/cell/scene.hpp"
#include "snug/core/rng.hpp"
#include "snug/packing/agent.hpp"

namespace snug::bench::internal {
namespace {

constexpr double kSettle = 0.8;           // s
constexpr double kSettleAfterFall = 1.5;  // s

struct Placed {
  const model::Parcel* parcel = nullptr;
  Pose X_WP;
};

/// Where an agent that leaves a gap would put the boxes of the scenario, in a random order.
std::vector<Placed> plan(const model::Scenario& scenario, Rng& rng, int count) {
  const model::Container& container = *model::find_container(scenario, scenario.target);
  packing::AgentInput input;
  input.settings.margin = std::array{0.001, 0.003, 0.006, 0.012}[static_cast<std::size_t>(rng.index(4))];
  input.settings.min_support = 0.7;
  input.future = packing::make_future_model(scenario);
  const auto agent = packing::make_agent("margin", std::move(input));
  packing::ContainerState state = packing::make_container_state(container);
  std::vector<const model::Parcel*> order;
  for (const model::Parcel& parcel : scenario.parcels) order.push_back(&parcel);
  for (std::size_t i = order.size(); i > 1; --i)
    std::swap(order[i - 1], order[static_cast<std::size_t>(rng.index(static_cast<int>(i)))]);
  std::vector<Placed> placed;
  for (const model::Parcel* parcel : order) {
    if (static_cast<int>(placed.size()) >= count) break;
    const auto up =
        std::array{model::UpAxis::X, model::UpAxis::Z, model::UpAxis::Z}[static_cast<std::size_t>(rng.index(3))];
    model::Item arrival;
    arrival.parcel = parcel->id;
    arrival.up = up;
    const packing::Item item = packing::make_item(scenario, arrival);
    const auto decision = agent->decide(state, item);
    if (!decision) continue;
    // Not always the best: scenes differ more.
    const auto choice =
        static_cast<std::size_t>(rng.index(static_cast<int>(std::min<std::size_t>(3, decision->candidates.size()))));
    const packing::Candidate& candidate = decision->candidates[choice];
    state = packing::with_candidate(std::move(state), item, candidate);
    placed.push_back({parcel, container.X_WT * candidate.placement.X_TP});
  }
  return placed;
}

/// The scenario with these boxes as free bodies.
model::Scenario with_bodies(const model::Scenario& scenario, const std::vector<Placed>& placed) {
  model::Scenario scene = scenario;
  for (const Placed& one : placed) {
    model::Body body;
    body.name = one.parcel->id;
    body.parcel = one.parcel->id;
    body.shapes = {{geometry::Box{0.5 * model::collision_size(scenario, *one.parcel)}, {}}};
    body.material = one.parcel->material;
    body.inertia = one.parcel->inertia;
    body.X_WB = one.X_WP;
    scene.bodies.push_back(body);
  }
  return scene;
}

void settle(const model::Scenario& scenario, std::vector<Placed>& placed, double seconds) {
  cell::Scene scene(with_bodies(scenario, placed));
  for (int i = static_cast<int>(seconds / scenario.time_step); i > 0; --i) (void)scene.advance();
  for (Placed& one : placed) {
    one.X_WP = physics::pose_of(scene.world().model, scene.state(), cell::find_body(scene.world(), one.parcel->id));
  }
}

double top_of(const Placed& placed) {
  return placed.X_WP.p.z() + (placed.X_WP.R.cwiseAbs() * (0.5 * placed.parcel->size)).z();
}

/// Lifts a box out of the heap and lets it go somewhere else over it.
void disturb(const model::Scenario& scenario, Rng& rng, Disturbance disturbance, Placed& box, double top) {
  const model::Container& container = *model::find_container(scenario, scenario.target);
  const bool is_tipped = disturbance == Disturbance::Tipped;
  Matrix3 R = exp_rotation(Vector3(0, 0, rng.uniform(-std::numbers::pi, std::numbers::pi))) * box.X_WP.R;
  if (is_tipped) {
    const double y = rng.uniform(-2, 2), x = rng.uniform(-2, 2);
    R = exp_rotation(Vector3(x, y, 0)) * R;
  }
  const Vector3 reach = R.cwiseAbs() * (0.5 * box.parcel->size);
  const auto within = [&](double half, double r) {
    const double room = std::max(0.0, half - r - 0.003);
    return rng.uniform(-room, room);
  };
  const Vector3 p_T(within(0.5 * container.inner_size.x(), reach.x()),
                    within(0.5 * container.inner_size.y(), reach.y()), 0.0);
  box.X_WP = {R, container.X_WT * p_T};
  box.X_WP.p.z() = top + reach.z() + 0.005;
}

}  // namespace

ToteScene make_tote_scene(const model::Scenario& scenario, std::uint64_t seed, int count, Disturbance disturbance) {
  Rng rng = Rng(seed).split("tote scene");
  std::vector<Placed> placed = plan(scenario, rng, count);
  for (Placed& one : placed) {  // a little off, and a little above
    const double y = rng.uniform(-0.4e-3, 0.4e-3), x = rng.uniform(-0.4e-3, 0.4e-3);
    one.X_WP.p += Vector3(x, y, 0.5e-3);
    one.X_WP.R = exp_rotation(Vector3(0, 0, rng.uniform(-0.004, 0.004))) * one.X_WP.R;
  }
  settle(scenario, placed, kSettle);
  ToteScene scene;
  for (const Placed& one : placed)
    scene.boxes.push_back(
        {one.parcel->id, model::collision_size(scenario, *one.parcel), one.X_WP, false, one.X_WP, false});
  if (disturbance == Disturbance::None || placed.empty()) return scene;
  // One of the three highest.
  std::vector<std::size_t> order(placed.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return top_of(placed[a]) > top_of(placed[b]); });
  const std::size_t chosen =
      order[static_cast<std::size_t>(rng.index(static_cast<int>(std::min<std::size_t>(3, order.size()))))];
  if (disturbance == Disturbance::Taken) {
    scene.boxes[chosen].is_gone = true;
    placed.erase(placed.begin() + static_cast<std::ptrdiff_t>(chosen));
  } else {
    disturb(scenario, rng, disturbance, placed[chosen], top_of(placed[order.front()]));
    scene.boxes[chosen].was_disturbed = true;
  }
  settle(scenario, placed, kSettleAfterFall);
  for (const Placed& one : placed)
    for (SceneBox& box : scene.boxes)
      if (box.id == one.parcel->id) box.X_WP = one.X_WP;
  return scene;
}

}  // namespace snug::bench::internal
