// Contact rows: the contacts of an island as rows J T of the contact problem, with the law of this step.
#include <algorithm>
#include <cmath>

#include "snug/physics/internal/contact_path.hpp"
#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kEdgePoints = 2;  ///< as many contacts of a patch, or fewer, are an edge or a corner
/// m, gap and way in the step up to which a point of a face stays where it is (decision 0099).
constexpr double kHeld = 1e-5;
/// Rows of an island from which on contacts that stand nearer than the position slop are closed: else the gaps that the
/// correction of positions leaves open and close one after the other (decision 0104).
constexpr int kHeapRows = 512;
constexpr double kNever = -1e6;  ///< m/s, approach that nothing has: asks a contact for no impulse

/// How a body enters the rows of a patch: whitened J of axis i at arm r is sign (L_i, G_i r), G_i a 3 x 3 matrix.
struct Side {
  int active = -1;
  Vector3 p_WBcm;
  double linear[3][3];                  ///< L_i; unused when dense
  Eigen::Matrix<double, 9, 3> angular;  ///< G_i stacked: row 3 i + j is (d_i x t_j), t_j columns of the whitening
  const Whitening* whitening = nullptr;
  double sign = 1.0;
};

Side side_of(const Scratch& work, const BodyWork& body, const Patch& patch, const Vector3& way, double sign) {
  Side side;
  side.active = body.active;
  side.sign = sign;
  if (body.active < 0) return side;
  side.p_WBcm = body.p_WBcm + way;
  side.whitening = &work.whitening[static_cast<std::size_t>(body.active)];
  if (side.whitening->dense != nullptr) return side;
  const Vector3* axes[3] = {&patch.n, &patch.t1, &patch.t2};
  for (int i = 0; i < 3; ++i) {
    const Vector3 d = sign * *axes[i];
    for (int j = 0; j < 3; ++j) {
      side.linear[i][j] = side.whitening->linear * d[j];
      side.angular.row(3 * i + j) = d.cross(side.whitening->angular.col(j)).transpose();
    }
  }
  return side;
}

/// Axes of a row, [first, end): those of both laws, of the normal law, of friction.
template <int kFirst, int kEnd>
struct Axes {
  static constexpr int first = kFirst, end = kEnd;
};
using AllAxes = Axes<0, 3>;
using NormalAxis = Axes<0, 1>;
using TangentAxes = Axes<1, 3>;

/// From `column` on.
template <class Range>
void fill_side(const Side& side, const Patch& patch, const Vector3& arm, int column, Row& row) {
  if (side.whitening->dense != nullptr) {
    const Vector3* axes[3] = {&patch.n, &patch.t1, &patch.t2};
    for (int i = Range::first; i < Range::end; ++i) {
      Vector6 j;
      j << side.sign * *axes[i], arm.cross(side.sign * *axes[i]);
      Eigen::Map<Vector6> out(row.j[i] + column);
      out = side.whitening->dense->triangularView<Eigen::Upper>().transpose() * j;
    }
    return;
  }
  const Eigen::Matrix<double, 9, 1> angular = side.angular * arm;
  for (int i = Range::first; i < Range::end; ++i) {
    for (int j = 0; j < 3; ++j) {
      row.j[i][column + j] = side.linear[i][j];
      row.j[i][column + 3 + j] = angular[3 * i + j];
    }
  }
}

/// Relative velocity that the unknowns do not hold.
template <class Range>
void add_velocity(const Vector3& velocity, const Patch& patch, double sign, Row& row) {
  if (Range::first == 0) row.bias[0] += sign * patch.n.dot(velocity);
  if (Range::end < 3) return;
  row.bias[1] += sign * patch.t1.dot(velocity);
  row.bias[2] += sign * patch.t2.dot(velocity);
}

/// What a moving kinematic body brings in.
template <class Range>
void add_bias(const BodyWork& body, const Patch& patch, const Vector3& arm, double sign, Row& row) {
  add_velocity<Range>(body.velocity + body.angular.cross(arm), patch, sign, row);
}

/// Large piles do not fit into the caches near the core: asks for a row before it is needed.
void prefetch(const Row* row) {
  constexpr std::size_t kLine = 64;
  const char* bytes = reinterpret_cast<const char*>(row);
  for (std::size_t i = 0; i < sizeof(Row); i += kLine) __builtin_prefetch(bytes + i, 1);
}

/// The bodies of a patch, and how they enter its rows.
struct Sides {
  const BodyWork& a;
  const BodyWork& b;
  Side side_a, side_b;
};

/// J of a contact that acts at contact.p_WQ, and what moving kinematic bodies bring in.
template <class Range>
void fill_axes(const WorldModel& model, const WorldState& state, const Scratch& work, const Patch& patch,
               const Sides& sides, const Contact& contact, Row& row) {
  const BodyWork &a = sides.a, &b = sides.b;
  const Vector3& p_WQ = contact.p_WQ;
  if (follows_path(model, state, work, patch, contact)) {
    // Impulses act at the middle of the step; the law is that of the velocities at its end, with the arms of there.
    const ContactArms arms = arms_of(model, state, work, patch, contact);
    if (a.active >= 0) {
      fill_side<Range>(sides.side_a, patch, arms.a_mid, 0, row);
      add_velocity<Range>(a.angular_guess.cross(arms.a_end - arms.a_mid), patch, -1.0, row);
    } else if (a.is_moving) {
      add_bias<Range>(a, patch, arms.a_end, -1.0, row);
    }
    if (b.active >= 0) {
      fill_side<Range>(sides.side_b, patch, arms.b_mid, 6, row);
      add_velocity<Range>(b.angular_guess.cross(arms.b_end - arms.b_mid), patch, 1.0, row);
    } else if (b.is_moving) {
      add_bias<Range>(b, patch, arms.b_end, 1.0, row);
    }
    return;
  }
  if (a.active >= 0) fill_side<Range>(sides.side_a, patch, p_WQ - sides.side_a.p_WBcm, 0, row);
  if (b.active >= 0) fill_side<Range>(sides.side_b, patch, p_WQ - sides.side_b.p_WBcm, 6, row);
  if (a.active < 0 && a.is_moving) add_bias<Range>(a, patch, p_WQ - a.p_WBcm - patch.way_a, -1.0, row);
  if (b.active < 0 && b.is_moving) add_bias<Range>(b, patch, p_WQ - b.p_WBcm - patch.way_b, 1.0, row);
}

/// J of a contact, index in Scratch::contacts, and what moving kinematic bodies and belts bring in.
void fill_contact_row(const WorldModel& model, const WorldState& state, const Scratch& work, const Patch& patch,
                      const Sides& sides, int index, Row& row) {
  const Contact& contact = work.contacts[static_cast<std::size_t>(index)];
  row.ia = sides.a.active;
  row.ib = sides.b.active;
  row.contact = index;
  row.kind = RowKind::Contact;
  std::fill_n(row.bias, 3, 0.0);
  if (patch.moves_friction) {
    Contact at_friction = contact;
    at_friction.p_WQ = work.friction_points[static_cast<std::size_t>(index)].p_WQ;
    fill_axes<NormalAxis>(model, state, work, patch, sides, contact, row);
    fill_axes<TangentAxes>(model, state, work, patch, sides, at_friction, row);
  } else {
    fill_axes<AllAxes>(model, state, work, patch, sides, contact, row);
  }
  if (patch.has_belt) row.bias[1] += patch.t1.dot(patch.belt_W), row.bias[2] += patch.t2.dot(patch.belt_W);
}

/// Normal speed for an impulse, 1/kg: of the contact alone, or of the bodies without turning.
double normal_mobility(const Row& row, bool turns) {
  double sum = 0.0;
  for (int k = 0; k < (turns ? 6 : 3); ++k) {
    if (row.ia >= 0) sum += row.a(0)[k] * row.a(0)[k];
    if (row.ib >= 0) sum += row.b(0)[k] * row.b(0)[k];
  }
  return sum;
}

/// Fraction of the step at which a contact closes by the velocities without contacts. 0: is closed; 1: stays open.
double closing_fraction(const Contact& contact, double free_velocity, double dt) {
  if (contact.phi <= 0.0) return 0.0;
  const double mean = 0.5 * (contact.approach + free_velocity);
  return contact.phi + dt * mean > 0.0 ? 1.0 : std::clamp(-contact.phi / (dt * mean), 0.0, 1.0);
}

/// A spring at the middle of the step and a damper between there and its end, so placed that a body that bounces on its
/// face decays as d says at any time step; both from where the contact closes. bearing: contacts of the patch that are
/// closed in this step. docs/theory/contact.md, section 3.
void fill_compliant_law(const ContactLaw& law, double dt, const Patch& patch, const Contact& contact,
                        double free_velocity, int bearing, Row& row) {
  const bool is_beyond = law.travel > 0.0 && -contact.phi > law.travel;
  const double whole = patch.share * (is_beyond ? law.stiffness_beyond : law.stiffness);
  const double k = whole / bearing;
  // A spring of this stiffness that bears what it bears at this depth starts here.
  const double phi = contact.phi + (is_beyond ? law.travel * (1.0 - law.stiffness / law.stiffness_beyond) : 0.0);
  const double closed = 1.0 - closing_fraction(contact, free_velocity, dt);
  if (closed <= 0.0) {
    row.target = kNever;
    return;
  }
  const double mobility = normal_mobility(row, true), critical = 2.0 * std::sqrt(k / mobility);
  const double d = patch.share * law.damping / bearing + law.damping_ratio * critical;
  const double x = whole * dt * dt * normal_mobility(row, false), y = d * dt * mobility;
  const double theta = y > 1e-3 ? 1.0 / -std::expm1(-y) - 1.0 / y : 0.5 + y / 12.0;
  const double fitted = d * (1.0 + 0.25 * x * std::min(1.0, 4.0 * x / (y * y)));
  const double to_end = closed * (0.25 * k * dt + theta * fitted);
  const double to_start = closed * (0.25 * k * dt + (1.0 - theta) * fitted);
  row.gamma = 1.0 / (dt * to_end);
  // A contact that closes in the step has, while it is closed, half the depth of the end on average.
  const double deep = contact.phi > 0.0 ? 0.5 * closed * k * phi : k * phi;
  row.target = -(deep + to_start * contact.approach) / to_end;
}

/// The law of one contact in this step: docs/theory/contact.md, section 3.
void fill_law(const WorldModel& model, const Patch& patch, const Contact& contact, double free_velocity, int bearing,
              bool is_heap, Row& row) {
  const double dt = model.settings.dt;
  const double mean = 0.5 * (contact.approach + free_velocity);
  const ContactLaw& law = model.laws[patch.law];
  row.mu = bearing <= kEdgePoints ? law.edge_friction.value_or(law.friction) : law.friction;
  row.gamma = 0.0;
  row.gap_end = 0.0;
  row.is_bounce = false;
  row.is_rigid = law.stiffness <= 0.0 && !contact.is_covered;
  if (contact.is_covered) {
    row.target = kNever;
    return;
  }
  if (!row.is_rigid) {
    fill_compliant_law(law, dt, patch, contact, free_velocity, bearing, row);
    return;
  }
  // Else points of a face that lie a little apart would bear nothing, one after the other.
  const bool is_held = patch.moves_friction && contact.phi <= kHeld && std::abs(contact.approach) * dt <= kHeld;
  if (is_held) {
    row.target = 0.0;
    return;
  }
  if (contact.phi + dt * mean > 0.0) {  // does not close by itself: may be pushed as far as closing
    const double slop = model.settings.position_slop;
    const bool stands = contact.phi <= slop && std::abs(dt * mean) <= slop &&
                        std::abs(contact.approach) <= model.settings.restitution_threshold;
    if (is_heap && stands) {
      row.target = 0.0;
      return;
    }
    row.target = std::min(0.0, -2.0 * contact.phi / dt - contact.approach);
    return;
  }
  // Closes at the fraction theta of the step, with this speed.
  const double theta = closing_fraction(contact, free_velocity, dt);
  const double impact = contact.approach + theta * (free_velocity - contact.approach);
  row.target = 0.0;
  if (law.restitution > 0.0 && impact < -model.settings.restitution_threshold) {
    const double rest = (1.0 - theta) * (free_velocity - contact.approach);  // acceleration after the impact
    row.target = std::max(0.0, -law.restitution * impact + rest);
    row.gap_end = std::max(0.0, (1.0 - theta) * dt * (-law.restitution * impact + 0.5 * rest));
    row.is_bounce = true;
  }
}

/// Contacts of a patch, rows from `first` on, that are closed in this step, at least one: they share its stiffness, and
/// say whether it is an edge. 1 where the law asks for neither.
int count_bearing(const WorldModel& model, const Scratch& work, const Patch& patch, const Row* first) {
  const ContactLaw& law = model.laws[patch.law];
  if (law.stiffness <= 0.0 && !law.edge_friction) return 1;
  int count = 0;
  for (int i = 0; i < patch.contact_count; ++i) {
    const Contact& contact = work.contacts[static_cast<std::size_t>(patch.first_contact + i)];
    const double velocity = relative_velocity(first[i], 0, work.u.data());
    if (closing_fraction(contact, velocity, model.settings.dt) < 1.0) ++count;
  }
  return std::max(1, count);
}

/// The impulses of the step before, cut to the cone of this one.
void cut_to_cone(Row& row) {
  row.lambda[0] = std::max(0.0, row.lambda[0]);  // negative only when it is new
  const double limit = row.mu * row.lambda[0];
  const double square = row.lambda[1] * row.lambda[1] + row.lambda[2] * row.lambda[2];
  if (square <= limit * limit) return;
  row.is_changed = true;
  const double scale = limit / std::sqrt(square);
  row.lambda[1] *= scale;
  row.lambda[2] *= scale;
}

void drop_impulse(Row& row) {
  row.is_changed |= row.lambda[0] != 0.0;
  std::fill_n(row.lambda, 3, 0.0);
}

void build_patch_rows(const WorldModel& model, const WorldState& state, Scratch& work, const Patch& patch, bool is_heap,
                      bool is_first) {
  Row* row = work.rows.begin() + patch.first_row;
  const BodyWork& a = work.bodies[static_cast<std::size_t>(patch.body_a)];
  const BodyWork& b = work.bodies[static_cast<std::size_t>(patch.body_b)];
  const auto row_index = static_cast<std::size_t>(patch.first_row);
  const bool is_kept = patch.is_kept && a.is_steady && b.is_steady && row->contact == patch.first_contact &&
                       row->kind == RowKind::Contact &&
                       row_index + static_cast<std::size_t>(patch.row_count) <= work.last_rows;
  if (!is_kept) {
    const Sides sides{a, b, side_of(work, a, patch, patch.way_a, -1.0), side_of(work, b, patch, patch.way_b, 1.0)};
    for (int k = 0; k < patch.contact_count; ++k) {
      prefetch(row + k + 4);
      fill_contact_row(model, state, work, patch, sides, patch.first_contact + k, row[k]);
    }
  }
  const int bearing = count_bearing(model, work, patch, row);
  for (int k = patch.first_contact; k < patch.first_contact + patch.contact_count; ++k, ++row) {
    if (is_kept) prefetch(row + 4);
    const Contact& contact = work.contacts[static_cast<std::size_t>(k)];
    fill_law(model, patch, contact, relative_velocity(*row, 0, work.u.data()), bearing, is_heap, *row);
    if (patch.moves_friction) row->mu *= work.friction_points[static_cast<std::size_t>(k)].fraction;
    if (!is_kept) finish_row(*row);
    if (!is_first) continue;
    if (patch.is_swept) {
      std::fill_n(row->lambda, 3, 0.0);
    } else if (!is_kept) {
      const auto& impulse = state.pairs[patch.pair].impulses[static_cast<std::size_t>(contact.point)];
      std::copy(impulse.begin(), impulse.end(), row->lambda);
    }
    row->is_changed = !is_kept;
    if (contact.is_covered) drop_impulse(*row);
    cut_to_cone(*row);
  }
  if (patch.row_count > patch.contact_count)
    (void)build_turning_rows(model, state, work, patch, is_kept, is_first, row);
}

}  // namespace

void build_rows(const WorldModel& model, const WorldState& state, Scratch& work, const Island& island, bool is_first,
                WorkerPool* pool) {
  const bool is_heap = island.end_row - island.first_row >= kHeapRows;
  const auto count = static_cast<std::size_t>(island.end_patch - island.first_patch);
  for_ranges(pool, count, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const int patch = work.patch_order[static_cast<std::size_t>(island.first_patch) + i];
      build_patch_rows(model, state, work, work.patches[static_cast<std::size_t>(patch)], is_heap, is_first);
    }
  });
}

}  // namespace snug::physics::internal
