// simulate_scene: the bodies of a scenario, started as a recording says.
#include "snug/identification/internal/scene_motion.hpp"

#include <algorithm>
#include <cmath>

#include "snug/cell/scene.hpp"
#include "snug/geometry/manifold.hpp"
#include "snug/identification/free_flight.hpp"
#include "snug/record/archive.hpp"

namespace snug::identification::internal {
namespace {

/// The pose between two, `share` of the way from the first.
record::PoseSample between(const Pose& from, const Pose& to, double share) {
  return Pose{from.R * exp_rotation(share * log_rotation(from.R.transpose() * to.R)), from.p + share * (to.p - from.p)};
}

FlightStart start_of(const model::Scenario& scenario, const model::SceneTask& task, const RecordedMotion& motion,
                     const RecordedBody& recorded, std::size_t flight) {
  const model::Body& body = *model::find_body(scenario, recorded.body);
  if (task.start.from == model::StartFrom::Scenario) return {body.X_WB, body.V_WB};
  if (task.start.from == model::StartFrom::FreeFlight && flight >= 3)
    return fit_free_flight(std::span(motion.times).first(flight), std::span(recorded.poses).first(flight), body.inertia,
                           scenario.gravity);
  FlightStart start{recorded.poses.front().pose(), {}};
  if (!recorded.twists.empty()) {
    start.V_WB = recorded.twists.front();
  } else if (motion.times.size() > 1) {
    const Pose next = recorded.poses[1].pose();
    const double span = motion.times[1] - motion.times[0];
    start.V_WB = {(next.p - start.X_WB.p) / span, log_rotation(next.R * start.X_WB.R.transpose()) / span};
  }
  return start;
}

/// Kinematic bodies go where the recording has them. `origin`: the recording's time at time 0 of the simulation, s.
void drive(model::Scenario& scenario, std::span<const DrivenPath> driven, double origin) {
  for (const DrivenPath& path : driven) {
    for (model::Body& body : scenario.bodies) {
      if (body.name != path.body) continue;
      body.path = pose_path_of(path, origin);
      body.X_WB = body.path->points.front().X_WB;
    }
  }
}

}  // namespace

OwnValues::OwnValues(const model::SceneTask& task, Eigen::Index path_unknowns, const Eigen::VectorXd& values)
    : X_BM(task.tracked.size()), path(Eigen::VectorXd::Zero(path_unknowns)) {
  if (values.size() == 0) return;
  const model::OwnSettings& settings = task.own;
  Eigen::Index at = 0;
  const auto take3 = [&](double deviation) -> Vector3 {
    if (!(deviation > 0.0)) return Vector3::Zero();
    at += 3;
    return values.segment<3>(at - 3);
  };
  start.linear = take3(settings.velocity);
  start.angular = take3(settings.angular_velocity);
  if (settings.delay > 0.0) delay = values[at++];
  if (settings.clock_rate > 0.0) clock_rate = values[at++];
  bias.p = take3(settings.bias);
  bias.R = exp_rotation(take3(settings.bias_rotation));
  for (Pose& X : X_BM) {
    X.p = take3(settings.frame_position);
    X.R = exp_rotation(take3(settings.frame_rotation));
  }
  path = values.tail(path_unknowns);
}

Eigen::VectorXd own_deviation(const model::SceneTask& task, Eigen::Index path_unknowns) {
  const model::OwnSettings& settings = task.own;
  std::vector<double> deviation;
  const auto add = [&](double value, int count) {
    if (value > 0.0) deviation.insert(deviation.end(), static_cast<std::size_t>(count), value);
  };
  add(settings.velocity, 3);
  add(settings.angular_velocity, 3);
  add(settings.delay, 1);
  add(settings.clock_rate, 1);
  add(settings.bias, 3);
  add(settings.bias_rotation, 3);
  for (std::size_t i = 0; i < task.tracked.size(); ++i) {
    add(settings.frame_position, 3);
    add(settings.frame_rotation, 3);
  }
  add(1.0, static_cast<int>(path_unknowns));
  return Eigen::Map<const Eigen::VectorXd>(deviation.data(), static_cast<Eigen::Index>(deviation.size()));
}

std::vector<std::optional<std::size_t>> own_bodies(const model::SceneTask& task, Eigen::Index path_unknowns) {
  const std::size_t bodies = task.tracked.size(), count = static_cast<std::size_t>(own_deviation(task, 0).size());
  const std::size_t each = (task.own.frame_position > 0.0 ? 3U : 0U) + (task.own.frame_rotation > 0.0 ? 3U : 0U);
  std::vector<std::optional<std::size_t>> result(count - bodies * each);
  for (std::size_t b = 0; b < bodies; ++b) result.insert(result.end(), each, b);
  result.resize(result.size() + static_cast<std::size_t>(path_unknowns));
  return result;
}

std::size_t sample_count(const model::SceneTask& task, const RecordedMotion& motion) {
  if (!task.simulation_time) return motion.times.size();
  const double start = task.start.from == model::StartFrom::Scenario ? 0.0 : motion.times.front();
  const auto end = std::upper_bound(motion.times.begin(), motion.times.end(), start + *task.simulation_time + 1e-9);
  return std::max<std::size_t>(1, static_cast<std::size_t>(end - motion.times.begin()));
}

ComparedSamples compared_samples(const model::SceneTask& task, const RecordedMotion& motion) {
  const std::size_t end = sample_count(task, motion);
  // Unless the scenario says where bodies start, the first sample does.
  std::size_t begin = task.start.from == model::StartFrom::Scenario ? 0 : 1;
  if (task.only_final_state) begin = motion.times.size() - 1;
  begin = std::min(begin, end - 1);
  ComparedSamples samples;
  for (const RecordedBody& body : motion.tracked) {
    std::vector<std::size_t>& own = samples.emplace_back();
    for (std::size_t k = begin; k < end; ++k)
      if (record::is_tracked(body.poses[k]) || (task.only_final_state && body.result)) own.push_back(k);
  }
  return samples;
}

std::size_t count_flight_rows(const model::Scenario& scenario, const RecordedBody& recorded,
                              const model::StartSettings& start) {
  const model::Body& body = *model::find_body(scenario, recorded.body);
  const std::size_t most = std::min(recorded.poses.size(), static_cast<std::size_t>(start.samples));
  for (std::size_t k = 0; k < most; ++k) {
    if (!record::is_tracked(recorded.poses[k])) return k;
    const Pose X_WB = recorded.poses[k].pose();
    for (const model::Body& other : scenario.bodies) {
      if (other.name == body.name) continue;
      for (const model::PlacedShape& a : body.shapes) {
        for (const model::PlacedShape& b : other.shapes) {
          geometry::PairCache cache;
          geometry::Manifold manifold;
          geometry::collide(a.shape, X_WB * a.X_BG, b.shape, other.X_WB * b.X_BG, start.margin, cache, manifold);
          if (manifold.count > 0) return k;
        }
      }
    }
  }
  return most;
}

SimulatedMotion simulate_scene(const model::Scenario& given, const model::SceneTask& task, const RecordedMotion& motion,
                               std::span<const DrivenPath> driven, const std::vector<std::size_t>& flights,
                               const OwnValues& own, double until) {
  // What stands in the recording happened a delay earlier.
  const double origin = (task.start.from == model::StartFrom::Scenario ? 0.0 : motion.times.front()) + own.delay;
  model::Scenario with_paths;
  if (!driven.empty()) {
    with_paths = given;
    drive(with_paths, driven, origin);
  }
  const model::Scenario& scenario = driven.empty() ? given : with_paths;
  cell::Scene scene(scenario);
  const physics::WorldModel& world = scene.world().model;
  std::vector<physics::BodyId> ids;
  for (std::size_t b = 0; b < motion.tracked.size(); ++b) {
    ids.push_back(cell::find_body(scene.world(), motion.tracked[b].body));
    const FlightStart start = start_of(scenario, task, motion, motion.tracked[b], flights.empty() ? 0 : flights[b]);
    physics::set_pose(world, scene.state(), ids[b], start.X_WB);
    physics::set_twist(world, scene.state(), ids[b],
                       {start.V_WB.linear + own.start.linear, start.V_WB.angular + own.start.angular});
  }
  const std::size_t count = sample_count(task, motion);
  const bool has_result = task.only_final_state && motion.tracked.front().result.has_value();
  SimulatedMotion simulated;
  simulated.bodies.assign(ids.size(), std::vector<record::PoseSample>(motion.times.size(), record::lost_pose()));
  std::vector<Pose> before(ids.size()), now(ids.size());
  const auto look = [&](std::vector<Pose>& poses) {
    for (std::size_t b = 0; b < ids.size(); ++b) poses[b] = physics::pose_of(world, scene.state(), ids[b]);
  };
  look(now);
  before = now;
  double time = 0.0;
  for (std::size_t k = 0; k < count && motion.times[k] <= until; ++k) {
    const bool is_end = has_result && k + 1 == count && task.simulation_time.has_value();
    const double wanted = is_end ? *task.simulation_time : motion.times[k] - origin;
    while (time < wanted - 1e-9) {
      before = now;
      const physics::StepReport report = scene.advance();
      time = scene.state().time(world);
      if (report.status != physics::StepStatus::Converged && report.status != physics::StepStatus::NotConverged) {
        simulated.failure = "the simulation lost a body or its numbers";
        return simulated;
      }
      look(now);
    }
    const double share = 1.0 - std::clamp((time - wanted) / world.settings.dt, 0.0, 1.0);
    for (std::size_t b = 0; b < ids.size(); ++b) simulated.bodies[b][k] = between(before[b], now[b], share);
  }
  return simulated;
}

}  // namespace snug::identification::internal
