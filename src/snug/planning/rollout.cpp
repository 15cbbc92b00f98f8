// Rollout: one simulated run of a cell that could be, nominal or sampled: does waypoints, can go back.
#include "snug/planning/rollout.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "snug/cell/rest_watch.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::planning {
namespace {

constexpr double kLongestEpisode = 600.0;  ///< s, ten times what an item takes with the lag
constexpr double kLongestFall = 2.0;       ///< s, of boxes that do not stay where they were seen

std::string toward(const motion::Program& program, int waypoint) {
  return waypoint >= 0 && waypoint < static_cast<int>(program.waypoints.size())
             ? motion::name_of(program.waypoints[static_cast<std::size_t>(waypoint)])
             : "its end";
}

}  // namespace

void merge(Episode& into, const Episode& episode) {
  into.peak_force = std::max(into.peak_force, episode.peak_force);
  into.peak_torque = std::max(into.peak_torque, episode.peak_torque);
  into.duration += episode.duration;
  if (into.arm_contact.empty()) into.arm_contact = episode.arm_contact;
  if (!into.is_complete()) return;
  into.end = episode.end;
  into.text = episode.text;
}

void append(motion::Program& program, const std::vector<motion::Waypoint>& waypoints) {
  for (const motion::Waypoint& waypoint : waypoints) program.waypoints.push_back(motion::rounded(waypoint));
}

Rollout::Rollout(const model::Scenario& scenario, const std::string& sequence, const cell::SimulationOptions& options)
    : simulation_(std::make_unique<cell::Simulation>(scenario, sequence, options)),
      state_(simulation_->make_state()),
      work_(simulation_->make_workspace()) {}

bool Rollout::advance(const motion::PreparedProgram& plan, Episode& episode) {
  const cell::CellTick tick = simulation_->advance(plan, state_, work_);
  if (tick.failure) {
    episode.end =
        tick.failure.kind == cell::FailureKind::ProtectiveStop ? RolloutEnd::ProtectiveStop : RolloutEnd::Failed;
    episode.text = tick.failure.text;
  }
  if (episode.arm_contact.empty() && !work_.arm.touches_begun.empty()) {
    episode.arm_contact = simulation_->describe_touch(work_.arm.touches_begun.front());
  }
  episode.peak_force = std::max(episode.peak_force, state_.gripper.F_S.force.norm());
  episode.peak_torque = std::max(episode.peak_torque, state_.gripper.F_S.torque.norm());
  return !tick.failure;
}

Episode Rollout::run(const motion::Program& program, const EpisodeLimits& limits) {
  Episode episode;
  const motion::PreparedProgram plan = simulation_->prepare(program);
  const double start = time();
  const auto fail = [&](RolloutEnd end, std::string text) {
    episode.end = end;
    episode.text = std::move(text);
  };
  while (episode.is_complete() && !simulation_->is_at_end(plan, state_)) {
    if (!advance(plan, episode)) break;
    if (episode.peak_force > limits.force) {
      fail(RolloutEnd::TooMuchForce,
           fmt::format("{:.0f} N on the box toward {}", episode.peak_force, toward(program, state_.controller.row)));
    } else if (!limits.arm_may_touch && !episode.arm_contact.empty()) {
      fail(RolloutEnd::ArmContact, episode.arm_contact);
    } else if (time() - start > kLongestEpisode) {
      fail(RolloutEnd::TooLong, "the waypoints did not end within ten minutes");
    }
  }
  episode.duration = time() - start;
  return episode;
}

Episode Rollout::settle(const motion::Program& program, double seconds) {
  return settle(simulation_->prepare(program), seconds);
}

Episode Rollout::settle(const motion::PreparedProgram& plan, double seconds) {
  Episode episode;
  const double start = time();
  while (time() < start + seconds && advance(plan, episode)) {
  }
  episode.duration = time() - start;
  return episode;
}

void Rollout::take_up(const cell::CellAnchor& anchor, double seconds) {
  state_ = simulation_->take_up(anchor);
  const Pose& X_WE = state_.controller.command.X_WE;
  motion::PreparedProgram still =
      simulation_->prepare({"still", {motion::make_waypoint(motion::MotionClass::Home, {}, X_WE)}});
  still.X_WE.front() = X_WE;  // without the rounding of a file: the tool stays where it is
  Episode episode;
  const double start = time();
  cell::RestWatch rest(start);
  while (time() < start + std::max(seconds, kLongestFall)) {
    if (time() >= start + seconds && rest.is_at_rest(time())) break;
    if (!advance(still, episode)) break;
    rest.follow(*simulation_, state_);
  }
  simulation_->stand(state_);
}

std::optional<Pose> Rollout::pose_of(model::ItemIndex item) const {
  const physics::BodyId body = simulation_->world().parcels[item.slot()];
  if (!state_.world.bodies[static_cast<std::size_t>(body.index)].is_present) return std::nullopt;
  return physics::pose_of(simulation_->world().model, state_.world, body);
}

std::vector<std::optional<Pose>> Rollout::poses() const {
  std::vector<std::optional<Pose>> poses;
  for (std::size_t i = 0; i < simulation_->sequence().items.size(); ++i) poses.push_back(pose_of(model::ItemIndex(i)));
  return poses;
}

bool Rollout::is_held(model::ItemIndex item) const {
  return state_.gripper.cup.body == simulation_->world().parcels[item.slot()].index;
}

}  // namespace snug::planning
