// shake: a container with its load, driven with accelerations: which boxes shift, tip or fall.
#include "snug/runs/shake.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snug/cell/world_builder.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/rng.hpp"
#include "snug/physics/world.hpp"
#include "snug/runs/internal/film.hpp"

namespace snug::runs {
namespace {

constexpr double kSettle = 0.5;        ///< s
constexpr double kStep = 2.0;          ///< times the scenario's, unless it is said
constexpr double kWindTime = 2.0;      ///< s, in which the tension of film rises; then it stays for kSettle
constexpr double kStrapForce = 600.0;  ///< N, all together
constexpr double kFallen = 0.10;       ///< m, under the floor, or beyond the walls with the middle
constexpr double kOnTop = 0.010;       ///< m, between a top and what stands on it
constexpr double kTolerance = 1e-4;    ///< m/s, residual of contacts: it moves a box by 0.1 mm a second at most
constexpr double kQuietTime = 0.020;   ///< s, below the speeds of sleep: then the load is at rest
constexpr double kProbeTime = 0.010;   ///< s, for which a load at rest is tried under other forces
// EUMOS 40509: what may remain of a shift, m; in the lowest part of the load less.
constexpr double kLowest = 0.2, kLowestRemaining = 0.04, kMostRemaining = 0.06;
/// Of the limits. A load that moves no farther with the least friction is not run with more: such motions of 14 loads
/// moved no more there (docs/decisions/0130).
constexpr double kStill = 0.25;

/// The target and the boxes of the load alone: robots, benches and feeders do not travel.
model::Scenario travelling(model::Scenario scenario, const std::vector<model::PlacementEntry>& load, double friction,
                           const std::optional<double>& time_step) {
  std::erase_if(scenario.containers, [&](const model::Container& one) { return one.name != scenario.target; });
  scenario.bodies.clear();
  scenario.aligner.reset();
  scenario.drops.reset();
  scenario.solver.sleep.enabled = false;  // what drives it begins while it is at rest
  scenario.solver.tolerance = std::max(scenario.solver.tolerance, kTolerance);
  scenario.time_step = time_step.value_or(kStep * scenario.time_step);
  const auto scale = [friction](model::ContactParams& params) {
    params.friction *= friction;
    if (params.edge_friction) *params.edge_friction *= friction;
  };
  for (model::ContactPair& pair : scenario.contact_pairs) scale(pair.params);
  if (scenario.default_contact) scale(*scenario.default_contact);
  model::Sequence sequence;
  sequence.name = "load";
  for (const model::PlacementEntry& one : load) sequence.items.emplace_back().parcel = one.parcel;
  scenario.sequences = {sequence};
  return scenario;
}

cell::WorldOptions world_options(const model::Scenario& scenario) {
  cell::WorldOptions options;
  options.sequence = &scenario.sequences.front();
  return options;
}

struct Allowed {
  double shift = 0.0;             ///< m, at any time
  std::vector<double> remaining;  ///< m, in the end, box by box
};

Allowed allowed_of(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
                   const ShakeOptions& options) {
  Allowed allowed{options.shift, std::vector<double>(load.size(), std::numeric_limits<double>::infinity())};
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

struct Extents {
  Vector3 low, high;
};

/// In plan view.
bool overlap(const Extents& a, const Extents& b) {
  return a.low.x() < b.high.x() && b.low.x() < a.high.x() && a.low.y() < b.high.y() && b.low.y() < a.high.y();
}

class Truck {
 public:
  Truck(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load, const ShakeOptions& options)
      : options_(options),
        allowed_(allowed_of(scenario, load, options)),
        world_(cell::build_world(scenario, world_options(scenario))),
        work_(world_.model),
        X_WT_(model::find_container(scenario, scenario.target)->X_WT),
        inner_(model::find_container(scenario, scenario.target)->inner_size),
        state_(cell::make_initial_state(scenario, world_)),
        film_(boxes_of(scenario, load)),
        rested_film_(film_) {
    for (std::size_t i = 0; i < load.size(); ++i) {
      physics::set_present(state_, world_.parcels[i], true);
      physics::set_pose(world_.model, state_, world_.parcels[i], X_WT_ * load[i].X_TP);
      ids_.push_back(load[i].parcel);
    }
    find_tops(scenario, load);
  }

  /// What stands by itself, then what the film makes of it; what the motions begin with.
  std::vector<ShakeRun> settle() {
    reference_ = poses();
    std::vector<ShakeRun> runs{drive({"at rest", {{0.0, Vector3::Zero()}, {kSettle, Vector3::Zero()}}})};
    if (options_.hold == LoadHold::Film) runs.push_back(wind());
    reference_ = poses();
    rested_ = state_;
    rested_film_ = film_;
    rested_steps_ = quiet_steps_;
    return runs;
  }
  ShakeRun shake(const ShakeMotion& motion) {
    state_ = rested_;
    film_ = rested_film_;
    quiet_steps_ = rested_steps_;
    return drive(motion);
  }

 private:
  enum class FilmState { Off, Winding, Wound };

  static std::vector<internal::FilmBox> boxes_of(const model::Scenario& scenario,
                                                 const std::vector<model::PlacementEntry>& load) {
    std::vector<internal::FilmBox> boxes;
    for (const model::PlacementEntry& one : load) {
      const model::Parcel& parcel = *model::find_parcel(scenario, one.parcel);
      boxes.push_back({model::collision_size(scenario, parcel), parcel.inertia.com});
    }
    return boxes;
  }

  /// The film draws a loose load together before anything drives it: how far does not count.
  ShakeRun wind() {
    reference_ = poses();
    film_state_ = FilmState::Winding;
    counts_shift_ = false;
    ShakeRun run = drive({"wound", {{0.0, Vector3::Zero()}, {kWindTime + kSettle, Vector3::Zero()}}});
    counts_shift_ = true;
    film_state_ = FilmState::Wound;
    film_.wrap(poses());
    return run;
  }

  [[nodiscard]] std::vector<Pose> poses() const {
    std::vector<Pose> poses;
    for (const physics::BodyId body : world_.parcels) {
      poses.push_back(X_WT_.inverse() * physics::pose_of(world_.model, state_, body));
    }
    return poses;
  }

  /// Boxes that carry no other.
  void find_tops(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load) {
    std::vector<Extents> extents;
    for (const model::PlacementEntry& one : load) {
      const Vector3 size = model::collision_size(scenario, *model::find_parcel(scenario, one.parcel));
      const Vector3 half = 0.5 * one.X_TP.R.cwiseAbs() * size;
      extents.push_back({one.X_TP.p - half, one.X_TP.p + half});
    }
    for (const Extents& own : extents) {
      is_top_.push_back(std::ranges::none_of(extents, [&](const Extents& other) {
        return std::abs(other.low.z() - own.high.z()) <= kOnTop && overlap(own, other);
      }));
    }
  }

  /// The forces that come of the motion of the container, and of what holds the load.
  void push(const ShakeSample& now) {
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
  void pull_film(double time) {
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
  bool advance(const ShakeSample& sample) {
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

  /// Steps that take this long, two at least.
  [[nodiscard]] std::int64_t steps_of(double time) const {
    return std::max<std::int64_t>(2, std::llround(time / world_.model.settings.dt));
  }
  [[nodiscard]] bool is_at_rest() const { return quiet_steps_ >= steps_of(kQuietTime); }

  /// Whether a load at rest stays so under these forces; if not, it is as before.
  bool rests_under(const ShakeSample& sample) {
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
  std::int64_t skip_rest(const ShakeMotion& motion, std::int64_t step, std::int64_t steps) {
    const double dt = world_.model.settings.dt;
    const double now = (static_cast<double>(step) + 0.5) * dt;
    const auto next = std::ranges::find_if(motion.samples, [now](const ShakeSample& one) { return one.time > now; });
    if (next == motion.samples.begin() || next == motion.samples.end() || next->time == tried_) return step;
    tried_ = next->time;
    const auto after = std::min(steps, static_cast<std::int64_t>(std::ceil(next->time / dt - 0.5)));
    if (after - step <= steps_of(kProbeTime)) return step;
    return rests_under(*next) ? after : step;
  }

  ShakeRun drive(const ShakeMotion& motion) {
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

  void judge_end(double time, ShakeRun& run) const {
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

  void measure(double time, ShakeRun& run) {
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

  /// rad, how far the container's vertical moved in the box: turning about it does not count.
  [[nodiscard]] static double tilt_between(const Matrix3& R_TP, const Matrix3& R_TP_before) {
    const Vector3 now = R_TP.row(2).transpose(), before = R_TP_before.row(2).transpose();
    return std::atan2(now.cross(before).norm(), now.dot(before));
  }

  const ShakeOptions& options_;
  Allowed allowed_;
  cell::CellWorld world_;
  physics::Workspace work_;
  Pose X_WT_;
  Vector3 inner_;
  physics::WorldState state_, rested_;
  internal::Film film_, rested_film_;
  FilmState film_state_ = FilmState::Off;
  bool counts_shift_ = true;  ///< false: of a motion that moves the load on purpose
  std::vector<Wrench> film_T_;
  std::vector<std::string> ids_;
  std::vector<bool> is_top_;
  std::vector<Pose> reference_;
  std::vector<physics::ExternalWrench> wrenches_;
  std::int64_t steps_ = 0;
  std::int64_t quiet_steps_ = 0, rested_steps_ = 0;  ///< since when all boxes have been slow; after settle()
  double tried_ = -1.0;                              ///< s, end of the piece of motion that was tried last
};

void check(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
           const ShakeOptions& options) {
  if (model::find_container(scenario, scenario.target) == nullptr) {
    throw InputError(scenario.source_name, "target", "nothing", "a container with a load");
  }
  if (load.empty()) throw InputError("load", "", "no boxes", "one at least");
  const auto require = [](bool holds, const char* key, double value, const char* expected) {
    require_number(holds, "shake", key, value, expected);
  };
  require(options.draws >= 0 && options.draws <= 1000, "draws", options.draws, "0 .. 1000");
  require(options.shift > 0.0 && options.shift <= 10.0, "shift", options.shift, "above 0, at most 10 m");
  require(options.tilt > 0.0 && options.tilt <= 3.2, "tilt", options.tilt, "above 0, at most 180 degrees");
  if (!options.time_step) return;
  require(*options.time_step > 0.0 && *options.time_step <= 0.02, "time step", *options.time_step,
          "above 0, at most 0.02 s");
}

/// Whether more friction cannot make a motion worse: a box fell, or the load hardly moved.
bool is_decided(const ShakeRun& least) { return std::isinf(least.worst) || least.worst <= kStill; }

/// At rest, and wound.
std::size_t steps_before_motions(const ShakeOptions& options) { return options.hold == LoadHold::Film ? 2 : 1; }

/// With one friction: the load at rest and those motions that are wanted. What is not wanted is absent.
std::vector<std::optional<ShakeRun>> run_motions(const model::Scenario& scenario,
                                                 const std::vector<model::PlacementEntry>& load,
                                                 const std::vector<ShakeMotion>& profile, const ShakeOptions& options,
                                                 const std::vector<bool>& is_wanted) {
  Truck truck(scenario, load, options);
  std::vector<std::optional<ShakeRun>> runs;
  for (ShakeRun& run : truck.settle()) runs.emplace_back(std::move(run));
  for (const ShakeMotion& motion : profile) {
    runs.push_back(is_wanted[runs.size()] ? std::optional(truck.shake(motion)) : std::nullopt);
  }
  return runs;
}

/// By friction, from the least on, then by motion. With the least friction every motion is run, with others those that
/// are not decided by it.
std::vector<std::vector<std::optional<ShakeRun>>> run_frictions(const model::Scenario& scenario,
                                                                const std::vector<model::PlacementEntry>& load,
                                                                const std::vector<ShakeMotion>& profile,
                                                                const ShakeOptions& options,
                                                                const std::vector<double>& frictions) {
  std::vector<std::vector<std::optional<ShakeRun>>> runs(frictions.size());
  std::vector<bool> is_wanted(profile.size() + steps_before_motions(options), true);
  const auto run = [&](std::size_t draw) {
    runs[draw] =
        run_motions(travelling(scenario, load, frictions[draw], options.time_step), load, profile, options, is_wanted);
    for (std::optional<ShakeRun>& one : runs[draw]) {
      if (one) one->friction = frictions[draw];
    }
  };
  run(0);
  for (std::size_t i = 0; i < is_wanted.size(); ++i) is_wanted[i] = !is_decided(*runs[0][i]);
  if (std::ranges::find(is_wanted, true) == is_wanted.end()) return runs;
  parallel_for(static_cast<int>(frictions.size()) - 1, options.threads,
               [&](int i, int) { run(static_cast<std::size_t>(i) + 1); });
  return runs;
}

}  // namespace

const char* name_of(ShakeLimits limits) { return limits == ShakeLimits::Boxes ? "boxes" : "eumos40509"; }

const char* name_of(LoadHold hold) {
  switch (hold) {
    case LoadHold::None:
      return "none";
    case LoadHold::Film:
      return "film";
    case LoadHold::Straps:
      return "straps";
  }
  return "";
}

ShakeResult shake(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
                  const std::vector<ShakeMotion>& profile, const ShakeOptions& options) {
  check(scenario, load, options);
  std::vector<double> frictions{1.0};
  Rng rng = Rng(options.seed).split("shake friction");
  const double half_width = scenario.uncertainty.friction;
  for (int i = 0; i < options.draws; ++i) frictions.push_back(1.0 + rng.uniform(-half_width, half_width));
  std::ranges::sort(frictions);
  ShakeResult result;
  result.inner_size = model::find_container(scenario, scenario.target)->inner_size;
  for (const model::PlacementEntry& one : load) {
    result.boxes.push_back(one.parcel);
    result.sizes.push_back(model::collision_size(scenario, *model::find_parcel(scenario, one.parcel)));
  }
  const Allowed allowed = allowed_of(scenario, load, options);
  result.shift = allowed.shift;
  result.remaining = *std::ranges::max_element(allowed.remaining);
  auto runs = run_frictions(scenario, load, profile, options, frictions);
  const std::size_t first = steps_before_motions(options);
  for (std::size_t m = 0; m < profile.size() + first; ++m) {
    for (std::vector<std::optional<ShakeRun>>& own : runs) {
      if (m >= own.size() || !own[m]) continue;
      result.seconds += m == 0 ? kSettle : m < first ? kWindTime + kSettle : profile[m - first].duration();
      result.runs.push_back(std::move(*own[m]));
    }
  }
  for (std::size_t i = 0; i < result.runs.size(); ++i) {
    if (result.runs[i].worst > result.runs[result.worst].worst) result.worst = i;
  }
  return result;
}

}  // namespace snug::runs
