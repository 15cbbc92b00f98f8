// Second opinion: the contact problem of one step rebuilt from what the world reports, without the solver's code.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "scene.hpp"

namespace snug::physics::test {

/// One step seen from outside: the state before it and what step() reported about its contacts.
/// For rigid pairs without restitution, on bodies that are dynamic or stand still. docs/theory/contact.md, 2 and 3.
class StepProblem {
 public:
  StepProblem(const WorldModel& model, const WorldState& before, std::span<const ContactReport> contacts,
              const WorldInput& input = {})
      : model_(model), dt_(model.settings.dt) {
    for (std::size_t i = 0; i < model.bodies.size(); ++i) add_body(model.bodies[i], before.bodies[i]);
    for (const ExternalWrench& wrench : input.wrenches) {
      Body& body = at(wrench.body);
      body.v_free += dt_ * body.inverse_mass * wrench.wrench_W.force;
      body.w_free += dt_ * body.inverse_inertia * wrench.wrench_W.torque;
    }
    for (const ContactReport& contact : contacts) add_contact(contact);
    find_located();
  }

  /// A body that touches fixed things alone, and rocks on one point, or bears on it and strikes with another: it is
  /// solved with the arms of its path or in order of time (decisions 0133, 0140), which is not the problem with the
  /// arms of the start. Its contacts are left out.
  [[nodiscard]] bool is_located(std::size_t body) const { return bodies_[body].is_located; }

  struct Motion {
    Vector3 v = Vector3::Zero(), w = Vector3::Zero();
  };

  /// What the reported forces make of the free motion: Newton's and Euler's equations.
  [[nodiscard]] std::vector<Motion> motion_from(const std::vector<Vector3>& impulses) const {
    std::vector<Motion> motion;
    for (const Body& body : bodies_) motion.push_back({body.v_free, body.w_free});
    for (std::size_t i = 0; i < contacts_.size(); ++i) push(contacts_[i], impulses[i], motion);
    return motion;
  }

  [[nodiscard]] std::vector<Vector3> reported_impulses() const {
    std::vector<Vector3> impulses;
    for (const Contact& contact : contacts_) impulses.push_back(dt_ * contact.report.force_W);
    return impulses;
  }

  /// Worst violation of Signorini's and Coulomb's laws, m/s: natural map, as a point and its impulse see it.
  [[nodiscard]] double violation(const std::vector<Vector3>& impulses, const std::vector<Motion>& motion) const {
    double worst = 0.0;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const Contact& c = contacts_[i];
      if (at(c.report.a).is_located || at(c.report.b).is_located) continue;
      const Vector3& n = c.report.n_AB_W;
      const Vector3 xi = relative_velocity(c, motion);
      const double lambda_n = n.dot(impulses[i]), xi_n = n.dot(xi);
      const Vector3 lambda_t = impulses[i] - lambda_n * n, xi_t = xi - xi_n * n;
      const double normal = c.w_nn * std::abs(lambda_n - std::max(0.0, lambda_n - (xi_n - c.target) / c.w_nn));
      const Vector3 pushed = lambda_t - xi_t / c.w_tt;
      const double limit = c.friction * lambda_n;
      const Vector3 on_disc = pushed.norm() > limit ? Vector3(pushed * (limit / pushed.norm())) : pushed;
      worst = std::max({worst, normal, c.w_tt * (lambda_t - on_disc).norm()});
    }
    return worst;
  }

  /// Plain block Gauss-Seidel from zero; returns the violation that is left after so many sweeps.
  [[nodiscard]] double violation_after_sweeps(int sweeps) const {
    std::vector<Vector3> impulses(contacts_.size(), Vector3::Zero());
    std::vector<Motion> motion = motion_from(impulses);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      for (std::size_t i = 0; i < contacts_.size(); ++i) {
        for (int k = 0; k < 8; ++k) relax(contacts_[i], impulses[i], motion);
      }
    }
    return violation(impulses, motion);
  }

 private:
  struct Body {
    double inverse_mass = 0.0;
    Matrix3 inverse_inertia = Matrix3::Zero();  ///< W, at the middle of the step
    Vector3 p_WBcm, v_start = Vector3::Zero(), w_start = Vector3::Zero(), v_free = Vector3::Zero(),
                    w_free = Vector3::Zero();
    bool is_located = false;
  };
  struct Contact {
    ContactReport report;
    double friction = 0.0, target = 0.0, w_nn = 0.0, w_tt = 0.0;
    double approach = 0.0;  ///< m/s, at the start
  };

  Body& at(BodyId id) { return bodies_[static_cast<std::size_t>(id.index)]; }
  [[nodiscard]] const Body& at(BodyId id) const { return bodies_[static_cast<std::size_t>(id.index)]; }

  void add_body(const BodyModel& model, const BodyState& state) {
    Body body;
    body.p_WBcm = state.p_WBcm;
    if (model.kind == BodyKind::Dynamic && state.is_present) {
      const Matrix3 R_WB = state.quat_WB.toRotationMatrix();
      const Matrix3 inertia = model.inertia.inertia;
      const Matrix3 R_mid = exp_rotation(0.5 * dt_ * state.angular_velocity) * R_WB;
      body.inverse_mass = 1.0 / model.inertia.mass;
      body.inverse_inertia = R_mid * inertia.inverse() * R_mid.transpose();
      body.v_start = state.velocity;
      body.w_start = state.angular_velocity;
      body.v_free = state.velocity + dt_ * model_.gravity;
      body.w_free = free_turning(inertia, R_WB, state.angular_velocity);
    }
    bodies_.push_back(body);
  }

  /// Euler's equations in body axes by the implicit midpoint rule, back to W with the mean turn.
  [[nodiscard]] Vector3 free_turning(const Matrix3& inertia, const Matrix3& R_WB, const Vector3& w_W) const {
    const Vector3 w0 = R_WB.transpose() * w_W;
    Vector3 w1 = w0;
    for (int i = 0; i < 30; ++i) {
      const Vector3 mid = 0.5 * (w0 + w1);
      w1 = w0 - dt_ * inertia.inverse() * mid.cross(inertia * mid);
    }
    return R_WB * exp_rotation(0.5 * dt_ * (w0 + w1)) * w1;
  }

  void add_contact(const ContactReport& report) {
    Contact c{report, 0.0, 0.0, 0.0, 0.0, 0.0};
    const auto material = [this](BodyId id) {
      return model_.bodies[static_cast<std::size_t>(id.index)].geoms[0].material;
    };
    c.friction = model_.law(material(report.a), material(report.b)).friction;
    Matrix3 W = Matrix3::Zero();  // velocity of the point on B relative to A, by an impulse on B
    for (const BodyId id : {report.a, report.b}) {
      const Body& body = at(id);
      const Matrix3 arm = skew(report.p_WQ - body.p_WBcm);
      W += body.inverse_mass * Matrix3::Identity() - arm * body.inverse_inertia * arm;
    }
    const Vector3& n = report.n_AB_W;
    const Vector3 t1 = n.unitOrthogonal(), t2 = n.cross(t1);
    c.w_nn = n.dot(W * n);
    const double w11 = t1.dot(W * t1), w22 = t2.dot(W * t2), w12 = t1.dot(W * t2);
    c.w_tt = 0.5 * (w11 + w22) + std::hypot(0.5 * (w11 - w22), w12);
    std::vector<Motion> start, free;
    for (const Body& body : bodies_) {
      start.push_back({body.v_start, body.w_start});
      free.push_back({body.v_free, body.w_free});
    }
    const double xi_start = n.dot(relative_velocity(c, start)), xi_free = n.dot(relative_velocity(c, free));
    c.approach = xi_start;
    const bool closes = report.phi + 0.5 * dt_ * (xi_start + xi_free) <= 0.0;
    c.target = closes ? 0.0 : std::min(0.0, -2.0 * report.phi / dt_ - xi_start);
    contacts_.push_back(c);
  }

  void find_located() {
    const double fall = dt_ * model_.gravity.norm();
    std::vector<bool> meets(bodies_.size()), bears(bodies_.size()), strikes(bodies_.size()), rocks(bodies_.size());
    for (const Contact& c : contacts_) {
      const bool are_both = at(c.report.a).inverse_mass > 0.0 && at(c.report.b).inverse_mass > 0.0;
      for (const BodyId id : {c.report.a, c.report.b}) {
        const auto i = static_cast<std::size_t>(id.index);
        if (are_both) meets[i] = true;
        if (std::abs(c.approach) <= 2.0 * fall && c.report.phi <= dt_ * fall) bears[i] = true;
        if (c.approach < -2.0 * fall) strikes[i] = true;
        const bool lasts = std::abs(c.approach) <= model_.settings.restitution_threshold;
        if (lasts && c.report.n_AB_W.cross(bodies_[i].w_start).norm() > 0.01) rocks[i] = true;
      }
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      bodies_[i].is_located = bodies_[i].inverse_mass > 0.0 && !meets[i] && ((bears[i] && strikes[i]) || rocks[i]);
  }

  [[nodiscard]] Vector3 relative_velocity(const Contact& c, const std::vector<Motion>& motion) const {
    const auto velocity = [&](BodyId id) -> Vector3 {
      const Motion& m = motion[static_cast<std::size_t>(id.index)];
      return m.v + m.w.cross(c.report.p_WQ - at(id).p_WBcm);
    };
    return velocity(c.report.b) - velocity(c.report.a);
  }

  void push(const Contact& c, const Vector3& impulse_on_b, std::vector<Motion>& motion) const {
    for (const BodyId id : {c.report.a, c.report.b}) {
      const Vector3 impulse = id == c.report.b ? impulse_on_b : Vector3(-impulse_on_b);
      Motion& m = motion[static_cast<std::size_t>(id.index)];
      m.v += at(id).inverse_mass * impulse;
      m.w += at(id).inverse_inertia * (c.report.p_WQ - at(id).p_WBcm).cross(impulse);
    }
  }

  void relax(const Contact& c, Vector3& impulse, std::vector<Motion>& motion) const {
    const Vector3& n = c.report.n_AB_W;
    Vector3 xi = relative_velocity(c, motion);
    const double lambda_n = std::max(0.0, n.dot(impulse) - (n.dot(xi) - c.target) / c.w_nn);
    Vector3 change = (lambda_n - n.dot(impulse)) * n;
    push(c, change, motion);
    impulse += change;
    xi = relative_velocity(c, motion);
    const Vector3 old_t = impulse - n.dot(impulse) * n;
    Vector3 new_t = old_t - (xi - n.dot(xi) * n) / c.w_tt;
    const double limit = c.friction * lambda_n;
    if (new_t.norm() > limit) new_t *= limit / new_t.norm();
    change = new_t - old_t;
    push(c, change, motion);
    impulse += change;
  }

  const WorldModel& model_;
  double dt_;
  std::vector<Body> bodies_;
  std::vector<Contact> contacts_;
};

}  // namespace snug::physics::test
