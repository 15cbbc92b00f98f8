// Belief: what the session takes the cell for: a nominal world and sampled ones, corrected by what is perceived.
#include "snug/session/belief.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/check.hpp"

namespace snug::session {
namespace {

constexpr double kSameBody = 0.0015;  ///< m, obstacles' bodies that differ by less stay as they are

Matrix6 unseen_covariance(const settings::BeliefParams& params) {
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal() << Vector3::Constant(params.unseen_position * params.unseen_position),
      Vector3::Constant(params.unseen_rotation * params.unseen_rotation);
  return covariance;
}

/// A pose drawn from an estimate, where the errors that poses have in common are `common` standard deviations.
Pose drawn(const perception::PoseEstimate& seen, const CommonDraw& common, Rng& rng) {
  const Matrix6 own = seen.covariance - seen.common * seen.common.transpose();
  Vector6 error = seen.common * common;
  for (int i = 0; i < 6; ++i) error[i] += std::sqrt(std::max(0.0, own(i, i))) * rng.normal();
  return {exp_rotation(error.tail<3>()) * seen.X_WP.R, seen.X_WP.p + error.head<3>()};
}

Pose container_pose(const model::Scenario& scenario) {
  const model::Container* container = model::find_container(scenario, scenario.target);
  return container != nullptr ? container->X_WT : Pose{};
}

/// The same bodies but for noise: worlds are not built anew for that.
bool are_alike(const std::vector<geometry::Aabb>& a, const std::vector<geometry::Aabb>& b) {
  return std::ranges::equal(a, b, [](const geometry::Aabb& one, const geometry::Aabb& other) {
    return (one.lower - other.lower).cwiseAbs().maxCoeff() < kSameBody &&
           (one.upper - other.upper).cwiseAbs().maxCoeff() < kSameBody;
  });
}

}  // namespace

Belief::Belief(const model::Scenario& scenario, const std::string& sequence, const BeliefSettings& settings)
    : obstacles_(container_pose(scenario)), rng_(Rng(settings.seed).split("belief")) {
  now_.scenario = scenario;
  now_.sequence = sequence;
  now_.seed = settings.seed;
  now_.simulation = settings.simulation;
  now_.worlds = planning::draw_worlds(scenario, sequence, settings.seed, settings.samples);
  const model::Sequence& order = *model::find_sequence(nominal(), sequence);
  now_.items = packing::make_items(nominal(), order);
  now_.boxes.resize(order.items.size());
  for (std::size_t i = 0; i < order.items.size() && scenario.aligner; ++i) {
    const Pose X_WP = cell::arrival_pose(nominal(), order.items[i]);
    now_.items[i].arrival = packing::nearest_orientation(scenario.aligner->X_WA.R.transpose() * X_WP.R);
  }
  for (std::size_t w = 0; w < now_.worlds.size(); ++w) {
    Filter& filter = filters_.emplace_back();
    filter.predicted.resize(order.items.size());
    if (w == 0) continue;
    Rng sensors = Rng(settings.seed).split("sample " + std::to_string(w - 1)).split("sensors");
    for (double& normal : filter.common) normal = sensors.normal();
  }
}

std::optional<model::ItemIndex> Belief::find(const std::string& id) const {
  const auto found = std::ranges::find(now_.items, id, &packing::Item::id);
  if (found == now_.items.end()) return std::nullopt;
  return model::ItemIndex(static_cast<std::size_t>(found - now_.items.begin()));
}

std::vector<perception::Expectation> Belief::expectations() const {
  std::vector<perception::Expectation> expected;
  for (std::size_t i = 0; i < now_.boxes.size(); ++i) {
    if (!now_.boxes[i]) continue;
    const std::string& id = now_.items[i].id;
    const std::optional<Pose>& predicted = filters_[0].predicted[i];
    expected.push_back({id, model::collision_size(nominal(), *model::find_parcel(nominal(), id)),
                        is_prediction_new_ && predicted ? *predicted : now_.boxes[i]->X_WP});
  }
  return expected;
}

void Belief::arrives(model::ItemIndex item) {
  for (planning::World& world : now_.worlds) {
    const model::Sequence& sequence = *model::find_sequence(world.scenario, now_.sequence);
    world.X_WP[item.slot()] = cell::arrival_pose(world.scenario, sequence.items[item.slot()]);
  }
  now_.boxes[item.slot()] =
      planning::BelievedBox{*now_.worlds[0].X_WP[item.slot()], unseen_covariance(nominal().belief), false};
}

void Belief::forget(model::ItemIndex item) {
  now_.boxes[item.slot()].reset();
  for (planning::World& world : now_.worlds) world.X_WP[item.slot()].reset();
  for (Filter& filter : filters_) filter.predicted[item.slot()].reset();
}

void Belief::measure(model::ItemIndex item, const perception::PoseEstimate& seen) {
  const std::string& id = now_.items[item.slot()].id;
  for (std::size_t w = 0; w < now_.worlds.size(); ++w) {
    model::Scenario& scenario = now_.worlds[w].scenario;
    const auto parcel = std::ranges::find(scenario.parcels, id, &model::Parcel::id);
    SNUG_CHECK(parcel != scenario.parcels.end(), "every item is a parcel");
    // What is seen is the box as it collides.
    Vector3 size = *seen.size + Vector3::Constant(scenario.parcel_clearance);
    for (double& edge : size) edge += w > 0 ? seen.size_deviation * rng_.normal() : 0.0;
    parcel->size = size.cwiseMax(0.5 * parcel->size);
  }
}

void Belief::see(const perception::Observation& observation) {
  for (const perception::PoseEstimate& seen : observation.seen) {
    const auto item = find(seen.item);
    if (!item) continue;
    std::optional<planning::BelievedBox>& box = now_.boxes[item->slot()];
    const bool is_new = !box || !box->was_seen;
    box = planning::BelievedBox{seen.X_WP, seen.covariance, true};
    if (is_new && seen.size) measure(*item, seen);
    for (std::size_t w = 0; w < now_.worlds.size(); ++w) {
      now_.worlds[w].X_WP[item->slot()] = w == 0 ? seen.X_WP : drawn(seen, filters_[w].common, rng_);
    }
  }
  for (const std::string& id : observation.not_seen) {
    const auto item = find(id);
    if (!item || !box(*item)) continue;
    planning::BelievedBox& unseen = *now_.boxes[item->slot()];
    unseen.was_seen = false;
    unseen.covariance = unseen_covariance(nominal().belief);
    if (!is_prediction_new_ || !is_prediction_sound_) continue;
    for (std::size_t w = 0; w < now_.worlds.size(); ++w) {
      const std::optional<Pose>& predicted = filters_[w].predicted[item->slot()];
      if (!predicted) continue;
      now_.worlds[w].X_WP[item->slot()] = predicted;
      if (w == 0) unseen.X_WP = *predicted;
    }
  }
  for (const std::string& id : observation.missing) {
    if (const auto item = find(id)) forget(*item);
  }
  is_prediction_new_ = false;
  see_obstacles(observation);
  for (std::size_t i = 0; i < now_.items.size(); ++i) {
    if (now_.boxes[i]) now_.items[i].size = model::find_parcel(nominal(), now_.items[i].id)->size;
  }
}

std::vector<Solid> Belief::solids(const perception::Observation& seen) const {
  std::vector<Solid> solids;
  for (const perception::Expectation& one : expectations()) {
    const perception::PoseEstimate* estimate = perception::find(seen, one.item);
    solids.push_back({estimate != nullptr ? estimate->X_WP : *one.X_WP, one.size});
  }
  return solids;
}

bool Belief::has_new_obstacle(const perception::Observation& seen) const {
  return obstacles_.has_news(obstacles_.find_foreign(seen, solids(seen)));
}

void Belief::drop_unconfirmed(perception::Observation& seen, const perception::Observation& before) const {
  if (!seen.obstacles) return;
  const std::vector<perception::Obstacle> others = before.obstacles.value_or(std::vector<perception::Obstacle>{});
  std::erase_if(*seen.obstacles, [&](const perception::Obstacle& one) { return obstacles_.has_news({one}, others); });
}

void Belief::see_obstacles(const perception::Observation& seen) {
  const std::vector<Solid> boxes = solids(seen);
  obstacles_.see(seen, obstacles_.find_foreign(seen, boxes), boxes);
  now_.obstacles = obstacles_.regions();
  std::vector<geometry::Aabb> bodies = clear_of(now_.obstacles, boxes);
  if (are_alike(bodies, now_.obstacle_bodies)) return;
  now_.obstacle_bodies = std::move(bodies);
  for (planning::World& world : now_.worlds) planning::set_obstacles(now_, world);
}

void Belief::expect(const std::vector<std::vector<std::optional<Pose>>>& predicted) {
  SNUG_CHECK(predicted.size() == filters_.size(), "a prediction of every world");
  for (std::size_t w = 0; w < filters_.size(); ++w) filters_[w].predicted = predicted[w];
  is_prediction_new_ = is_prediction_sound_ = true;
}

void Belief::expect_on_the_way(model::ItemIndex item, const Pose& X_WP) {
  std::vector<std::optional<Pose>> predicted(now_.boxes.size());
  predicted[item.slot()] = X_WP;
  expect(std::vector<std::vector<std::optional<Pose>>>(filters_.size(), predicted));
}

void Belief::forget_let_go() {
  const model::ItemIndex item = std::exchange(released_, model::ItemIndex());
  if (item.is_valid() && box(item) && !box(item)->was_seen) forget(item);
}

void Belief::stiffen() {
  const settings::BeliefParams& params = nominal().belief;
  const int next = now_.stiffenings + 1;
  if (planning::stiffness_after(params, next) <= planning::stiffness_after(params, now_.stiffenings)) return;
  for (planning::World& world : now_.worlds) planning::stiffen(params, now_.stiffenings, next, world);
  now_.stiffenings = next;
}

void Belief::weigh(model::ItemIndex item) {
  std::vector<planning::World>& worlds = now_.worlds;
  if (!box(item) || !box(item)->was_seen || worlds.size() < 2) return;
  const planning::BelievedBox& is = *box(item);
  const settings::BeliefParams& params = nominal().belief;
  const double variance = params.model_error * params.model_error + is.covariance.topLeftCorner<3, 3>().trace() / 3.0;
  double sum = 0.0;
  for (std::size_t w = 1; w < worlds.size(); ++w) {
    const std::optional<Pose>& predicted = filters_[w].predicted[item.slot()];
    const double off = predicted ? (predicted->p - is.X_WP.p).squaredNorm() : 25.0 * variance;
    worlds[w].weight *= std::exp(-0.5 * std::min(off / variance, 25.0) / 3.0);  // three coordinates, not independent
    sum += worlds[w].weight;
  }
  const double count = static_cast<double>(worlds.size() - 1);
  for (std::size_t w = 1; w < worlds.size(); ++w) {
    const double relative = sum > 0.0 ? worlds[w].weight * count / sum : 1.0;
    worlds[w].weight = params.least_weight + (1.0 - params.least_weight) * relative;
  }
}

}  // namespace snug::session
