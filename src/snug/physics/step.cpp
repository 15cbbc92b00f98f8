// step: one instant to the next. Reads like the sequence in docs/theory/contact.md, section 1.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "snug/physics/internal/contact_path.hpp"
#include "snug/physics/internal/scratch.hpp"
#include "snug/physics/world.hpp"

namespace snug::physics {
namespace internal {
namespace {

constexpr double kFarthest = 1000.0;  ///< m; a body beyond is lost
/// m and rad in one step. A body that would move less stands still, bit by bit: rounding keeps nothing awake. At steps
/// of 1 ms that is 3 mm in a year.
constexpr double kStill = 1e-13;
/// A step is solved again at most this often for what bodies run into by turning.
constexpr int kSweptSolves = 3;

void start_body(const BodyModel& body, const WorldModel::MassProperties& mass, const BodyState& state,
                BodyMemory& memory, bool knows_state, BodyWork& work) {
  const bool same = knows_state && memory.p_WBcm == state.p_WBcm && memory.quat_WB.coeffs() == state.quat_WB.coeffs();
  if (!same) {
    memory.p_WBcm = state.p_WBcm;
    memory.quat_WB = state.quat_WB;
    work.R_WB = state.quat_WB.toRotationMatrix();
    work.p_WBcm = state.p_WBcm;
    work.p_WB = state.p_WBcm - work.R_WB * body.inertia.com;
  }
  work.active = work.island = -1;
  work.is_moving = work.has_element = work.is_steady = work.has_result = work.turns = work.is_lone = false;
  work.has_same_pose = same;
  work.velocity_start = work.velocity = state.velocity;
  work.angular_start = work.angular = state.angular_velocity;
  work.speed = state.velocity.norm() + state.angular_velocity.norm() * mass.radius;
}

void start_bodies(const WorldModel& model, const WorldState& state, Scratch& work) {
  for_ranges(work.pool, model.bodies.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const BodyState& body = state.bodies[i];
      start_body(model.bodies[i], model.masses[i], body, work.memories[i], work.knows_state, work.bodies[i]);
      work.is_moving[i] = model.bodies[i].kind == BodyKind::Dynamic && body.is_present && body.sleep_group < 0 ? 1 : 0;
    }
  });
  work.active_count = 0;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (work.is_moving[i] == 0) continue;
    work.bodies[i].is_moving = true;
    work.bodies[i].active = work.active_count;
    work.active[static_cast<std::size_t>(work.active_count++)] = static_cast<int>(i);
  }
}

/// Whether a kinematic body stays where it is: rotations pass through quaternions, which is not exact to the last bit.
bool stays(const BodyState& body, const Matrix3& R_WB, const Pose& X_WB_end) {
  return (X_WB_end.p - body.p_WBcm).cwiseAbs().maxCoeff() <= kStill &&
         (X_WB_end.R - R_WB).cwiseAbs().maxCoeff() <= kStill;
}

void start_kinematic(const BodyState& state, const KinematicTarget& target, double dt, double radius, BodyWork& work) {
  if (stays(state, work.R_WB, target.X_WB_end)) {
    work.velocity_start.setZero(), work.angular_start.setZero();
    work.velocity.setZero(), work.angular.setZero();
    work.speed = 0.0;
    return;
  }
  const Matrix3 R_end_start = target.X_WB_end.R * work.R_WB.transpose();
  work.velocity_start = (target.X_WB_end.p - state.p_WBcm) / dt;
  work.angular_start = log_rotation(R_end_start) / dt;
  work.velocity = work.velocity_start;
  work.angular = work.angular_start;
  work.angular_guess = work.angular;
  work.turns = turns_within(dt, work.angular_start);
  work.speed = work.velocity_start.norm() + work.angular_start.norm() * radius;
  if (target.V_WB_end) {  // the mean of both ends stays what leads to the end
    work.velocity = target.V_WB_end->linear;
    work.angular = target.V_WB_end->angular;
    work.velocity_start = 2.0 * work.velocity_start - work.velocity;
    work.angular_start = 2.0 * work.angular_start - work.angular;
    work.angular_guess = work.angular;
    for (const auto& [v, w] :
         {std::pair(work.velocity, work.angular), std::pair(work.velocity_start, work.angular_start)})
      work.speed = std::max(work.speed, v.norm() + w.norm() * radius);
  }
  work.is_moving = work.speed > 0.0;
}

bool has_finite(const BodyState& body) {
  return std::isfinite(body.p_WBcm.sum() + body.quat_WB.coeffs().sum() + body.velocity.sum() +
                       body.angular_velocity.sum());
}

void move_body(int index, const Scratch& work, BodyState& state) {
  const BodyWork& body = work.bodies[static_cast<std::size_t>(index)];
  const auto [way, rotation] = displacement_of(work, index);
  if (std::max(way.squaredNorm(), rotation.squaredNorm()) > kStill * kStill) {
    state.p_WBcm += way;
    state.quat_WB = (exp_quaternion(rotation) * state.quat_WB).normalized();
  }
  state.velocity = body.velocity;
  state.angular_velocity = body.angular;
}

/// The first index for which the condition holds, or `count`. It is asked of every index, by threads side by side.
template <class Condition>
std::size_t find_first(WorkerPool& pool, std::size_t count, const Condition& condition) {
  std::atomic<std::size_t> found{count};
  for_ranges(pool, count, [&](std::size_t first, std::size_t end) {
    std::size_t mine = count;
    for (std::size_t i = first; i < end; ++i) {
      if (condition(i)) mine = std::min(mine, i);
    }
    std::size_t least = found;
    while (mine < least && !found.compare_exchange_weak(least, mine)) {
    }
  });
  return found;
}

/// The first body whose state or input is not a number.
BodyId find_not_finite(const WorldInput& input, const WorldState& state, Scratch& work) {
  const std::size_t body = find_first(work.pool, state.bodies.size(), [&state](std::size_t i) {
    return state.bodies[i].is_present && !has_finite(state.bodies[i]);
  });
  if (body < state.bodies.size()) return BodyId{static_cast<int>(body)};
  for (const KinematicTarget& target : input.kinematic) {
    if (!target.X_WB_end.p.allFinite() || !target.X_WB_end.R.allFinite()) return target.body;
    if (target.V_WB_end && !as_vector(*target.V_WB_end).allFinite()) return target.body;
  }
  for (const ExternalWrench& wrench : input.wrenches) {
    if (!as_vector(wrench.wrench_W).allFinite()) return wrench.body;
  }
  return {};
}

/// Bodies of the contact with the largest residual.
BodyPair find_worst_pair(const Scratch& work) {
  BodyPair pair;
  double worst = -1.0;
  for (const Row& row : work.rows) {
    const double residual = natural_map(row, work.u.data());
    if (!(residual > worst)) continue;
    worst = residual;
    const Contact& contact = work.contacts[static_cast<std::size_t>(row.contact)];
    const Patch& patch = work.patches[static_cast<std::size_t>(contact.patch)];
    pair = {BodyId{patch.body_a}, BodyId{patch.body_b}};
  }
  return pair;
}

/// How long each body has been slow. What a moving kinematic body touches is not, nor what lies on a belt that runs.
void count_slow_time(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work) {
  const SleepSettings& sleep = model.settings.sleep;
  for_ranges(work.pool, static_cast<std::size_t>(work.active_count), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const auto index = static_cast<std::size_t>(work.active[i]);
      BodyState& body = state.bodies[index];
      const bool is_slow = body.velocity.norm() < sleep.linear_speed &&
                           body.angular_velocity.norm() < sleep.angular_speed && !work.bodies[index].has_element;
      body.slow_time = is_slow ? body.slow_time + model.settings.dt : 0.0;
    }
  });
  for (const ExternalWrench& wrench : input.wrenches) {
    state.bodies[static_cast<std::size_t>(wrench.body.index)].slow_time = 0.0;
  }
  if (input.kinematic.empty() && !work.has_belts) return;
  for (const Patch& patch : work.patches) {
    const BodyWork& a = work.bodies[static_cast<std::size_t>(patch.body_a)];
    const BodyWork& b = work.bodies[static_cast<std::size_t>(patch.body_b)];
    if ((a.active < 0 && a.is_moving) || patch.has_belt)
      state.bodies[static_cast<std::size_t>(patch.body_b)].slow_time = 0.0;
    if ((b.active < 0 && b.is_moving) || patch.has_belt)
      state.bodies[static_cast<std::size_t>(patch.body_a)].slow_time = 0.0;
  }
}

/// Wake and sleep rules: docs/theory/contact.md, section 6.
void put_to_sleep(const WorldModel& model, WorldState& state, Scratch& work) {
  // Islands are complete sets in the union-find forest. One that nothing carries never sleeps.
  const auto root_of = [&work](int i) {
    while (work.parent[static_cast<std::size_t>(i)] != i) i = work.parent[static_cast<std::size_t>(i)];
    return static_cast<std::size_t>(i);
  };
  for (int i = 0; i < work.active_count; ++i) {  // from here on: 1 may sleep, 0 must not
    int& island = work.island_of_root[static_cast<std::size_t>(i)];
    island = island >= 0 && work.islands[static_cast<std::size_t>(island)].is_carried ? 1 : 0;
  }
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < work.active_count; ++i) {
      int& may_sleep = work.island_of_root[root_of(i)];
      if (may_sleep == 0) continue;
      const auto index = static_cast<std::size_t>(work.active[static_cast<std::size_t>(i)]);
      BodyState& body = state.bodies[index];
      if (pass == 0) {
        may_sleep = body.slow_time >= model.settings.sleep.time ? 1 : 0;
      } else {
        body.sleep_group = work.active[root_of(i)];
        body.velocity.setZero();
        body.angular_velocity.setZero();
      }
    }
  }
}

}  // namespace

Displacement displacement_of(const Scratch& work, int body) {
  const BodyWork& b = work.bodies[static_cast<std::size_t>(body)];
  Vector3 slide = Vector3::Zero(), turn = Vector3::Zero();
  if (b.active >= 0) {
    const Eigen::Map<const Vector6> shift(work.shift.data() + 6 * b.active);
    if (!shift.isZero(0.0)) unwhiten(work.whitening[static_cast<std::size_t>(b.active)], shift.data(), slide, turn);
  }
  return {0.5 * work.dt * (b.velocity_start + b.velocity) + slide,
          0.5 * work.dt * (b.angular_start + b.angular) + turn};
}

bool begin_step(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work) {
  bool is_anything_moving = false;
  for (const ElementUse& use : input.elements) wake(state, use.body);
  for (const ExternalWrench& wrench : input.wrenches) wake(state, wrench.body);
  for (std::size_t i = 0; i < model.bodies.size() && !is_anything_moving; ++i) {
    is_anything_moving =
        model.bodies[i].kind == BodyKind::Dynamic && state.bodies[i].is_present && state.bodies[i].sleep_group < 0;
  }
  for (const KinematicTarget& target : input.kinematic) {
    const BodyState& body = state.bodies[static_cast<std::size_t>(target.body.index)];
    is_anything_moving |= !stays(body, body.quat_WB.toRotationMatrix(), target.X_WB_end);
  }
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (model.bodies[i].kind == BodyKind::Dynamic) continue;
    state.bodies[i].velocity.setZero();  // stands still unless it has a target
    state.bodies[i].angular_velocity.setZero();
  }
  if (!is_anything_moving) return false;
  start_bodies(model, state, work);
  for (const KinematicTarget& target : input.kinematic) {
    const auto i = static_cast<std::size_t>(target.body.index);
    if (!state.bodies[i].is_present) continue;
    start_kinematic(state.bodies[i], target, model.settings.dt, model.masses[i].radius, work.bodies[i]);
  }
  for (const ElementUse& use : input.elements) {
    if (state.bodies[static_cast<std::size_t>(use.body.index)].is_present) {
      work.bodies[static_cast<std::size_t>(use.body.index)].has_element = true;
    }
  }
  place_carriers(input, work);
  return true;
}

/// Velocities at the end of the step. Solved again while bodies that turn fast run into others by contacts that the
/// start of the step does not show (contact.md, section 5). False: too many contacts.
bool solve_step(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work,
                StepReport& report) {
  for (int again = kSweptSolves;; --again) {
    StepReport solved = report;
    free_motion(model, input, state, work);
    build_islands(input, work);
    solve_islands(model, input, state, work, solved);
    const bool is_last = again == 0 || solved.culprit.is_valid();
    const Swept swept = is_last ? Swept::Nothing : add_swept_contacts(model, state, work);
    if (swept == Swept::Nothing) {
      report = solved;
      return true;
    }
    if (swept == Swept::Sleepers) detect_contacts(model, input, state, work, report);
    if (work.has_too_many_contacts) return false;
  }
}

void end_step(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work, StepReport& report) {
  const auto count = static_cast<std::size_t>(work.active_count);
  const std::size_t culprit = find_first(work.pool, count, [&](std::size_t i) {
    BodyState& body = state.bodies[static_cast<std::size_t>(work.active[i])];
    move_body(work.active[i], work, body);
    return !has_finite(body) || body.p_WBcm.cwiseAbs().maxCoeff() > kFarthest;
  });
  if (culprit < count) {
    report.culprit = BodyId{work.active[culprit]};
    const bool is_lost = has_finite(state.bodies[static_cast<std::size_t>(report.culprit.index)]);
    report.status = is_lost ? StepStatus::LostBody : StepStatus::NotFinite;
  }
  for (const KinematicTarget& target : input.kinematic) {
    const auto i = static_cast<std::size_t>(target.body.index);
    BodyState& body = state.bodies[i];
    body.velocity = work.bodies[i].velocity;
    body.angular_velocity = work.bodies[i].angular;
    if (stays(body, body.quat_WB.toRotationMatrix(), target.X_WB_end)) continue;
    body.p_WBcm = target.X_WB_end.p;
    body.quat_WB = Quaternion(target.X_WB_end.R).normalized();
  }
  if (report.status == StepStatus::NotConverged) report.residual_pair = find_worst_pair(work);
  report.contacts = static_cast<int>(work.contacts.size());
  report.awake = work.active_count;
  if (!model.settings.sleep.enabled) return;
  count_slow_time(model, input, state, work);
  put_to_sleep(model, state, work);
}

void report_contacts(Scratch& work) {
  work.has_reports = true;
  work.reports.resize(work.contacts.size());
  for (const Row& row : work.rows) {
    if (row.kind != RowKind::Contact) continue;
    const Contact& contact = work.contacts[static_cast<std::size_t>(row.contact)];
    const Patch& patch = work.patches[static_cast<std::size_t>(contact.patch)];
    const Vector3 impulse = row.lambda[0] * patch.n + row.lambda[1] * patch.t1 + row.lambda[2] * patch.t2;
    const bool slides = is_at_friction_limit(row.mu, row.lambda[0], row.lambda[1], row.lambda[2]);
    work.reports[static_cast<std::size_t>(row.contact)] = {
        BodyId{patch.body_a}, BodyId{patch.body_b}, contact.p_WQ, patch.n, impulse / work.dt, contact.phi, slides};
  }
}

}  // namespace internal

StepReport step(const WorldModel& model, const WorldInput& input, WorldState& state, Workspace& workspace) noexcept {
  internal::Scratch& work = workspace.scratch();
  StepReport report;
  const auto stop = [&report](StepStatus status) {
    report.status = status;
    return report;
  };
  report.culprit = internal::find_not_finite(input, state, work);
  if (report.culprit.is_valid()) return stop(StepStatus::NotFinite);  // the contacts of the last step stay readable
  work.reports.clear();
  work.has_reports = true;
  work.dt = model.settings.dt;
  work.knows_state = state.stamp.value == work.stamp;
  ++state.step_index;
  if (!internal::begin_step(model, input, state, work)) return report;
  state.stamp = {};
  if (!internal::update_pairs(model, state, work)) return stop(StepStatus::TooManyPairs);
  internal::detect_contacts(model, input, state, work, report);
  if (work.has_too_many_contacts) return stop(StepStatus::TooManyPairs);
  if (!internal::solve_step(model, input, state, work, report)) return stop(StepStatus::TooManyPairs);
  if (report.culprit.is_valid()) return stop(StepStatus::NotFinite);
  internal::end_step(model, input, state, work, report);
  work.has_reports = false;
  work.last_rows = work.rows.size();
  state.stamp.value = ++work.stamp;
  return report;
}

}  // namespace snug::physics
