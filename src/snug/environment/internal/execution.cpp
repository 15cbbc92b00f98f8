// Execution: the tool brings a box from the aligner to its place, through the cell as it is.
#include <algorithm>

#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/environment/internal/placer.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/skills/highest_fixed_point.hpp"
#include "snug/skills/placements.hpp"

namespace snug::environment::internal {
namespace {

constexpr double kLongestPlacement = 300.0;  ///< s, simulated

class Execution final : public Placer {
 public:
  explicit Execution(const Episode& episode)
      : simulation_(std::make_shared<const cell::Simulation>(
            episode.scenario, episode.sequence, cell::SimulationOptions{.tracking = motion::FastTracking{}})),
        settings_(episode.settings),
        container_(*model::find_container(simulation_->scenario(), simulation_->scenario().target)),
        state_(simulation_->make_state()),
        work_(simulation_->make_workspace()) {
    plan_.X_WT = container_.X_WT;
    plan_.obstacle_top = skills::highest_fixed_point(simulation_->scenario());
    plan_.pick_length = plan_.hold_length = simulation_->scenario().cup.hold_length;
    plan_.X_WE_home = simulation_->scenario().controller.X_WE_start;
  }
  Execution(const Execution& other)
      : Placer(other),
        simulation_(other.simulation_),
        settings_(other.settings_),
        container_(other.container_),
        plan_(other.plan_),
        state_(other.state_),
        work_(simulation_->make_workspace()),
        program_(other.program_) {}
  Execution& operator=(const Execution&) = delete;

  [[nodiscard]] std::unique_ptr<Placer> clone() const override { return std::make_unique<Execution>(*this); }

  [[nodiscard]] Outcome place(int index, const packing::Place& place,
                              const std::vector<packing::PlacedBox>& boxes) override {
    const std::optional<Pose> X_TP = append_rows(index, packing::pose_at(place), boxes);
    if (!X_TP) return {false, "it would have to be turned over", 0.0};
    const motion::PreparedProgram prepared = simulation_->prepare(program_);
    const double latest = time() + kLongestPlacement;
    while (!simulation_->is_at_end(prepared, state_)) {
      const cell::CellTick tick = simulation_->advance(prepared, state_, work_);
      if (tick.failure || time() > latest) return {false, "the simulation could not go on", 0.0};
    }
    if (!is_present(index)) return {false, "it left the cell", 0.0};
    return judge(settings_, pose_of(index), *X_TP, is_packed(index));
  }

  [[nodiscard]] Pose pose_of(int index) const override {
    return container_.X_WT.inverse() * physics::pose_of(simulation_->world().model, state_.world, body_of(index));
  }
  [[nodiscard]] bool is_packed(int index) const override {
    if (!is_present(index) || state_.gripper.cup.body == body_of(index).index) return false;
    const model::Item& item = simulation_->sequence().items[static_cast<std::size_t>(index)];
    return is_inside(model::find_parcel(simulation_->scenario(), item.parcel)->size, pose_of(index), container_);
  }
  [[nodiscard]] double time() const override { return simulation_->time(state_); }
  [[nodiscard]] std::uint64_t hash() const override { return simulation_->hash(state_); }

 private:
  [[nodiscard]] physics::BodyId body_of(int index) const {
    return simulation_->world().parcels[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] bool is_present(int index) const {
    return state_.world.bodies[static_cast<std::size_t>(body_of(index).index)].is_present;
  }

  /// Pick at the aligner and place, without going home: the next box is picked from there. Of the two ways to hold the
  /// same space, half a turn apart, the one that turns the tool less: X_TP then; nothing for a box that needs a flip.
  [[nodiscard]] std::optional<Pose> append_rows(int index, const Pose& X_TP,
                                                const std::vector<packing::PlacedBox>& boxes) {
    const model::Item& item = simulation_->sequence().items[static_cast<std::size_t>(index)];
    skills::PickSpec pick;
    pick.box = item.parcel;
    pick.X_WP = cell::pose_at_aligner(simulation_->scenario(), item, std::nullopt);
    pick.size =
        model::collision_size(simulation_->scenario(), *model::find_parcel(simulation_->scenario(), item.parcel));
    skills::Placement placement{item.parcel, X_TP};
    const Matrix3 half_turn = Vector3(-1.0, -1.0, 1.0).asDiagonal();
    const Matrix3 R_WP = container_.X_WT.R * X_TP.R, R_WP_other = container_.X_WT.R * half_turn * X_TP.R;
    if (angle_between(R_WP_other, pick.X_WP.R) < angle_between(R_WP, pick.X_WP.R) - 1e-9) {
      placement.X_TP.R = half_turn * X_TP.R;
    }
    plan_.rim_height = container_.has_walls ? container_.inner_size.z() : 0.0;
    for (const packing::PlacedBox& box : boxes) {
      plan_.rim_height = std::max(plan_.rim_height, packing::bounding_extent(box).high.z());
    }
    const auto rows = skills::program_from_placements({&pick, 1}, {&placement, 1}, plan_);
    if (!rows) return std::nullopt;
    for (const motion::Waypoint& row : rows->waypoints) {
      if (row.motion_class != motion::MotionClass::Home) program_.waypoints.push_back(motion::rounded(row));
    }
    return placement.X_TP;
  }

  std::shared_ptr<const cell::Simulation> simulation_;
  Settings settings_;
  model::Container container_;
  skills::PlacementSettings plan_;
  cell::CellState state_;
  cell::CellWorkspace work_;
  motion::Program program_;
};

}  // namespace

std::unique_ptr<Placer> make_execution(const Episode& episode) { return std::make_unique<Execution>(episode); }

}  // namespace snug::environment::internal
