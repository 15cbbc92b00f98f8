// Element bodies: bodies under implicit force elements, taken at the middle of the step. docs/theory/contact.md,
// section 7.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "snug/physics/internal/scratch.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::physics::internal {
namespace {

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
  query.V_WE.angular = 0.5 * (carrier.angular_start + carrier.angular);
  query.V_WE.linear = 0.5 * (carrier.velocity_start + carrier.velocity) + query.V_WE.angular.cross(X_WC.R * use.X_CE.p);
  return query;
}

Matrix3 inertia_in_world(const WorldModel::MassProperties& mass, const Matrix3& R_WB) {
  const Matrix3 R_WI = R_WB * mass.R_BI;
  return R_WI * mass.inverse_inertia.cwiseInverse().asDiagonal() * R_WI.transpose();
}

/// Elements and gyroscopic torque of one body at the middle of the step, for a guess of the velocity at its end.
BodyForces evaluate_elements(const WorldModel& model, const WorldInput& input, const Scratch& work, int body) {
  const BodyWork& b = work.bodies[static_cast<std::size_t>(body)];
  const double dt = model.settings.dt;
  const Vector3 v_mid = 0.5 * (b.velocity_start + b.velocity);
  const Vector3 w_mid = 0.5 * (b.angular_start + b.angular);
  const Matrix3 R_WB = exp_rotation(0.5 * dt * w_mid) * b.R_WB;
  const Vector3 p_WBcm = b.p_WBcm + 0.5 * dt * v_mid;
  BodyForces forces;
  forces.inertia_W = inertia_in_world(model.masses[static_cast<std::size_t>(body)], R_WB);
  for (std::size_t i = 0; i < input.elements.size(); ++i) {
    const ElementUse& use = input.elements[i];
    if (use.body.index != body) continue;
    ElementQuery query = work.carriers[i];
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

/// -d wrench / d velocity at the end of the step: the middle moves by dt/4 and half the velocity of the end.
Matrix6 resistance(const BodyForces& forces, double dt) { return 0.25 * dt * forces.stiffness + 0.5 * forces.damping; }

}  // namespace

void place_carriers(const WorldInput& input, Scratch& work) {
  work.carriers.clear();
  for (const ElementUse& use : input.elements) work.carriers.push_back(carrier_query(input, work, use));
}

double evaluate_body(const WorldModel& model, const WorldInput& input, const Scratch& work, ElementBody& element) {
  const BodyWork& b = work.bodies[static_cast<std::size_t>(element.body)];
  const WorldModel::MassProperties& mass = model.masses[static_cast<std::size_t>(element.body)];
  const double dt = model.settings.dt;
  const BodyForces now = evaluate_elements(model, input, work, element.body);
  Vector6 velocity;
  velocity << b.velocity, b.angular;
  const Vector6 predicted = element.forces.wrench - resistance(element.forces, dt) * (velocity - element.velocity);
  const Vector6 miss = dt * (now.wrench - predicted);
  element.forces = now;
  element.velocity = velocity;
  return std::max(miss.head<3>().norm() * mass.inverse_mass,
                  miss.tail<3>().norm() * mass.inverse_inertia.maxCoeff() * mass.radius);
}

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
  Matrix6& dense = work.dense_whitening[static_cast<std::size_t>(b.active)];
  dense = upper_inverse(cholesky.matrixU());
  whitening.dense = &dense;
  Eigen::Map<Vector6>(work.u.data() + 6 * b.active) = whiten(whitening, free.head<3>(), free.tail<3>());
}

void find_element_bodies(const WorldInput& input, const Scratch& work, int island, std::vector<ElementBody>& found) {
  found.clear();
  for (const ElementUse& use : input.elements) {
    const BodyWork& body = work.bodies[static_cast<std::size_t>(use.body.index)];
    if (body.active < 0 || body.island != island) continue;
    const bool is_known =
        std::any_of(found.begin(), found.end(), [&](const ElementBody& known) { return known.body == use.body.index; });
    if (is_known) continue;
    found.emplace_back().body = use.body.index;
  }
}

}  // namespace snug::physics::internal
