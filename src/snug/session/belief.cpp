// Belief: what the session takes the cell for: a nominal world and sampled ones, corrected by what is perceived.
#include "snug/session/belief.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/check.hpp"
#include "snug/core/parallel.hpp"

namespace snug::session {
namespace {

constexpr double kSameBody = 0.0015;  ///< m, obstacles' bodies that differ by less stay as they are

model::Scenario coarse(model::Scenario scenario, int factor) {
  const double step = factor * scenario.time_step, ticks = scenario.controller.tick / step;
  if (factor > 1 && ticks > 0.99 && std::abs(ticks - std::round(ticks)) < 1e-9) scenario.time_step = step;
  return scenario;
}

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

int index_of(const model::Sequence& sequence, const std::string& item) {
  const auto found = std::ranges::find(sequence.items, item, &model::Item::parcel);
  return found == sequence.items.end() ? -1 : static_cast<int>(found - sequence.items.begin());
}

}  // namespace

Belief::Belief(const model::Scenario& scenario, const std::string& sequence, const BeliefSettings& settings)
    : settings_(settings),
      sequence_name_(sequence),
      own_bodies_(scenario.bodies.size()),
      obstacles_(container_pose(scenario)),
      rng_(Rng(settings.seed).split("belief")) {
  const Rng rng(settings.seed);
  const model::Scenario nominal = cell::with_fixed_arrivals(scenario, sequence);
  worlds_.push_back({coarse(nominal, scenario.rehearsal.coarse_steps), {}, {}});
  sequence_ = *model::find_sequence(worlds_[0].scenario, sequence);
  for (int i = 0; i < settings.samples; ++i) {
    const Rng own = rng.split("sample " + std::to_string(i));
    World& world = worlds_.emplace_back(
        World{coarse(cell::draw_scenario(nominal, sequence, own), scenario.rehearsal.coarse_steps), {}, {}});
    Rng sensors = own.split("sensors");
    for (double& normal : world.common) normal = sensors.normal();
  }
  for (World& world : worlds_) {
    world.poses.resize(sequence_.items.size());
    world.predicted.resize(sequence_.items.size());
  }
  weights_.assign(worlds_.size(), 1.0);
  rollouts_.resize(worlds_.size());
  boxes_.resize(sequence_.items.size());
}

std::vector<perception::Expectation> Belief::expectations() const {
  std::vector<perception::Expectation> expected;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    if (!boxes_[i]) continue;
    const std::string& id = sequence_.items[i].parcel;
    const std::optional<Pose>& predicted = worlds_[0].predicted[i];
    expected.push_back({id, model::collision_size(nominal(), *model::find_parcel(nominal(), id)),
                        is_prediction_new_ && predicted ? *predicted : boxes_[i]->X_WP});
  }
  return expected;
}

void Belief::arrives(int item) {
  const auto i = static_cast<std::size_t>(item);
  for (World& world : worlds_) {
    const model::Sequence& sequence = *model::find_sequence(world.scenario, sequence_name_);
    world.poses[i] = cell::arrival_pose(world.scenario, sequence.items[i]);
  }
  boxes_[i] = BelievedBox{*worlds_[0].poses[i], unseen_covariance(nominal().belief), false};
}

void Belief::forget(int item) {
  const auto i = static_cast<std::size_t>(item);
  boxes_[i].reset();
  for (World& world : worlds_) world.poses[i] = world.predicted[i] = std::nullopt;
}

void Belief::measure(int item, const perception::PoseEstimate& seen) {
  const std::string& id = sequence_.items[static_cast<std::size_t>(item)].parcel;
  for (std::size_t w = 0; w < worlds_.size(); ++w) {
    const auto parcel = std::ranges::find(worlds_[w].scenario.parcels, id, &model::Parcel::id);
    SNUG_CHECK(parcel != worlds_[w].scenario.parcels.end(), "every item is a parcel");
    // What is seen is the box as it collides.
    Vector3 size = *seen.size + Vector3::Constant(worlds_[w].scenario.parcel_clearance);
    for (double& edge : size) edge += w > 0 ? seen.size_deviation * rng_.normal() : 0.0;
    size = size.cwiseMax(0.5 * parcel->size);
    if (parcel->size == size) continue;
    parcel->size = size;
    worlds_[w].is_stale = true;
  }
}

void Belief::see(const perception::Observation& observation) {
  for (const perception::PoseEstimate& seen : observation.seen) {
    const int item = index_of(sequence_, seen.item);
    if (item < 0) continue;
    const auto i = static_cast<std::size_t>(item);
    const bool is_new = !boxes_[i] || !boxes_[i]->was_seen;
    boxes_[i] = BelievedBox{seen.X_WP, seen.covariance, true};
    if (is_new && seen.size) measure(item, seen);
    for (std::size_t w = 0; w < worlds_.size(); ++w)
      worlds_[w].poses[i] = w == 0 ? seen.X_WP : drawn(seen, worlds_[w].common, rng_);
  }
  for (const std::string& id : observation.not_seen) {
    const int item = index_of(sequence_, id);
    if (item < 0 || !boxes_[static_cast<std::size_t>(item)]) continue;
    const auto i = static_cast<std::size_t>(item);
    boxes_[i]->was_seen = false;
    boxes_[i]->covariance = unseen_covariance(nominal().belief);
    if (!is_prediction_new_ || !is_prediction_sound_) continue;
    if (worlds_[0].predicted[i]) boxes_[i]->X_WP = *worlds_[0].predicted[i];
    for (World& world : worlds_) {
      if (world.predicted[i]) world.poses[i] = world.predicted[i];
    }
  }
  for (const std::string& id : observation.missing) {
    const int item = index_of(sequence_, id);
    if (item >= 0) forget(item);
  }
  is_prediction_new_ = false;
  see_obstacles(observation);
}

std::vector<Solid> Belief::solids(const perception::Observation& look) const {
  std::vector<Solid> solids;
  for (const perception::Expectation& one : expectations()) {
    const perception::PoseEstimate* seen = perception::find(look, one.item);
    solids.push_back({seen != nullptr ? seen->X_WP : *one.X_WP, one.size});
  }
  return solids;
}

bool Belief::has_new_obstacle(const perception::Observation& look) const {
  return obstacles_.has_news(obstacles_.find_foreign(look, solids(look)));
}

void Belief::drop_unconfirmed(perception::Observation& look, const perception::Observation& before) const {
  if (!look.obstacles) return;
  const std::vector<perception::Obstacle> others = before.obstacles.value_or(std::vector<perception::Obstacle>{});
  std::erase_if(*look.obstacles, [&](const perception::Obstacle& one) { return obstacles_.has_news({one}, others); });
}

void Belief::see_obstacles(const perception::Observation& look) {
  const std::vector<Solid> boxes = solids(look);
  obstacles_.see(look, obstacles_.find_foreign(look, boxes), boxes);
  const std::vector<geometry::Aabb> bodies = clear_of(obstacles_.regions(), boxes);
  if (are_alike(bodies, obstacle_bodies_)) return;
  obstacle_bodies_ = bodies;
  for (World& world : worlds_) {
    world.scenario.bodies.resize(own_bodies_);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      model::Body body;
      body.name = "obstacle" + std::to_string(i + 1);
      body.kind = model::BodyKind::Static;
      body.material = world.scenario.parcels.front().material;
      body.X_WB.p = 0.5 * (bodies[i].lower + bodies[i].upper);
      body.shapes = {{geometry::Box{0.5 * (bodies[i].upper - bodies[i].lower)}, Pose{}}};
      world.scenario.bodies.push_back(std::move(body));
    }
    world.is_stale = true;
  }
}

void Belief::expect(const std::vector<std::vector<std::optional<Pose>>>& predicted) {
  SNUG_CHECK(predicted.size() == worlds_.size(), "a prediction of every world");
  for (std::size_t w = 0; w < worlds_.size(); ++w) worlds_[w].predicted = predicted[w];
  is_prediction_new_ = is_prediction_sound_ = true;
}

void Belief::expect_on_the_way(int item, const Pose& X_WP) {
  std::vector<std::optional<Pose>> predicted(boxes_.size());
  predicted[static_cast<std::size_t>(item)] = X_WP;
  expect(std::vector<std::vector<std::optional<Pose>>>(worlds_.size(), predicted));
}

void Belief::stiffen() {
  const double stiffness = std::min(nominal().belief.stiffest, stiffness_ * nominal().belief.stiffer);
  if (stiffness <= stiffness_) return;
  for (World& world : worlds_) {
    cell::stiffen(world.scenario, stiffness / stiffness_);
    world.is_stale = true;
  }
  stiffness_ = stiffness;
}

void Belief::weigh(int item) {
  const auto i = static_cast<std::size_t>(item);
  if (!boxes_[i] || !boxes_[i]->was_seen || worlds_.size() < 2) return;
  const settings::BeliefParams& params = nominal().belief;
  const double variance =
      params.model_error * params.model_error + boxes_[i]->covariance.topLeftCorner<3, 3>().trace() / 3.0;
  double sum = 0.0;
  for (std::size_t w = 1; w < worlds_.size(); ++w) {
    const std::optional<Pose>& predicted = worlds_[w].predicted[i];
    const double off = predicted ? (predicted->p - boxes_[i]->X_WP.p).squaredNorm() : 25.0 * variance;
    weights_[w] *= std::exp(-0.5 * std::min(off / variance, 25.0) / 3.0);  // three coordinates, not independent
    sum += weights_[w];
  }
  const double count = static_cast<double>(worlds_.size() - 1);
  for (std::size_t w = 1; w < worlds_.size(); ++w) {
    const double share = sum > 0.0 ? weights_[w] * count / sum : 1.0;
    weights_[w] = params.least_weight + (1.0 - params.least_weight) * share;
  }
}

cell::CellAnchor Belief::anchor(const World& world, const plant::Feedback& robot) const {
  cell::CellAnchor anchor;
  anchor.X_WE = robot.X_WE;
  anchor.q = robot.q;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    if (boxes_[i] && world.poses[i]) anchor.boxes.push_back({static_cast<int>(i), *world.poses[i]});
  }
  return anchor;
}

const std::vector<std::unique_ptr<Rollout>>& Belief::take_up(const plant::Feedback& robot) {
  parallel_for(static_cast<int>(worlds_.size()), settings_.threads, [&](int index, int) {
    const auto w = static_cast<std::size_t>(index);
    World& world = worlds_[w];
    if (world.is_stale || !rollouts_[w]) {
      cell::SimulationOptions options = settings_.simulation;
      if (w > 0) options.robot.clear();
      rollouts_[w] = std::make_unique<Rollout>(world.scenario, sequence_name_, options);
      world.is_stale = false;
    }
    rollouts_[w]->take_up(anchor(world, robot), nominal().belief.rest);
  });
  return rollouts_;
}

}  // namespace snug::session
