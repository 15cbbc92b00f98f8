// Turning rows: what resists two bodies that roll or spin on each other, docs/theory/contact.md, section 3.
#include <algorithm>
#include <array>
#include <cmath>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

/// Whitened row of the angular velocity along d.
void fill_axis(const Whitening& whitening, const Vector3& d, double* out) {
  if (whitening.dense != nullptr) {
    Vector6 j;
    j << Vector3::Zero(), d;
    Eigen::Map<Vector6> row(out);
    row = whitening.dense->triangularView<Eigen::Upper>().transpose() * j;
    return;
  }
  for (int j = 0; j < 3; ++j) {
    out[j] = 0.0;
    out[3 + j] = d.dot(whitening.angular.col(j));
  }
}

/// Turns angular velocities into speeds at the rim, m: rows are then of the same size as those of contacts.
double lever_of(const Scratch& work, const Patch& patch) {
  double lever = 0.0;
  for (const int index : {patch.body_a, patch.body_b}) {
    const BodyWork& body = work.bodies[static_cast<std::size_t>(index)];
    const Contact& contact = work.contacts[static_cast<std::size_t>(patch.first_contact)];
    if (body.active >= 0) lever = std::max(lever, (contact.p_WQ - body.p_WBcm).norm());
  }
  return std::max(lever, 1e-3);
}

/// The axes of one side, which has sign -1 for A and 1 for B, from `column` on.
void add_side(const Scratch& work, const BodyWork& body, const std::array<Vector3, 2>& axes, double sign, int column,
              Row& row) {
  if (body.active < 0) {
    if (!body.is_moving) return;
    for (int i = 0; i < 2; ++i) row.bias[i + 1] += sign * axes[static_cast<std::size_t>(i)].dot(body.angular);
    return;
  }
  const Whitening& whitening = work.whitening[static_cast<std::size_t>(body.active)];
  std::fill_n(row.j[0] + column, 6, 0.0);
  for (int i = 0; i < 2; ++i) {
    fill_axis(whitening, sign * axes[static_cast<std::size_t>(i)], row.j[i + 1] + column);
  }
}

/// Everything but impulse and target. The normal axis is none: its law, gamma lambda = target, holds the impulse that
/// is known at `pressed`, and the disc of friction about it does the rest.
void fill_turning_row(const Scratch& work, const Patch& patch, double coefficient, Row& row) {
  const BodyWork& a = work.bodies[static_cast<std::size_t>(patch.body_a)];
  const BodyWork& b = work.bodies[static_cast<std::size_t>(patch.body_b)];
  const double lever = lever_of(work, patch);
  row.ia = a.active;
  row.ib = b.active;
  row.contact = patch.first_contact;
  row.mu = coefficient / lever;
  row.is_rigid = row.is_bounce = false;
  row.gap_end = 0.0;
  std::fill_n(row.bias, 3, 0.0);
  std::array<Vector3, 2> axes = {lever * patch.t1, lever * patch.t2};
  if (row.kind == RowKind::Spinning) axes = {lever * patch.n, Vector3::Zero()};
  add_side(work, a, axes, -1.0, 0, row);
  add_side(work, b, axes, 1.0, 6, row);
  row.gamma = 0.0;
  for (int k = 0; k < 6; ++k) {
    if (row.ia >= 0) row.gamma += row.a(1)[k] * row.a(1)[k];
    if (row.ib >= 0) row.gamma += row.b(1)[k] * row.b(1)[k];
  }
  finish_row(row);
}

/// Of the contacts of its patch, which stand before it.
double pressed_on(const Row* row) {
  const std::int32_t first = row->contact;
  double pressed = 0.0;
  while (row->kind != RowKind::Contact) --row;
  for (;; --row) {
    pressed += row->lambda[0];
    if (row->contact == first) return pressed;
  }
}

/// Speed that a wrong bound is worth, m/s.
double bound_error(const Row* row) {
  return row->mu * std::abs(pressed_on(row) - row->target / row->gamma) / row->step_t;
}

double worst_bound_error(const Row* first, const Row* end) {
  double worst = 0.0;
  for (const Row* row = first; row != end; ++row) {
    if (row->kind != RowKind::Contact) worst = std::max(worst, bound_error(row));
  }
  return worst;
}

}  // namespace

int count_turning_rows(const ContactLaw& law) {
  return (law.rolling_resistance > 0.0 ? 1 : 0) + (law.torsional_friction > 0.0 ? 1 : 0);
}

Row* build_turning_rows(const WorldModel& model, const WorldState& state, const Scratch& work, const Patch& patch,
                        bool is_kept, bool is_first, Row* row) {
  const ContactLaw& law = model.laws[patch.law];
  const PairState& pair = state.pairs[patch.pair];
  const double pressed = pair.turning.pressed, lever = lever_of(work, patch);
  for (const RowKind kind : {RowKind::Rolling, RowKind::Spinning}) {
    const bool rolls = kind == RowKind::Rolling;
    const double coefficient = rolls ? law.rolling_resistance : law.torsional_friction;
    if (coefficient <= 0.0) continue;
    row->kind = kind;
    if (!is_kept) fill_turning_row(work, patch, coefficient, *row);
    row->target = row->gamma * pressed;
    row->is_changed = true;
    if (is_first) {
      const Vector3 impulse = pair.turning.moment / lever;
      row->lambda[0] = pressed;
      row->lambda[1] = rolls ? impulse[1] : impulse[0];
      row->lambda[2] = rolls ? impulse[2] : 0.0;
      project_to_disc(row->mu * pressed, row->lambda[1], row->lambda[2]);
    }
    ++row;
  }
  return row;
}

SolveResult solve_with_turning(const StepSettings& settings, const Residuals& residuals, Row* first, Row* end,
                               double* u, NewtonScratch& newton) noexcept {
  // Solutions of jammed bodies share forces in many ways, and the next may share them otherwise: means of bounds settle
  // that. On random drops: decision 0027.
  constexpr int kMaxPasses = 10, kPlainPasses = 2;
  SolveResult result = solve_rows(settings, residuals, first, end, u, newton);
  for (int pass = 0; pass < kMaxPasses && result.has_converged; ++pass) {
    if (worst_bound_error(first, end) <= residuals.wanted) break;
    for (const Row* row = first; row != end; ++row) {
      const double back[3] = {-row->lambda[0], -row->lambda[1], -row->lambda[2]};
      apply(*row, back, u);
    }
    for (Row* row = first; row != end; ++row) {
      if (row->kind == RowKind::Contact) continue;
      const double before = row->target / row->gamma, found = pressed_on(row);
      const double pressed = pass < kPlainPasses ? found : 0.5 * (before + found);
      row->target = row->gamma * pressed;
      row->lambda[0] = pressed;
      project_to_disc(row->mu * pressed, row->lambda[1], row->lambda[2]);
    }
    const int iterations = result.iterations;
    result = solve_rows(settings, residuals, first, end, u, newton);
    result.iterations += iterations;
  }
  return result;
}

void keep_moment(const Row& row, const Scratch& work, const Patch& patch, PairState& pair) {
  pair.turning.pressed = 0.0;  // the points of the pair are kept before
  for (int i = 0; i < pair.count; ++i) pair.turning.pressed += pair.impulses[static_cast<std::size_t>(i)][0];
  const double lever = lever_of(work, patch);
  if (row.kind == RowKind::Spinning) {
    pair.turning.moment[0] = lever * row.lambda[1];
  } else {
    pair.turning.moment[1] = lever * row.lambda[1];
    pair.turning.moment[2] = lever * row.lambda[2];
  }
}

}  // namespace snug::physics::internal
