// Statics: a box set down at rest where it was lowered has to stay there, and so do the others.
#include <algorithm>

#include "snug/cell/item_event_log.hpp"
#include "snug/environment/internal/placer.hpp"

namespace snug::environment::internal {
namespace {

/// What does not change in an episode; copies of an environment share it.
struct StaticCell {
  model::Scenario scenario;
  Settings settings;
  cell::CellWorld world;
  const model::Container* container = nullptr;
  std::vector<Vector3> sizes;  ///< m, as measured, of the items
};

std::shared_ptr<const StaticCell> make_cell(const Episode& episode) {
  auto cell = std::make_shared<StaticCell>();
  cell->scenario = episode.scenario;
  cell->settings = episode.settings;
  const model::Sequence& sequence = *model::find_sequence(cell->scenario, episode.sequence);
  cell->world = cell::build_world(cell->scenario, {&sequence, false, nullptr, {}});
  cell->container = model::find_container(cell->scenario, cell->scenario.target);
  for (const model::Item& item : sequence.items) {
    cell->sizes.push_back(model::find_parcel(cell->scenario, item.parcel)->size);
  }
  return cell;
}

class Statics final : public Placer {
 public:
  explicit Statics(const Episode& episode)
      : cell_(make_cell(episode)),
        state_(cell::make_initial_state(cell_->scenario, cell_->world)),
        work_(cell_->world.model) {}
  Statics(const Statics& other)
      : Placer(other), cell_(other.cell_), state_(other.state_), work_(cell_->world.model), placed_(other.placed_) {}
  Statics& operator=(const Statics&) = delete;

  [[nodiscard]] std::unique_ptr<Placer> clone() const override { return std::make_unique<Statics>(*this); }

  [[nodiscard]] Outcome place(int index, const packing::Place& place,
                              const std::vector<packing::PlacedBox>& /*boxes*/) override {
    std::vector<Pose> before;
    for (const int other : placed_) before.push_back(pose_of(other));
    const Pose X_TP = packing::pose_at(place);
    physics::set_present(state_, body_of(index), true);
    physics::set_pose(cell_->world.model, state_, body_of(index), cell_->container->X_WT * X_TP);
    physics::set_twist(cell_->world.model, state_, body_of(index), Twist{});
    placed_.push_back(index);
    if (!settle()) return {false, "the simulation could not go on", 0.0};
    for (std::size_t i = 0; i < before.size(); ++i) {
      const Outcome other = judge(cell_->settings, pose_of(placed_[i]), before[i], is_packed(placed_[i]));
      if (!other.is_placed) return {false, "a box that was there before moved", other.displacement};
    }
    return judge(cell_->settings, pose_of(index), X_TP, is_packed(index));
  }

  [[nodiscard]] Pose pose_of(int index) const override {
    return cell_->container->X_WT.inverse() * physics::pose_of(cell_->world.model, state_, body_of(index));
  }
  [[nodiscard]] bool is_packed(int index) const override {
    return is_inside(cell_->sizes[static_cast<std::size_t>(index)], pose_of(index), *cell_->container);
  }
  [[nodiscard]] double time() const override { return state_.time(cell_->world.model); }
  [[nodiscard]] std::uint64_t hash() const override { return physics::hash_of(state_); }

 private:
  [[nodiscard]] physics::BodyId body_of(int index) const {
    return cell_->world.parcels[static_cast<std::size_t>(index)];
  }

  /// Until everything sleeps, at most settle_time; false when the physics has to stop.
  bool settle() {
    const double end = time() + cell_->settings.settle_time;
    while (time() < end) {
      const physics::StepReport report = physics::step(cell_->world.model, {}, state_, work_);
      if (report.status == physics::StepStatus::LostBody) physics::set_lost(state_, report.culprit);
      if (report.status == physics::StepStatus::NotFinite || report.status == physics::StepStatus::TooManyPairs) {
        return false;
      }
      if (report.awake == 0) break;
    }
    return true;
  }

  std::shared_ptr<const StaticCell> cell_;
  physics::WorldState state_;
  physics::Workspace work_;
  std::vector<int> placed_;
};

}  // namespace

std::unique_ptr<Placer> make_statics(const Episode& episode) { return std::make_unique<Statics>(episode); }

bool is_inside(const Vector3& size, const Pose& X_TP, const model::Container& container) {
  const Vector3 reach = 0.5 * (X_TP.R.cwiseAbs() * size);
  const Vector3 half = 0.5 * container.inner_size;
  const Vector3 low = X_TP.p - reach, high = X_TP.p + reach;
  const double beyond = std::max({high.x() - half.x(), -half.x() - low.x(), high.y() - half.y(), -half.y() - low.y()});
  return beyond <= cell::kPackedBeyondWall && high.z() - container.inner_size.z() <= cell::kPackedAboveRim &&
         low.z() > -container.inner_size.z();
}

Outcome judge(const Settings& settings, const Pose& X_TP, const Pose& X_TP_meant, bool is_packed) {
  Outcome outcome;
  outcome.displacement = (X_TP.p - X_TP_meant.p).norm();
  if (!is_packed) {
    outcome.reason = "it does not rest in the container";
  } else if (outcome.displacement > settings.max_displacement ||
             angle_between(X_TP.R, X_TP_meant.R) > settings.max_tilt) {
    outcome.reason = "it does not stay where it was put";
  } else {
    outcome.is_placed = true;
  }
  return outcome;
}

}  // namespace snug::environment::internal
