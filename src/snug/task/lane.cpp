// Lane: one course of events of a cell: the one that counts, or one that could be; runs rows, can go back.
#include "snug/task/lane.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace snug::task {
namespace {

constexpr double kLongestEpisode = 7200.0;  ///< s

}  // namespace

void merge(Episode& into, const Episode& episode) {
  into.peak_force = std::max(into.peak_force, episode.peak_force);
  into.peak_torque = std::max(into.peak_torque, episode.peak_torque);
  into.duration += episode.duration;
  if (into.arm_contact.empty()) into.arm_contact = episode.arm_contact;
  if (!into.failure.empty()) return;
  into.failure = episode.failure;
  into.was_stopped = episode.was_stopped;
}

void append(motion::Program& program, const std::vector<motion::Waypoint>& rows) {
  for (const motion::Waypoint& row : rows) program.waypoints.push_back(motion::as_written(row));
}

Lane::Lane(const model::Scenario& scenario, const std::string& sequence, const cell::SimulationOptions& options)
    : simulation_(std::make_unique<cell::Simulation>(scenario, sequence, options)),
      state_(simulation_->make_state()),
      work_(simulation_->make_workspace()) {}

bool Lane::advance(const motion::PreparedProgram& plan, Episode& episode) {
  const cell::CellTick tick = simulation_->advance(plan, state_, work_);
  episode.failure = tick.failure;
  episode.was_stopped = !tick.failure.empty() && work_.arm.stop;
  if (episode.arm_contact.empty() && !work_.arm.touches_begun.empty()) {
    episode.arm_contact = simulation_->describe_touch(work_.arm.touches_begun.front());
  }
  episode.peak_force = std::max(episode.peak_force, state_.gripper.F_S.force.norm());
  episode.peak_torque = std::max(episode.peak_torque, state_.gripper.F_S.torque.norm());
  return tick.failure.empty();
}

Episode Lane::run(const motion::Program& program, const EpisodeLimits& limits) {
  Episode episode;
  const motion::PreparedProgram plan = simulation_->prepare(program);
  const double start = time();
  while (!simulation_->is_at_end(plan, state_)) {
    if (!advance(plan, episode)) break;
    if (episode.peak_force > limits.force) {
      episode.failure = fmt::format("{:.0f} N on the box", episode.peak_force);
      break;
    }
    if (!limits.arm_may_touch && !episode.arm_contact.empty()) {
      episode.failure = episode.arm_contact;
      break;
    }
    if (time() - start > kLongestEpisode) {
      episode.failure = "the rows did not end within two hours";
      break;
    }
  }
  episode.duration = time() - start;
  return episode;
}

Episode Lane::settle(const motion::Program& program, double seconds) {
  Episode episode;
  const motion::PreparedProgram plan = simulation_->prepare(program);
  const double start = time();
  while (time() < start + seconds && advance(plan, episode)) {
  }
  episode.duration = time() - start;
  return episode;
}

std::optional<Pose> Lane::pose_of(int item) const {
  const physics::BodyId body = simulation_->world().parcels[static_cast<std::size_t>(item)];
  if (!state_.world.bodies[static_cast<std::size_t>(body.index)].is_present) return std::nullopt;
  return physics::pose_of(simulation_->world().model, state_.world, body);
}

bool Lane::is_held(int item) const {
  return state_.gripper.cup.body == simulation_->world().parcels[static_cast<std::size_t>(item)].index;
}

}  // namespace snug::task
