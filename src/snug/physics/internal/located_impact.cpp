// Located impact: a body that bears on fixed supports and strikes them with another point, as a block that rocks does.
#include "snug/physics/internal/located_impact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "snug/physics/internal/contact_path.hpp"

namespace snug::physics::internal {
namespace {

constexpr double kNever = -1e6;        ///< m/s, approach that nothing has: asks a contact for no impulse
constexpr std::size_t kMostRows = 32;  ///< of one body; more are solved as any island
/// Speed of impact over what gravity gives in a step, from which an impact is located.
constexpr double kFast = 2.0;
constexpr double kStays = 1e-5;  ///< m/s, at which a point opens that bears

/// What a row began with.
struct Before {
  double lambda[3];
  double target;
  bool is_changed;
  bool bore;     ///< touches, and carries the body up to an impact
  bool strikes;  ///< fast enough to be located, should it close in this step
};

struct Problem {
  Row* first = nullptr;
  std::size_t count = 0;
  int body = -1;  ///< in Scratch::bodies
  std::array<Before, kMostRows> before;
};

}  // namespace

int find_lone_body(const WorldModel& model, const WorldState& state, const Scratch& work, const Island& island) {
  int lone = -1;
  if (island.has_turning) return -1;
  for (int i = island.first_patch; i < island.end_patch; ++i) {
    const Patch& patch = work.patches[static_cast<std::size_t>(work.patch_order[static_cast<std::size_t>(i)])];
    const bool is_a = work.bodies[static_cast<std::size_t>(patch.body_a)].active >= 0;
    const int moving = is_a ? patch.body_a : patch.body_b, fixed = is_a ? patch.body_b : patch.body_a;
    const BodyWork& other = work.bodies[static_cast<std::size_t>(fixed)];
    const ContactLaw& law = model.laws[patch.law];
    if ((lone >= 0 && moving != lone) || other.active >= 0 || other.is_moving || patch.is_swept || patch.has_belt ||
        patch.moves_friction ||
        is_round(model, is_a ? state.pairs[patch.pair].geom_a : state.pairs[patch.pair].geom_b) ||
        law.stiffness > 0.0 || law.restitution > 0.0 || law.edge_friction)
      return -1;
    lone = moving;
  }
  return lone;
}

namespace {

/// Whether one contact bore and another one may strike.
bool note_rows(const WorldModel& model, const Scratch& work, Problem& problem) {
  const double fall = model.settings.dt * model.gravity.norm(), fast = kFast * fall;
  const double touches = model.settings.dt * fall;  // what carries may have opened for a step
  bool has_borne = false, may_strike = false;
  for (std::size_t i = 0; i < problem.count; ++i) {
    const Row& row = problem.first[i];
    const Contact& contact = work.contacts[static_cast<std::size_t>(row.contact)];
    Before& before = problem.before[i];
    std::copy_n(row.lambda, 3, before.lambda);
    before.target = row.target;
    before.is_changed = row.is_changed;
    before.strikes = !contact.is_covered && contact.approach < -fast;
    before.bore = !contact.is_covered && std::abs(contact.approach) <= fast && contact.phi <= touches;
    has_borne |= before.bore;
    may_strike |= before.strikes;
  }
  return has_borne && may_strike;
}

/// When the contact closes that has the normal velocity `end` at the end of the step, s; dt: not within it.
double closing_time(const Contact& contact, double end, double dt) {
  if (contact.phi <= 0.0) return 0.0;
  // phi + approach t + (end - approach) t^2 / (2 dt) = 0, the first root, in the form that does not cancel.
  const double a = 0.5 * (end - contact.approach) / dt, b = contact.approach;
  const double square = b * b - 4.0 * a * contact.phi;
  if (square < 0.0) return dt;
  const double q = -b + std::sqrt(square);
  return q > 0.0 ? std::min(dt, 2.0 * contact.phi / q) : dt;
}

void put_back(const Problem& problem) {
  for (std::size_t i = 0; i < problem.count; ++i) {
    Row& row = problem.first[i];
    std::copy_n(problem.before[i].lambda, 3, row.lambda);
    row.target = problem.before[i].target;
    row.is_changed = problem.before[i].is_changed;
  }
}

/// Rows with the arms that the body has after it has turned by `rotation`; they have no impulses.
void build_turned_rows(const WorldModel& model, const WorldState& state, const Island& island, const Vector3& rotation,
                       const Problem& problem, Scratch& work) {
  const Matrix3 R = exp_rotation(rotation);
  BodyWork& body = work.bodies[static_cast<std::size_t>(problem.body)];
  const Vector3& p_WBcm = body.p_WBcm;
  const bool turns = std::exchange(body.turns, false);  // arms are those of here
  std::array<Vector3, kMostRows> places;
  for (std::size_t i = 0; i < problem.count; ++i) {
    Vector3& p_WQ = work.contacts[static_cast<std::size_t>(problem.first[i].contact)].p_WQ;
    places[i] = p_WQ;
    p_WQ = p_WBcm + R * (p_WQ - p_WBcm);
  }
  for (int i = island.first_patch; i < island.end_patch; ++i)
    work.patches[static_cast<std::size_t>(work.patch_order[static_cast<std::size_t>(i)])].is_kept = false;
  arrange_planes(island, false, work);
  build_rows(model, state, work, island, false, nullptr);
  arrange_planes(island, true, work);
  body.turns = turns;
  for (std::size_t i = 0; i < problem.count; ++i) {
    work.contacts[static_cast<std::size_t>(problem.first[i].contact)].p_WQ = places[i];
    std::fill_n(problem.first[i].lambda, 3, 0.0);
  }
}

/// Adds the impulses of the rows, which then have none.
void take_impulses(const Problem& problem, std::array<Vector3, kMostRows>& sum) {
  for (std::size_t i = 0; i < problem.count; ++i) {
    Eigen::Map<Vector3> lambda(problem.first[i].lambda);
    sum[i] += lambda;
    lambda.setZero();
  }
}

}  // namespace

bool solve_located_impact(const WorldModel& model, const WorldState& state, Scratch& work, const Island& island,
                          int lone, const Residuals& residuals, NewtonScratch& newton, SolveResult& result) {
  Problem problem;
  problem.body = lone;
  problem.first = work.rows.begin() + island.first_row;
  problem.count = static_cast<std::size_t>(island.end_row - island.first_row);
  if (problem.count > kMostRows || !note_rows(model, work, problem)) return false;
  const double dt = model.settings.dt;
  const BodyWork& body = work.bodies[static_cast<std::size_t>(problem.body)];
  const auto active = static_cast<std::size_t>(body.active);
  const Whitening& whitening = work.whitening[active];
  Eigen::Map<Vector6> u(work.u.data() + 6 * active);
  const Vector6 start = whiten(whitening, body.velocity_start, body.angular_start), free = u;
  result = SolveResult{};
  const auto solve = [&] {
    const SolveResult part =
        solve_rows(model.settings, residuals, problem.first, problem.first + problem.count, work.u.data(), newton);
    result.iterations += part.iterations;
    result.residual = std::max(result.residual, part.residual);
    result.has_converged = result.has_converged && part.has_converged;
    result.is_infeasible = result.is_infeasible || part.is_infeasible;
  };

  // As if nothing struck.
  for (std::size_t i = 0; i < problem.count; ++i) {
    if (!problem.before[i].strikes) continue;
    problem.first[i].target = kNever;
    std::fill_n(problem.first[i].lambda, 3, 0.0);
  }
  solve();
  const Vector6 borne = u;
  double time = dt;
  bool closes_unborne = false;  // by the velocities without contacts
  std::array<bool, kMostRows> closes{};
  for (std::size_t i = 0; i < problem.count; ++i) {
    const Row& row = problem.first[i];
    const Contact& contact = work.contacts[static_cast<std::size_t>(row.contact)];
    if (!problem.before[i].strikes) continue;
    const double closing = closing_time(contact, relative_velocity(row, 0, work.u.data()), dt);
    closes[i] = closing < dt;
    closes_unborne |= problem.before[i].target >= 0.0;
    time = std::min(time, closing);
  }
  if (!(time < dt)) {
    if (closes_unborne) return true;  // in the next step: what bears holds it up
    u = free;
    put_back(problem);
    return false;
  }
  const double theta = time / dt;
  const Vector6 smooth = free - start;  // what a whole step without contacts adds

  // Up to the impact, with the arms of there.
  Vector3 velocity, angular;
  unwhiten(whitening, Vector6(start + 0.5 * theta * (borne - start)).eval().data(), velocity, angular);
  u = free;
  build_turned_rows(model, state, island, time * angular, problem, work);
  for (std::size_t i = 0; i < problem.count; ++i) problem.first[i].target = problem.before[i].bore ? 0.0 : kNever;
  u = start + theta * smooth;
  solve();
  const Vector6 before_impact = u;
  std::array<Vector3, kMostRows> impulses;
  impulses.fill(Vector3::Zero());
  take_impulses(problem, impulses);

  // The impact.
  for (std::size_t i = 0; i < problem.count; ++i) {
    const Contact& contact = work.contacts[static_cast<std::size_t>(problem.first[i].contact)];
    const double until_closed = std::min(0.0, -2.0 * contact.phi / dt - contact.approach);
    const bool is_closed = problem.before[i].bore || closes[i];
    problem.first[i].target = is_closed ? 0.0 : contact.is_covered ? kNever : until_closed;
  }
  solve();
  const Vector6 after_impact = u;
  take_impulses(problem, impulses);

  // From there on.
  u += (1.0 - theta) * smooth;
  solve();
  const Vector6 end = u;
  take_impulses(problem, impulses);

  Eigen::Map<Vector6>(work.shift.data() + 6 * active) =
      0.5 * dt * (theta * (start + before_impact) + (1.0 - theta) * (after_impact + end) - (start + end));
  for (std::size_t i = 0; i < problem.count; ++i) {
    Eigen::Map<Vector3>(problem.first[i].lambda) = impulses[i];
    problem.first[i].is_changed = true;
  }
  return true;
}

void hold_pivots(const WorldModel& model, const Island& island, int lone, Scratch& work) {
  const double fast = kFast * model.settings.dt * model.gravity.norm();
  const BodyWork& body = work.bodies[static_cast<std::size_t>(lone)];
  for (Row* row = work.rows.begin() + island.first_row; row != work.rows.begin() + island.end_row; ++row) {
    const Contact& contact = work.contacts[static_cast<std::size_t>(row->contact)];
    const Vector3& n = work.patches[static_cast<std::size_t>(contact.patch)].n;
    const bool rocks = n.cross(body.angular_start).squaredNorm() > kRocks * kRocks;
    const bool stays = std::abs(contact.approach) <= fast && relative_velocity(*row, 0, work.u.data()) <= kStays;
    if (rocks && stays && row->is_rigid && row->lambda[0] > 0.0) row->is_bounce = true;
  }
}

}  // namespace snug::physics::internal
