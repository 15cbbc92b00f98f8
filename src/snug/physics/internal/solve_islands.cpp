// Solves the islands of a step: free motion, contact rows, the contact solver, with Newton's method around it where
// force elements act.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "snug/physics/internal/contact_path.hpp"
#include "snug/physics/internal/free_turning.hpp"
#include "snug/physics/internal/located_impact.hpp"
#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kElementIterations = 12;
constexpr double kCalmSpeed = 2e-3;  ///< m/s, of every point of an island that may be coming to rest
/// Of the tolerance: islands at rest are solved so far that what is left moves nothing.
constexpr double kCalmResidual = 1e-3;

/// What the solver works for: islands that come to rest are solved further, because errors of one step would keep them
/// moving in the next.
Residuals residuals_of(const WorldModel& model, const Scratch& work, const Island& island) {
  const double tolerance = model.settings.tolerance;
  for (int i = island.first_patch; i < island.end_patch; ++i) {
    const Patch& patch = work.patches[static_cast<std::size_t>(work.patch_order[static_cast<std::size_t>(i)])];
    for (const int index : {patch.body_a, patch.body_b}) {
      if (work.bodies[static_cast<std::size_t>(index)].speed > kCalmSpeed) return {tolerance, tolerance};
    }
  }
  return {kCalmResidual * tolerance, tolerance};
}

/// Velocities that the contacts changed.
void read_velocities(Scratch& work, const Island& island) {
  for (int i = island.first_patch; i < island.end_patch; ++i) {
    const Patch& patch = work.patches[static_cast<std::size_t>(work.patch_order[static_cast<std::size_t>(i)])];
    for (const int index : {patch.body_a, patch.body_b}) {
      BodyWork& body = work.bodies[static_cast<std::size_t>(index)];
      if (body.active < 0 || body.has_result) continue;
      body.has_result = true;
      unwhiten(work.whitening[static_cast<std::size_t>(body.active)], work.u.data() + 6 * body.active, body.velocity,
               body.angular);
    }
  }
}

void solve_plain_island(const WorldModel& model, const WorldState& state, Scratch& work, Island& island,
                        IslandWorker& worker) {
  StepReport& report = worker.report;
  const int lone = find_lone_body(model, state, work, island);
  if (lone >= 0) work.bodies[static_cast<std::size_t>(lone)].is_lone = true;
  build_rows(model, state, work, island, true, pool_of(worker.newton.group.threads));
  arrange_planes(island, true, work);
  const auto solve = island.has_turning ? solve_with_turning : solve_rows;
  const Residuals residuals = residuals_of(model, work, island);
  SolveResult result;
  if (lone < 0 || !solve_located_impact(model, state, work, island, lone, residuals, worker.newton, result))
    result = solve(model.settings, residuals, work.rows.begin() + island.first_row, work.rows.begin() + island.end_row,
                   work.u.data(), worker.newton);
  if (lone >= 0) hold_pivots(model, island, lone, work);
  report.sweeps = std::max(report.sweeps, result.iterations);
  report.residual = std::max(report.residual, result.residual);
  if (!result.has_converged) report.status = StepStatus::NotConverged;
  island.is_infeasible = result.is_infeasible;
}

/// Copies the free velocities of the island's plain bodies into work.u (the solver changes them in place).
void reset_plain_bodies(Scratch& work, const Island& island) {
  for (int i = island.first_patch; i < island.end_patch; ++i) {
    const Patch& patch = work.patches[static_cast<std::size_t>(work.patch_order[static_cast<std::size_t>(i)])];
    for (const int index : {patch.body_a, patch.body_b}) {
      BodyWork& body = work.bodies[static_cast<std::size_t>(index)];
      if (body.active < 0 || body.has_element) continue;
      Eigen::Map<Vector6>(work.u.data() + 6 * body.active) =
          whiten(work.whitening[static_cast<std::size_t>(body.active)], body.velocity, body.angular);
    }
  }
}

/// Of several the one with the lowest index.
void name_culprit(BodyId culprit, StepReport& report) {
  if (culprit.is_valid() && (!report.culprit.is_valid() || culprit < report.culprit)) report.culprit = culprit;
}

void solve_element_island(const WorldModel& model, const WorldInput& input, const WorldState& state, Scratch& work,
                          int index, IslandWorker& worker) {
  const Island& island = work.islands[static_cast<std::size_t>(index)];
  StepReport& report = worker.report;
  BodyId culprit;
  find_element_bodies(input, work, index, worker.element_bodies);
  Row* first = work.rows.begin() + island.first_row;
  Row* end = work.rows.begin() + island.end_row;
  const auto solve = island.has_turning ? solve_with_turning : solve_rows;
  SolveResult result;
  const Residuals residuals{model.settings.tolerance, model.settings.tolerance};
  double error = 0.0;
  bool agrees = false;  // the wrenches with their linearisation
  for (int iteration = 0; iteration <= kElementIterations; ++iteration) {
    error = 0.0;
    for (ElementBody& body : worker.element_bodies) {
      error = std::max(error, evaluate_body(model, input, work, body));
      if (!body.forces.wrench.allFinite() && !culprit.is_valid()) culprit = BodyId{body.body};
    }
    agrees = iteration > 0 && error <= model.settings.tolerance;
    if (culprit.is_valid() || agrees || iteration == kElementIterations) break;
    for (const ElementBody& body : worker.element_bodies) linearize_body(model, input, work, body);
    reset_plain_bodies(work, island);
    if (iteration > 0) arrange_planes(island, false, work);
    build_rows(model, state, work, island, iteration == 0, pool_of(worker.newton.group.threads));
    arrange_planes(island, true, work);
    if (first != end) result = solve(model.settings, residuals, first, end, work.u.data(), worker.newton);
    report.sweeps = std::max(report.sweeps, result.iterations);
    for (const ElementBody& body : worker.element_bodies) {
      BodyWork& b = work.bodies[static_cast<std::size_t>(body.body)];
      unwhiten(work.whitening[static_cast<std::size_t>(b.active)], work.u.data() + 6 * b.active, b.velocity, b.angular);
    }
  }
  report.residual = std::max(report.residual, result.residual);
  work.islands[static_cast<std::size_t>(index)].is_infeasible = result.is_infeasible;
  if (!result.has_converged || !agrees) report.status = StepStatus::NotConverged;
  report.element_residual = std::max(report.element_residual, error);
  name_culprit(culprit, report);
}

/// Whether the contact presses against something that the solver does not move.
bool bears_on_fixed(const Row& row) {
  return row.kind == RowKind::Contact && (row.ia < 0 || row.ib < 0) && row.lambda[0] > 0.0;
}

/// What the next step starts from. Returns whether something carries the island.
bool keep_impulses(const Row* first, const Row* end, WorldState& state, const Scratch& work) {
  bool is_carried = false;
  for (const Row* row = first; row != end; ++row) {
    is_carried = is_carried || bears_on_fixed(*row);
    if (!row->is_changed) continue;
    const Contact& contact = work.contacts[static_cast<std::size_t>(row->contact)];
    const Patch& patch = work.patches[static_cast<std::size_t>(contact.patch)];
    if (row->kind != RowKind::Contact) {
      keep_moment(*row, work, patch, state.pairs[patch.pair]);
      continue;
    }
    if (patch.is_swept) continue;  // the next step finds its own point there
    state.pairs[patch.pair].impulses[static_cast<std::size_t>(contact.point)] = {row->lambda[0], row->lambda[1],
                                                                                 row->lambda[2]};
  }
  return is_carried;
}

/// Islands are independent: each touches only its own rows, bodies and pairs.
void solve_island(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work, int index,
                  IslandWorker& worker) {
  Island& island = work.islands[static_cast<std::size_t>(index)];
  if (island.has_element) {
    solve_element_island(model, input, state, work, index, worker);
  } else {
    solve_plain_island(model, state, work, island, worker);
  }
  Row* first = work.rows.begin() + island.first_row;
  Row* end = work.rows.begin() + island.end_row;
  // Rows that resist turning share what the pair keeps of it.
  WorkerPool* pool = island.has_turning ? nullptr : pool_of(worker.newton.group.threads);
  std::atomic<bool> is_carried{false};
  for_ranges(pool, static_cast<std::size_t>(end - first), [&](std::size_t begin, std::size_t past) {
    if (keep_impulses(first + begin, first + past, state, work)) is_carried = true;
  });
  island.is_carried = is_carried;
  worker.report.is_infeasible |= island.is_infeasible;
  worker.positions.run(model.settings, first, end, work.contacts.begin(), work.u.data(), work.centres.data(),
                       island.is_infeasible, work.shift.data(), pool_of(worker.newton.group.threads));
  arrange_planes(island, false, work);
  read_velocities(work, island);
}

int count_rows(const Scratch& work, int island) {
  const Island& of = work.islands[static_cast<std::size_t>(island)];
  return of.end_row - of.first_row;
}

/// Those with many rows first, the largest of all at the head, so that threads end at about the same time.
void order_islands(Scratch& work) {
  constexpr int kLarge = 48;  // rows; the order of smaller islands does not matter
  const auto first = work.island_order.begin(), end = first + work.island_count;
  std::iota(first, end, 0);
  if (work.pool.size() < 2 || work.island_count < 2) return;
  auto large_end = first;
  for (auto i = first; i != end; ++i) {
    if (count_rows(work, *i) >= kLarge) std::iter_swap(large_end++, i);
  }
  std::sort(first, large_end, [&](int a, int b) {
    return count_rows(work, a) != count_rows(work, b) ? count_rows(work, a) > count_rows(work, b) : a < b;
  });
}

/// Whether the largest island is solved by all threads: it has more rows than all others, and enough.
bool has_all_threads(const Scratch& work) {
  constexpr int kLeastRows = 400;
  const int largest = count_rows(work, work.island_order.front());
  return work.pool.size() > 1 && largest >= kLeastRows && 2 * largest > static_cast<int>(work.rows.size());
}

/// Whether it pays to share the islands from this one on.
bool pays_to_share(const Scratch& work, int first) {
  constexpr int kLeastRows = 200;  // beside the largest of them, about 50 us of work
  if (work.pool.size() < 2 || work.island_count - first < 2) return false;
  int rows = 0;
  for (int i = first + 1; i < work.island_count; ++i) {
    rows += count_rows(work, work.island_order[static_cast<std::size_t>(i)]);
  }
  return rows >= kLeastRows;
}

void add_report(const StepReport& part, StepReport& report) {
  report.sweeps = std::max(report.sweeps, part.sweeps);
  report.residual = std::max(report.residual, part.residual);
  report.element_residual = std::max(report.element_residual, part.element_residual);
  if (part.status != StepStatus::Converged) report.status = part.status;
  report.is_infeasible |= part.is_infeasible;
  name_culprit(part.culprit, report);
}

/// A body that is not moved by the solver.
void keep_memory(BodyWork& body, BodyMemory& memory) {
  body.is_steady = body.has_same_pose && !body.is_moving && memory.is_plain && memory.active < 0;
  memory.is_plain = !body.is_moving;
  memory.active = -1;
}

/// Whether gyroscopic torque matters.
bool turns_fast(const BodyWork& body, double dt) {
  return !body.has_element && dt * body.angular_start.squaredNorm() > 1e-9;
}

/// Part of its angular velocity by which contacts may turn a body in a step and still be taken for a motion that goes
/// on, not for a blow.
constexpr double kSmoothPush = 0.25;

void move_freely(const WorldModel& model, const WorldModel::MassProperties& mass, const Vector3& last_torque,
                 BodyWork& body, BodyMemory& memory, Whitening& whitening) {
  const double dt = model.settings.dt;
  body.velocity = body.velocity_start + dt * model.gravity;
  body.angular = body.angular_start;
  body.has_result = false;
  // Inertia at the middle of the step: what makes turning under a torque second order.
  const bool turns = dt * dt * body.angular_start.squaredNorm() > 1e-18;
  const bool is_plain = !turns && !body.has_element;
  body.is_steady = body.has_same_pose && is_plain && memory.is_plain && memory.active == body.active;
  memory.is_plain = is_plain;
  memory.active = body.active;
  if (!body.is_steady) {
    const Matrix3 R_WB_mid = turns ? Matrix3(exp_rotation(0.5 * dt * body.angular_start) * body.R_WB) : body.R_WB;
    whitening = plain_whitening(mass, R_WB_mid);
  }
  if (body.has_element) {  // first guess of Newton's method
    body.velocity = body.velocity_start;
    return;
  }
  if (!turns_fast(body, dt)) return;
  // The gyroscopic torque is that of the motion under the contacts of the step before, where it is smooth; what these
  // push is left to the solver.
  const Vector3 push = whitening.angular * (whitening.angular.transpose() * last_torque);
  const bool is_smooth = push.norm() <= kSmoothPush * body.angular_start.norm();
  body.angular_guess = turn_freely(mass, body, is_smooth ? last_torque : Vector3::Zero(), dt);
  body.angular = body.angular_guess;
  if (is_smooth) body.angular -= push;
}

/// What the contacts of the step before push on bodies that turn fast.
void find_last_torques(const WorldModel& model, const WorldState& state, Scratch& work) {
  bool has_fast = false;
  for (int i = 0; i < work.active_count; ++i) {
    BodyWork& body = work.bodies[static_cast<std::size_t>(work.active[static_cast<std::size_t>(i)])];
    body.angular_guess = body.angular_start;
    body.turns = turns_within(model.settings.dt, body.angular_start);
    has_fast |= turns_fast(body, model.settings.dt);
    work.last_torque[static_cast<std::size_t>(i)].setZero();
  }
  if (!has_fast) return;
  for (const Patch& patch : work.patches) {
    if (patch.is_swept) continue;
    for (const bool is_b : {false, true}) {
      const BodyWork& body = work.bodies[static_cast<std::size_t>(is_b ? patch.body_b : patch.body_a)];
      if (body.active < 0 || !turns_fast(body, model.settings.dt)) continue;
      for (int i = patch.first_contact; i < patch.first_contact + patch.contact_count; ++i) {
        const Contact& contact = work.contacts[static_cast<std::size_t>(i)];
        const auto& impulse = state.pairs[patch.pair].impulses[static_cast<std::size_t>(contact.point)];
        if (!follows_path(model, state, work, patch, contact)) continue;
        const Vector3 on_b = impulse[0] * patch.n + impulse[1] * patch.t1 + impulse[2] * patch.t2;
        const ContactArms arms = arms_of(model, state, work, patch, contact);
        const Vector3& arm = is_b ? arms.b_mid : arms.a_mid;
        work.last_torque[static_cast<std::size_t>(body.active)] += arm.cross(is_b ? on_b : Vector3(-on_b));
      }
    }
  }
}

}  // namespace

void free_motion(const WorldModel& model, const WorldInput& input, const WorldState& state, Scratch& work) {
  const double dt = model.settings.dt;
  if (!input.elements.empty()) work.dense_whitening.resize(static_cast<std::size_t>(work.active_count));
  find_last_torques(model, state, work);
  for_ranges(work.pool, work.bodies.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      BodyWork& body = work.bodies[i];
      if (body.active < 0) {
        keep_memory(body, work.memories[i]);
      } else {
        const auto active = static_cast<std::size_t>(body.active);
        move_freely(model, model.masses[i], work.last_torque[active], body, work.memories[i], work.whitening[active]);
      }
    }
  });
  for (const ExternalWrench& wrench : input.wrenches) {
    BodyWork& body = work.bodies[static_cast<std::size_t>(wrench.body.index)];
    if (body.active < 0 || body.has_element) continue;
    const WorldModel::MassProperties& mass = model.masses[static_cast<std::size_t>(wrench.body.index)];
    const Matrix3& T = work.whitening[static_cast<std::size_t>(body.active)].angular;
    body.velocity += dt * mass.inverse_mass * wrench.wrench_W.force;
    body.angular += dt * (T * (T.transpose() * wrench.wrench_W.torque));
  }
}

void solve_islands(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work,
                   StepReport& report) {
  for_ranges(work.pool, static_cast<std::size_t>(work.active_count), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const BodyWork& body = work.bodies[static_cast<std::size_t>(work.active[i])];
      Eigen::Map<Vector6>(work.u.data() + 6 * i) = whiten(work.whitening[i], body.velocity, body.angular);
      work.centres[i] = body.p_WBcm;
    }
  });
  work.rows.resize(static_cast<std::size_t>(work.row_count));
  std::fill_n(work.shift.begin(), 6 * work.active_count, 0.0);
  order_islands(work);
  for (IslandWorker& worker : work.workers) worker.report = StepReport{}, worker.newton.group.threads = nullptr;
  const auto solve = [&](int i, int worker) {
    solve_island(model, input, state, work, work.island_order[static_cast<std::size_t>(i)],
                 work.workers[static_cast<std::size_t>(worker)]);
  };
  int begin = 0;
  if (work.island_count > 0 && has_all_threads(work)) {
    work.workers.front().newton.group.threads = &work.solver_threads;
    solve(begin++, 0);
    work.workers.front().newton.group.threads = nullptr;
  }
  if (pays_to_share(work, begin)) {
    work.pool.run(work.island_count - begin, [&](int i, int worker) { solve(begin + i, worker); });
  } else {
    for (int i = begin; i < work.island_count; ++i) solve(i, 0);
  }
  for (const IslandWorker& worker : work.workers) add_report(worker.report, report);
}

}  // namespace snug::physics::internal
