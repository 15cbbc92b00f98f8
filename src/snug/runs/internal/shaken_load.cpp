// ShakenLoad: steps of the load under the forces of a motion, what holds it, and how far its boxes come.
#include "snug/runs/internal/shaken_load.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace snug::runs::internal {
namespace {

constexpr double kStrapForce = 600.0;  ///< N, all together
constexpr double kFallen = 0.10;       ///< m, under the floor, or beyond the walls with the middle
constexpr double kOnTop = 0.010;       ///< m, between a top and what stands on it
constexpr double kProbeTime = 0.010;   ///< s, for which a load at rest is tried under other forces
// EUMOS 40509: what may remain of a shift, m; in the lowest part of the load less.
constexpr double kLowest = 0.2, kLowestRemaining = 0.04, kMostRemaining = 0.06;

cell::WorldOptions world_options(const model::Scenario& scenario) {
  cell::WorldOptions options;
  options.sequence = &scenario.sequences.front();
  return options;
}

std::vector<FilmBox> film_boxes(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load) {
  std::vector<FilmBox> boxes;
  for (const model::PlacementEntry& one : load) {
    const model::Parcel& parcel = *model::find_parcel(scenario, one.parcel);
    boxes.push_back({model::collision_size(scenario, parcel), parcel.inertia.com});
  }
  return boxes;
}

struct Extents {
  Vector3 low, high;
};

/// In plan view.
bool overlap(const Extents& a, const Extents& b) {
  return a.low.x() < b.high.x() && b.low.x() < a.high.x() && a.low.y() < b.high.y() && b.low.y() < a.high.y();
}

/// Boxes that carry no other.
std::vector<bool> tops_of(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load) {
  std::vector<Extents> extents;
  for (const model::PlacementEntry& one : load) {
    const Vector3 size = model::collision_size(scenario, *model::find_parcel(scenario, one.parcel));
    const Vector3 half = 0.5 * one.X_TP.R.cwiseAbs() * size;
    extents.push_back({one.X_TP.p - half, one.X_TP.p + half});
  }
  std::vector<bool> is_top;
  for (const Extents& own : extents) {
    is_top.push_back(std::ranges::none_of(extents, [&](const Extents& other) {
      return std::abs(other.low.z() - own.high.z()) <= kOnTop && overlap(own, other);
    }));
  }
  return is_top;
}

/// rad, how far the container's vertical moved in the box: turning about it does not count.
double tilt_between(const Matrix3& R_TP, const Matrix3& R_TP_before) {
  const Vector3 now = R_TP.row(2).transpose(), before = R_TP_before.row(2).transpose();
  return std::atan2(now.cross(before).norm(), now.dot(before));
}

}  // namespace

AllowedShift allowed_shift(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
                           const ShakeOptions& options) {
  AllowedShift allowed{options.shift, std::vector<double>(load.size(), std::numeric_limits<double>::infinity())};
  if (options.limits == ShakeLimits::Boxes) return allowed;
  double height = 0.0;
  for (const model::PlacementEntry& one : load) {
    const Vector3 size = model::collision_size(scenario, *model::find_parcel(scenario, one.parcel));
    height = std::max(height, one.X_TP.p.z() + 0.5 * one.X_TP.R.row(2).cwiseAbs().dot(size));
  }
  allowed.shift = 0.10 * height;
  for (std::size_t i = 0; i < load.size(); ++i) {
    const double most = load[i].X_TP.p.z() < kLowest ? kLowestRemaining : kMostRemaining;
    allowed.remaining[i] = std::min(most, 0.05 * height);
  }
  return allowed;
}

ShakenLoad::ShakenLoad(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
                       const ShakeOptions& options)
    : options_(options),
      allowed_(allowed_shift(scenario, load, options)),
      world_(cell::build_world(scenario, world_options(scenario))),
      work_(world_.model),
      X_WT_(model::find_container(scenario, scenario.target)->X_WT),
      inner_(model::find_container(scenario, scenario.target)->inner_size),
      state_(cell::make_initial_state(scenario, world_)),
      film_(film_boxes(scenario, load), film_of(options.film_layers)),
      rested_film_(film_),
      is_top_(tops_of(scenario, load)) {
  for (std::size_t i = 0; i < load.size(); ++i) {
    physics::set_present(state_, world_.parcels[i], true);
    physics::set_pose(world_.model, state_, world_.parcels[i], X_WT_ * load[i].X_TP);
    ids_.push_back(load[i].parcel);
  }
}

std::vector<ShakeRun> ShakenLoad::settle() {
  reference_ = poses();
  std::vector<ShakeRun> runs{drive({"at rest", {{0.0, Vector3::Zero()}, {kSettleTime, Vector3::Zero()}}})};
  if (options_.hold == LoadHold::Film) runs.push_back(wind());
  reference_ = poses();
  rested_ = state_;
  rested_film_ = film_;
  rested_steps_ = quiet_steps_;
  return runs;
}

ShakeRun ShakenLoad::shake(const ShakeMotion& motion) {
  state_ = rested_;
  film_ = rested_film_;
  quiet_steps_ = rested_steps_;
  return drive(motion);
}

/// The film draws a loose load together before anything drives it: how far does not count.
ShakeRun ShakenLoad::wind() {
  reference_ = poses();
  film_state_ = FilmState::Winding;
  counts_shift_ = false;
  ShakeRun run = drive({"wound", {{0.0, Vector3::Zero()}, {kWindTime + kSettleTime, Vector3::Zero()}}});
  counts_shift_ = true;
  film_state_ = FilmState::Wound;
  film_.wrap(poses());
  return run;
}

std::vector<Pose> ShakenLoad::poses() const {
  std::vector<Pose> poses;
  for (const physics::BodyId body : world_.parcels) {
    poses.push_back(X_WT_.inverse() * physics::pose_of(world_.model, state_, body));
  }
  return poses;
}

/// The forces that come of the motion of the container, and of what holds the load.
void ShakenLoad::push(const ShakeSample& now) {
  const Matrix3 R_tilt = exp_rotation(Vector3(now.roll, now.pitch, 0.0));
  const Vector3 gravity_T = X_WT_.R.transpose() * world_.model.gravity;
  const Vector3 felt_T = R_tilt.transpose() * gravity_T - gravity_T - now.acceleration_T;
  const auto tops = static_cast<double>(std::ranges::count(is_top_, true));
  pull_film(now.time);
  wrenches_.clear();
  for (std::size_t i = 0; i < world_.parcels.size(); ++i) {
    const physics::BodyId body = world_.parcels[i];
    if (!state_.bodies[static_cast<std::size_t>(body.index)].is_present) continue;
    Vector3 force_T = world_.model.bodies[static_cast<std::size_t>(body.index)].inertia.mass * felt_T;
    if (options_.hold == LoadHold::Straps && is_top_[i]) force_T.z() -= kStrapForce / tops;
    force_T += film_T_[i].force;
    wrenches_.push_back({body, {X_WT_.R * force_T, X_WT_.R * film_T_[i].torque}});
  }
}

/// By the poses in the middle of the step: a pull that lags by half a step would feed what sways.
void ShakenLoad::pull_film(double time) {
  film_T_.assign(world_.parcels.size(), {});
  if (film_state_ == FilmState::Off) return;
  std::vector<Pose> X_TP = poses();
  for (std::size_t i = 0; i < X_TP.size(); ++i) {
    const physics::BodyState& body = state_.bodies[static_cast<std::size_t>(world_.parcels[i].index)];
    X_TP[i].p += 0.5 * world_.model.settings.dt * (X_WT_.R.transpose() * body.velocity);
  }
  if (film_state_ == FilmState::Winding) {
    film_.wind(X_TP, std::min(1.0, time / kWindTime), film_T_);
  } else {
    film_.pull(X_TP, film_T_);
  }
}

/// One step under these forces. False: it did not come to finite numbers.
bool ShakenLoad::advance(const ShakeSample& sample) {
  push(sample);
  physics::WorldInput input;
  input.wrenches = wrenches_;
  const physics::StepReport report = physics::step(world_.model, input, state_, work_);
  ++steps_;
  const physics::SleepSettings& sleep = world_.model.settings.sleep;
  const bool is_slow = std::ranges::all_of(state_.bodies, [&sleep](const physics::BodyState& body) {
    return !body.is_present ||
           (body.velocity.norm() < sleep.linear_speed && body.angular_velocity.norm() < sleep.angular_speed);
  });
  quiet_steps_ = is_slow ? quiet_steps_ + 1 : 0;
  return report.status == physics::StepStatus::Converged || report.status == physics::StepStatus::NotConverged;
}

std::int64_t ShakenLoad::steps_of(double time) const {
  return std::max<std::int64_t>(2, std::llround(time / world_.model.settings.dt));
}

/// Whether a load at rest stays so under these forces; if not, it is as before.
bool ShakenLoad::rests_under(const ShakeSample& sample) {
  const physics::WorldState before = state_;
  for (std::int64_t i = 0; i < steps_of(kProbeTime); ++i) {
    if (advance(sample) && is_at_rest()) continue;
    state_ = before;
    return false;
  }
  return true;
}

/// The step at which a load at rest is taken up again; `step` itself where it may move. The forces under which a load
/// can rest are a convex set: if it rests under those at both ends of a straight piece of the motion, it does
/// between.
std::int64_t ShakenLoad::skip_rest(const ShakeMotion& motion, std::int64_t step, std::int64_t steps) {
  const double dt = world_.model.settings.dt;
  const double now = (static_cast<double>(step) + 0.5) * dt;
  const auto next = std::ranges::find_if(motion.samples, [now](const ShakeSample& one) { return one.time > now; });
  if (next == motion.samples.begin() || next == motion.samples.end() || next->time == tried_) return step;
  tried_ = next->time;
  const auto after = std::min(steps, static_cast<std::int64_t>(std::ceil(next->time / dt - 0.5)));
  if (after - step <= steps_of(kProbeTime)) return step;
  return rests_under(*next) ? after : step;
}

ShakeRun ShakenLoad::drive(const ShakeMotion& motion) {
  ShakeRun run;
  run.motion = motion.name;
  for (const std::string& id : ids_) run.boxes.push_back({.id = id});
  run.worst_X_TP = poses();
  const double dt = world_.model.settings.dt;
  const auto steps = static_cast<std::int64_t>(std::ceil(motion.duration() / dt));
  const std::int64_t steps_before = steps_;
  tried_ = -1.0;
  for (std::int64_t k = 0; k < steps; ++k) {
    if (film_state_ != FilmState::Winding && is_at_rest()) k = skip_rest(motion, k, steps);
    if (k == steps) break;
    if (!advance(motion.at((static_cast<double>(k) + 0.5) * dt))) {
      run.is_sound = false;
      run.worst = std::numeric_limits<double>::infinity();
      run.worst_time = static_cast<double>(k) * dt;
      break;
    }
    measure(static_cast<double>(k + 1) * dt, run);
  }
  run.steps = steps_ - steps_before;
  judge_end(motion.duration(), run);
  return run;
}

void ShakenLoad::judge_end(double time, ShakeRun& run) const {
  const std::vector<Pose> now = poses();
  double worst = 0.0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    ShakenBox& box = run.boxes[i];
    box.remaining = (now[i].p - reference_[i].p).norm();
    if (!counts_shift_ || box.fell) continue;
    box.part = std::max(box.part, box.remaining / allowed_.remaining[i]);
    worst = std::max(worst, box.part);
  }
  if (worst <= run.worst) return;
  run.worst = worst;
  run.worst_time = time;
  run.worst_X_TP = now;
}

void ShakenLoad::measure(double time, ShakeRun& run) {
  double worst = 0.0;
  std::vector<std::size_t> fallen;
  for (std::size_t i = 0; i < run.boxes.size(); ++i) {
    ShakenBox& box = run.boxes[i];
    if (box.fell) continue;
    const Pose X_TP = X_WT_.inverse() * physics::pose_of(world_.model, state_, world_.parcels[i]);
    const double shift = (X_TP.p - reference_[i].p).norm();
    const double tilt = tilt_between(X_TP.R, reference_[i].R);
    box.shift = std::max(box.shift, shift);
    box.tilt = std::max(box.tilt, tilt);
    box.fell = X_TP.p.z() < -kFallen || std::abs(X_TP.p.x()) > 0.5 * inner_.x() + kFallen ||
               std::abs(X_TP.p.y()) > 0.5 * inner_.y() + kFallen;
    if (box.fell) fallen.push_back(i);
    box.part = std::max({box.part, counts_shift_ ? shift / allowed_.shift : 0.0, tilt / options_.tilt});
    worst = std::max(worst, box.part);
  }
  if (!fallen.empty()) worst = std::numeric_limits<double>::infinity();
  if (worst > run.worst) {
    run.worst = worst;
    run.worst_time = time;
    run.worst_X_TP = poses();
  }
  for (const std::size_t i : fallen) {
    physics::set_present(state_, world_.parcels[i], false);
    film_.leave_out(i);
  }
}

}  // namespace snug::runs::internal
