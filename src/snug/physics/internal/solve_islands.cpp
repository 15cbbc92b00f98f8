// Solves the islands of a step: contact rows, implicit force elements by Newton's method, the contact solver inside.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kElementIterations = 12;

Whitening plain_whitening(const WorldModel::MassProperties& mass, const Matrix3& R_WB) {
  Whitening whitening;
  whitening.linear = std::sqrt(mass.inverse_mass);
  whitening.angular = (R_WB * mass.R_BI) * mass.inverse_inertia.cwiseSqrt().asDiagonal();
  return whitening;
}

/// u = T^-1 v.
Vector6 whiten(const Whitening& whitening, const Vector3& linear, const Vector3& angular) {
  Vector6 v;
  v << linear, angular;
  if (whitening.is_dense) return whitening.dense.triangularView<Eigen::Upper>().solve(v);
  Vector6 u;
  u.head<3>() = linear / whitening.linear;
  // The columns of the angular part are orthogonal: its inverse is its transpose over the squared lengths.
  u.tail<3>() =
      (whitening.angular.transpose() * angular).cwiseQuotient(whitening.angular.colwise().squaredNorm().transpose());
  return u;
}

void unwhiten(const Whitening& whitening, const double* u, Vector3& linear, Vector3& angular) {
  const Eigen::Map<const Vector6> map(u);
  if (whitening.is_dense) {
    const Vector6 v = whitening.dense.triangularView<Eigen::Upper>() * map;
    linear = v.head<3>();
    angular = v.tail<3>();
    return;
  }
  linear = whitening.linear * map.head<3>();
  angular = whitening.angular * map.tail<3>();
}

/// How a body enters the rows of a patch: whitened J of axis i at arm r is sign (L_i, G_i r), G_i a 3 x 3 matrix.
struct Side {
  int active = -1;
  Vector3 p_WBcm;
  double linear[3][3];                  ///< L_i; unused when dense
  Eigen::Matrix<double, 9, 3> angular;  ///< G_i stacked: row 3 i + j is (d_i x t_j), t_j columns of the whitening
  const Whitening* whitening = nullptr;
  double sign = 1.0;
};

Side side_of(const Scratch& work, const BodyWork& body, const Patch& patch, double sign) {
  Side side;
  side.active = body.active;
  side.sign = sign;
  if (body.active < 0) return side;
  side.p_WBcm = body.p_WBcm;
  side.whitening = &work.whitening[static_cast<std::size_t>(body.active)];
  if (side.whitening->is_dense) return side;
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

void fill_side(const Side& side, const Patch& patch, const Vector3& p_WQ, double (&out)[3][6]) {
  const Vector3 arm = p_WQ - side.p_WBcm;
  if (side.whitening->is_dense) {
    const Vector3* axes[3] = {&patch.n, &patch.t1, &patch.t2};
    for (int i = 0; i < 3; ++i) {
      Vector6 j;
      j << side.sign * *axes[i], arm.cross(side.sign * *axes[i]);
      Eigen::Map<Vector6> row(out[i]);
      row = side.whitening->dense.triangularView<Eigen::Upper>().transpose() * j;
    }
    return;
  }
  const Eigen::Matrix<double, 9, 1> angular = side.angular * arm;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      out[i][j] = side.linear[i][j];
      out[i][3 + j] = angular[3 * i + j];
    }
  }
}

/// Relative velocity that a moving kinematic body brings in.
void add_bias(const BodyWork& body, const Patch& patch, const Vector3& p_WQ, double sign, Row& row) {
  const Vector3 v = sign * (body.velocity_start + body.angular_start.cross(p_WQ - body.p_WBcm));
  row.bias[0] += patch.n.dot(v);
  row.bias[1] += patch.t1.dot(v);
  row.bias[2] += patch.t2.dot(v);
}

/// The law of one contact in this step: docs/theory/contact.md, section 3.
void fill_law(const WorldModel& model, const Patch& patch, const Contact& contact, double free_velocity, Row& row) {
  const double dt = model.settings.dt;
  const double mean = 0.5 * (contact.approach + free_velocity);
  const ContactLaw& law = model.laws[patch.law];
  row.mu = law.friction;
  row.gamma = 0.0;
  row.gap_end = 0.0;
  row.is_bounce = false;
  row.is_rigid = law.stiffness <= 0.0;
  if (!row.is_rigid) {
    const double k = law.stiffness / patch.contact_count, d = law.damping / patch.contact_count;
    const double s = 0.5 * k * dt + d;
    row.gamma = 1.0 / (dt * s);
    row.target = -k * (contact.phi + 0.5 * dt * contact.approach) / s;
    return;
  }
  if (contact.phi + dt * mean > 0.0) {  // does not close by itself: may be pushed as far as closing
    row.target = std::min(0.0, -2.0 * contact.phi / dt - contact.approach);
    return;
  }
  // Closes at the fraction theta of the step, with this speed.
  const double theta = contact.phi > 0.0 ? std::clamp(-contact.phi / (dt * mean), 0.0, 1.0) : 0.0;
  const double impact = contact.approach + theta * (free_velocity - contact.approach);
  row.target = 0.0;
  if (law.restitution > 0.0 && impact < -model.settings.restitution_threshold) {
    const double rest = (1.0 - theta) * (free_velocity - contact.approach);  // acceleration after the impact
    row.target = std::max(0.0, -law.restitution * impact + rest);
    row.gap_end = std::max(0.0, (1.0 - theta) * dt * (-law.restitution * impact + 0.5 * rest));
    row.is_bounce = true;
  }
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

/// Rows of an island, from the free velocities in work.u. The first time with the impulses of the step before, later
/// with those of the row.
void build_rows(const WorldModel& model, const WorldState& state, Scratch& work, const Island& island, bool is_first) {
  Row* row = work.rows.begin() + island.first_row;
  for (int i = island.first_patch; i < island.end_patch; ++i) {
    const Patch& patch = work.patches[static_cast<std::size_t>(work.patch_order[static_cast<std::size_t>(i)])];
    const BodyWork& a = work.bodies[static_cast<std::size_t>(patch.body_a)];
    const BodyWork& b = work.bodies[static_cast<std::size_t>(patch.body_b)];
    const auto row_index = static_cast<std::size_t>(row - work.rows.begin());
    const bool is_kept = patch.is_kept && a.is_steady && b.is_steady && row->contact == patch.first_contact &&
                         row_index + static_cast<std::size_t>(patch.contact_count) <= work.last_rows;
    Side side_a, side_b;
    if (!is_kept) side_a = side_of(work, a, patch, -1.0), side_b = side_of(work, b, patch, 1.0);
    for (int k = patch.first_contact; k < patch.first_contact + patch.contact_count; ++k, ++row) {
      const Contact& contact = work.contacts[static_cast<std::size_t>(k)];
      if (!is_kept) {
        row->ia = a.active;
        row->ib = b.active;
        row->contact = k;
        std::fill_n(row->bias, 3, 0.0);
        if (a.active >= 0) fill_side(side_a, patch, contact.p_WQ, row->a);
        if (b.active >= 0) fill_side(side_b, patch, contact.p_WQ, row->b);
        if (a.active < 0 && a.is_moving) add_bias(a, patch, contact.p_WQ, -1.0, *row);
        if (b.active < 0 && b.is_moving) add_bias(b, patch, contact.p_WQ, 1.0, *row);
      }
      fill_law(model, patch, contact, relative_velocity(*row, 0, work.u.data()), *row);
      if (!is_kept) finish_row(*row);
      if (!is_first) continue;
      if (!is_kept) {
        const auto& impulse = state.pairs[patch.pair].impulses[static_cast<std::size_t>(contact.point)];
        std::copy(impulse.begin(), impulse.end(), row->lambda);
      }
      row->is_changed = !is_kept;
      cut_to_cone(*row);
    }
  }
}

/// Mean pose of a kinematic carrier over the step, with the element's frame.
ElementQuery carrier_query(const WorldInput& input, const Scratch& work, const ElementUse& use) {
  const BodyWork& carrier = work.bodies[static_cast<std::size_t>(use.carrier.index)];
  Pose X_WC{carrier.R_WB, carrier.p_WB};
  for (const KinematicTarget& target : input.kinematic) {
    if (target.body != use.carrier) continue;
    X_WC.p = 0.5 * (carrier.p_WB + target.X_WB_end.p);
    X_WC.R = carrier.R_WB * exp_rotation(0.5 * log_rotation(carrier.R_WB.transpose() * target.X_WB_end.R));
    break;
  }
  ElementQuery query;
  query.X_WE = X_WC * use.X_CE;
  query.V_WE.angular = carrier.angular_start;
  query.V_WE.linear = carrier.velocity_start + carrier.angular_start.cross(X_WC.R * use.X_CE.p);
  return query;
}

Matrix3 inertia_in_world(const WorldModel::MassProperties& mass, const Matrix3& R_WB) {
  const Matrix3 R_WI = R_WB * mass.R_BI;
  return R_WI * mass.inverse_inertia.cwiseInverse().asDiagonal() * R_WI.transpose();
}

struct BodyForces {
  Matrix3 inertia_W = Matrix3::Identity();  ///< at the middle of the step
  Vector6 wrench = Vector6::Zero();
  Matrix6 stiffness = Matrix6::Zero();
  Matrix6 damping = Matrix6::Zero();
};

/// Elements and gyroscopic torque of one body at the middle of the step, for a guess of the velocity at its end.
BodyForces evaluate_elements(const WorldModel& model, const WorldInput& input, const Scratch& work,
                             const Island& island, int body) {
  const BodyWork& b = work.bodies[static_cast<std::size_t>(body)];
  const double dt = model.settings.dt;
  const Vector3 v_mid = 0.5 * (b.velocity_start + b.velocity);
  const Vector3 w_mid = 0.5 * (b.angular_start + b.angular);
  const Matrix3 R_WB = exp_rotation(0.5 * dt * w_mid) * b.R_WB;
  const Vector3 p_WBcm = b.p_WBcm + 0.5 * dt * v_mid;
  BodyForces forces;
  forces.inertia_W = inertia_in_world(model.masses[static_cast<std::size_t>(body)], R_WB);
  for (int i = island.first_element; i < island.end_element; ++i) {
    const ElementUse& use = input.elements[static_cast<std::size_t>(work.element_order[static_cast<std::size_t>(i)])];
    if (use.body.index != body) continue;
    ElementQuery query = carrier_query(input, work, use);
    const Vector3 p_BoBcm_W = R_WB * model.bodies[static_cast<std::size_t>(body)].inertia.com;
    query.X_WB = {R_WB, p_WBcm - p_BoBcm_W};
    query.V_WB = {v_mid - w_mid.cross(p_BoBcm_W), w_mid};
    query.p_WBcm = p_WBcm;
    const ElementResponse response = use.element->evaluate(query);
    forces.wrench += response.wrench;
    forces.stiffness += response.stiffness;
    forces.damping += response.damping;
  }
  forces.wrench.tail<3>() -= w_mid.cross(forces.inertia_W * w_mid);
  return forces;
}

/// A body with elements in Newton's method: its forces at the middle of the step, linear in the velocity at its end.
struct ElementBody {
  int body = -1;
  BodyForces forces;                   ///< at `velocity`
  Vector6 velocity = Vector6::Zero();  ///< guess of the velocity at the end of the step
};

/// -d wrench / d velocity at the end of the step: the middle moves by dt/4 and half the velocity of the end.
Matrix6 resistance(const BodyForces& forces, double dt) { return 0.25 * dt * forces.stiffness + 0.5 * forces.damping; }

/// Evaluates the forces at the body's present velocity. Returns by how much they miss what the last linearisation
/// predicted there, as a velocity.
double evaluate_body(const WorldModel& model, const WorldInput& input, const Scratch& work, const Island& island,
                     ElementBody& element) {
  const BodyWork& b = work.bodies[static_cast<std::size_t>(element.body)];
  const WorldModel::MassProperties& mass = model.masses[static_cast<std::size_t>(element.body)];
  const double dt = model.settings.dt;
  const BodyForces now = evaluate_elements(model, input, work, island, element.body);
  Vector6 velocity;
  velocity << b.velocity, b.angular;
  const Vector6 predicted = element.forces.wrench - resistance(element.forces, dt) * (velocity - element.velocity);
  const Vector6 miss = dt * (now.wrench - predicted);
  element.forces = now;
  element.velocity = velocity;
  return std::max(miss.head<3>().norm() * mass.inverse_mass,
                  miss.tail<3>().norm() * mass.inverse_inertia.maxCoeff() * mass.radius);
}

/// Sets the body's effective mass and its velocity without contacts (into work.u) from the last evaluation.
void linearize_body(const WorldModel& model, const WorldInput& input, Scratch& work, const ElementBody& element) {
  const BodyWork& b = work.bodies[static_cast<std::size_t>(element.body)];
  const double mass = 1.0 / model.masses[static_cast<std::size_t>(element.body)].inverse_mass;
  const double dt = model.settings.dt;
  Matrix6 M = Matrix6::Zero();
  M.diagonal().head<3>().setConstant(mass);
  M.bottomRightCorner<3, 3>() = element.forces.inertia_W;
  // Its symmetric part is what the contact solver needs; the exact wrench comes by iteration.
  const Matrix6 C = resistance(element.forces, dt);
  Matrix6 effective = M + 0.5 * dt * (C + C.transpose());
  Eigen::LLT<Matrix6> cholesky(effective);
  if (cholesky.info() != Eigen::Success) {  // softening beyond the range of the law: fall back to the plain mass
    cholesky.compute(M);
    effective = M;
  }
  Vector6 start, external;
  start << b.velocity_start, b.angular_start;
  external << mass * model.gravity, Vector3::Zero();
  for (const ExternalWrench& wrench : input.wrenches) {
    if (wrench.body.index == element.body) external += as_vector(wrench.wrench_W);
  }
  const Vector6 momentum = M * start + dt * (external + element.forces.wrench) + (effective - M) * element.velocity;
  const Vector6 free = cholesky.solve(momentum);
  Whitening& whitening = work.whitening[static_cast<std::size_t>(b.active)];
  whitening.is_dense = true;
  const Matrix6 upper = cholesky.matrixU();
  whitening.dense = upper.triangularView<Eigen::Upper>().solve(Matrix6::Identity());
  Eigen::Map<Vector6>(work.u.data() + 6 * b.active) = whiten(whitening, free.head<3>(), free.tail<3>());
}

/// The bodies with elements of an island, each once, at most this many.
constexpr int kMaxElementBodies = 8;

struct ElementBodies {
  int count = 0;
  std::array<ElementBody, kMaxElementBodies> items;
};

void find_element_bodies(const WorldInput& input, const Scratch& work, const Island& island, ElementBodies& found) {
  for (int i = island.first_element; i < island.end_element; ++i) {
    const int body =
        input.elements[static_cast<std::size_t>(work.element_order[static_cast<std::size_t>(i)])].body.index;
    bool is_known = false;
    for (int k = 0; k < found.count; ++k) is_known |= found.items[static_cast<std::size_t>(k)].body == body;
    if (is_known) continue;
    SNUG_CHECK(found.count < kMaxElementBodies, "more bodies with force elements in one island than expected");
    ElementBody& item = found.items[static_cast<std::size_t>(found.count++)];
    item.body = body;
  }
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

void solve_plain_island(const WorldModel& model, const WorldState& state, Scratch& work, const Island& island,
                        StepReport& report) {
  build_rows(model, state, work, island, true);
  const SolveResult result = solve_rows(model.settings, work.rows.begin() + island.first_row,
                                        work.rows.begin() + island.end_row, work.u.data(), work.newton);
  report.sweeps = std::max(report.sweeps, result.iterations);
  report.residual = std::max(report.residual, result.residual);
  if (!result.has_converged) report.status = StepStatus::NotConverged;
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

void solve_element_island(const WorldModel& model, const WorldInput& input, const WorldState& state, Scratch& work,
                          const Island& island, StepReport& report) {
  ElementBodies bodies;
  find_element_bodies(input, work, island, bodies);
  Row* first = work.rows.begin() + island.first_row;
  Row* end = work.rows.begin() + island.end_row;
  SolveResult result;
  double error = 0.0;
  for (int iteration = 0; iteration < kElementIterations; ++iteration) {
    error = 0.0;
    for (int i = 0; i < bodies.count; ++i) {
      error = std::max(error, evaluate_body(model, input, work, island, bodies.items[static_cast<std::size_t>(i)]));
    }
    if (iteration > 0 && error <= model.settings.tolerance) break;
    for (int i = 0; i < bodies.count; ++i) {
      linearize_body(model, input, work, bodies.items[static_cast<std::size_t>(i)]);
    }
    reset_plain_bodies(work, island);
    build_rows(model, state, work, island, iteration == 0);
    if (first != end) result = solve_rows(model.settings, first, end, work.u.data(), work.newton);
    report.sweeps = std::max(report.sweeps, result.iterations);
    for (int i = 0; i < bodies.count; ++i) {
      BodyWork& b = work.bodies[static_cast<std::size_t>(bodies.items[static_cast<std::size_t>(i)].body)];
      unwhiten(work.whitening[static_cast<std::size_t>(b.active)], work.u.data() + 6 * b.active, b.velocity, b.angular);
    }
  }
  report.residual = std::max(report.residual, result.residual);
  if (!result.has_converged) report.status = StepStatus::NotConverged;
  report.element_residual = std::max(report.element_residual, error);
}

/// What the next step starts from.
void keep_impulses(const Row* first, const Row* end, WorldState& state, const Scratch& work) {
  for (const Row* row = first; row != end; ++row) {
    if (!row->is_changed) continue;
    const Contact& contact = work.contacts[static_cast<std::size_t>(row->contact)];
    const Patch& patch = work.patches[static_cast<std::size_t>(contact.patch)];
    state.pairs[patch.pair].impulses[static_cast<std::size_t>(contact.point)] = {row->lambda[0], row->lambda[1],
                                                                                 row->lambda[2]};
  }
}

}  // namespace

void free_motion(const WorldModel& model, const WorldInput& input, Scratch& work) {
  const double dt = model.settings.dt;
  for (std::size_t i = 0; i < work.bodies.size(); ++i) {
    BodyWork& body = work.bodies[i];
    if (body.active >= 0) continue;
    BodyMemory& memory = work.memories[i];
    body.is_steady = body.has_same_pose && !body.is_moving && memory.is_plain && memory.active < 0;
    memory.is_plain = !body.is_moving;
    memory.active = -1;
  }
  for (int i = 0; i < work.active_count; ++i) {
    const int index = work.active[static_cast<std::size_t>(i)];
    BodyWork& body = work.bodies[static_cast<std::size_t>(index)];
    const WorldModel::MassProperties& mass = model.masses[static_cast<std::size_t>(index)];
    body.velocity = body.velocity_start + dt * model.gravity;
    body.angular = body.angular_start;
    // Inertia at the middle of the step: what makes turning under a torque second order.
    const bool turns = dt * dt * body.angular_start.squaredNorm() > 1e-18;
    BodyMemory& memory = work.memories[static_cast<std::size_t>(index)];
    const bool is_plain = !turns && !body.has_element;
    body.is_steady = body.has_same_pose && is_plain && memory.is_plain && memory.active == i;
    memory.is_plain = is_plain;
    memory.active = i;
    if (!body.is_steady) {
      const Matrix3 R_WB_mid = turns ? Matrix3(exp_rotation(0.5 * dt * body.angular_start) * body.R_WB) : body.R_WB;
      work.whitening[static_cast<std::size_t>(i)] = plain_whitening(mass, R_WB_mid);
    }
    if (body.has_element) {  // first guess of Newton's method
      body.velocity = body.velocity_start;
      continue;
    }
    if (dt * body.angular_start.squaredNorm() > 1e-9) {
      // Euler's equations in principal axes by the implicit midpoint rule; keeps energy and angular momentum.
      const Matrix3 R_WI = body.R_WB * mass.R_BI;
      const Vector3 inertia = mass.inverse_inertia.cwiseInverse();
      const Vector3 w0 = R_WI.transpose() * body.angular_start;
      Vector3 w1 = w0;
      for (int k = 0; k < 20; ++k) {
        const Vector3 mid = 0.5 * (w0 + w1);
        const Vector3 next = w0 - dt * mass.inverse_inertia.cwiseProduct(mid.cross(inertia.cwiseProduct(mid)));
        const double change = (next - w1).norm();
        w1 = next;
        if (change <= 1e-14 * (1.0 + w0.norm())) break;
      }
      body.angular = R_WI * (exp_rotation(0.5 * dt * (w0 + w1)) * w1);
    }
  }
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
  for (int i = 0; i < work.active_count; ++i) {
    const BodyWork& body = work.bodies[static_cast<std::size_t>(work.active[static_cast<std::size_t>(i)])];
    Eigen::Map<Vector6>(work.u.data() + 6 * i) =
        whiten(work.whitening[static_cast<std::size_t>(i)], body.velocity, body.angular);
  }
  work.rows.resize(work.contacts.size());
  std::fill_n(work.shift.begin(), 6 * work.active_count, 0.0);
  for (int i = 0; i < work.island_count; ++i) {
    const Island& island = work.islands[static_cast<std::size_t>(i)];
    if (island.end_element > island.first_element) {
      solve_element_island(model, input, state, work, island, report);
    } else {
      solve_plain_island(model, state, work, island, report);
    }
    Row* first = work.rows.begin() + island.first_row;
    Row* end = work.rows.begin() + island.end_row;
    keep_impulses(first, end, state, work);
    correct_positions(model.settings, first, end, work.contacts.begin(), work.u.data(), work.shift.data());
    read_velocities(work, island);
  }
}

}  // namespace snug::physics::internal
