// Energy: no step of a rigid scene may add any.
#include <gtest/gtest.h>

#include <cmath>

#include "scene.hpp"
#include "snug/core/rng.hpp"

namespace snug::physics::test {
namespace {

/// What one step may add to the energy beside rounding: derived in `allowance` below.
struct Allowance {
  double correction = 0.0;  ///< J, exactly what moved positions without velocities
  double turning = 0.0;     ///< J, of impulses on turning bodies
  double arms = 0.0;        ///< J, of contact points on turning bodies
  double reversal = 0.0;    ///< J, of contacts whose motion turns round
  double solver = 0.0;      ///< J, of the residual
  [[nodiscard]] double sum() const { return correction + turning + arms + reversal + solver; }
};

/// Correction: positions move by dt/2 (v_A + v_E) and by what mends overlaps; the latter is read off and its work
/// against gravity taken as it is. Turning: the inertia is that of the middle of the step with the velocity of its
/// start; a change of the turning dw turns the body by dt/2 dw more than the inertia knows, which for the energy is w .
/// (I_E - I_mid) w / 2 <= (I_max - I_min) |w|^2 (dt/2 |dw|). Arms: an impulse P does the work P . (xi_A + xi_E) / 2,
/// both with the arms at A. A contact that held in the step before had xi = 0 with the arms and the normal of then.
/// Since then arms turned by w dt, which makes w x (w x r) dt; and where bodies slide with v_AB, the normal of a
/// turning body and the place of the point on it moved: w v_AB dt each. Reversal: at E impulses do no work or oppose
/// sliding. A motion that gravity turns round within the step (opening, or sliding the other way) they drove before, at
/// a speed below g dt. Solver: a point may miss its law by the tolerance, times the impulses.
Allowance allowance(const WorldModel& model, const WorldState& before, const WorldState& after,
                    std::span<const ContactReport> contacts) {
  Allowance allowed;
  const double dt = model.settings.dt;
  for (std::size_t i = 0; i < before.bodies.size(); ++i) {
    if (model.bodies[i].kind != BodyKind::Dynamic) continue;
    const BodyState &a = before.bodies[i], &b = after.bodies[i];
    const Vector3 slide = b.p_WBcm - a.p_WBcm - 0.5 * dt * (a.velocity + b.velocity);
    allowed.correction -= model.bodies[i].inertia.mass * model.gravity.dot(slide);
    const Vector3 inertia = model.masses[i].inverse_inertia.cwiseInverse();
    // The correction turns bodies too, by an angle that is what is left of the pose.
    const Matrix3 R_mean =
        exp_rotation(0.5 * dt * (a.angular_velocity + b.angular_velocity)) * a.quat_WB.toRotationMatrix();
    const double corrected = angle_between(b.quat_WB.toRotationMatrix(), R_mean);
    const double angle = 0.5 * dt * (b.angular_velocity - a.angular_velocity).norm() + corrected;
    const double square = std::max(a.angular_velocity.squaredNorm(), b.angular_velocity.squaredNorm());
    allowed.turning += (inertia.maxCoeff() - inertia.minCoeff()) * square * angle;
  }
  for (const ContactReport& contact : contacts) {
    const double impulse = contact.force_W.norm() * dt;
    allowed.solver += impulse * model.settings.tolerance;
    Vector3 v_AB = Vector3::Zero();
    double arms = 0.0, turning = 0.0;
    for (const BodyId id : {contact.a, contact.b}) {
      const BodyState& body = before.bodies[static_cast<std::size_t>(id.index)];
      const Vector3 arm = contact.p_WQ - body.p_WBcm, w = body.angular_velocity;
      v_AB += (id == contact.b ? 1.0 : -1.0) * (body.velocity + w.cross(arm));
      arms += w.squaredNorm() * arm.norm();
      turning += w.norm();
    }
    allowed.arms += 0.5 * impulse * dt * (arms + 2.0 * turning * v_AB.norm());
    allowed.reversal += 0.5 * std::clamp(dt * contact.force_W.dot(v_AB), 0.0, impulse * model.gravity.norm() * dt);
  }
  return allowed;
}

/// Cubes and boxes thrown about in a container, with any restitution and friction.
WorldModel thrown_boxes(unsigned seed, double restitution, double friction) {
  Rng rng = Rng(seed).split("thrown");
  std::vector<BodyModel> boxes;
  for (int i = 0; i < 5; ++i) {
    const Vector3 size(rng.uniform(0.06, 0.16), rng.uniform(0.06, 0.16), rng.uniform(0.06, 0.16));
    boxes.push_back(
        box(size, rng.uniform(0.1, 1.0), {rng.uniform(-0.15, 0.15), rng.uniform(-0.06, 0.06), 0.15 + 0.22 * i}));
    boxes.back().X_WB.R = exp_rotation(Vector3(rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0)));
  }
  WorldModel model = in_container(boxes);
  model.laws.assign(4, {friction, restitution, 0.0, 0.0});
  return model;
}

double total_energy(const WorldModel& model, const WorldState& state) {
  return kinetic_energy(model, state) + potential_energy(model, state);
}

struct Gains {
  double step = -1.0;   ///< J, largest of a step beyond what is allowed
  double total = -1.0;  ///< J, largest since the start, less what corrections lifted
};

Gains worst_gains(unsigned seed, double restitution, double friction, int steps) {
  const WorldModel model = thrown_boxes(seed, restitution, friction);
  Simulation run(model);
  Gains worst;
  double corrections = 0.0;
  const double start = total_energy(model, run.state);
  for (double before = start; steps > 0; --steps) {
    const WorldState last = run.state;
    EXPECT_EQ(run.step().status, StepStatus::Converged) << steps;
    const double now = total_energy(model, run.state);
    const Allowance allowed = allowance(model, last, run.state, run.work.contacts());
    corrections += allowed.correction;
    worst.step = std::max(worst.step, now - before - allowed.sum());
    worst.total = std::max(worst.total, now - start - corrections);
    before = now;
  }
  return worst;
}

TEST(Energy, DoesNotGrowInAnyStepWithoutRestitution) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    // Energies of about 20 J: some roundings of 4e-15 J.
    EXPECT_LE(worst_gains(seed, 0.0, 0.1 * (seed % 8), 800).step, 1e-13);
  }
}

TEST(Energy, NeverExceedsThatOfTheStartWithRestitution) {
  // Newton's law at several contacts at once, some of which bounce, some rest, does not bound single steps.
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    EXPECT_LE(worst_gains(seed, 0.045 * seed, 0.1 * (seed % 8), 800).total, 1e-13);  // e up to 0.9; as above
  }
}

// What contacts pushed in a blow is not what they go on to push: taken for a motion that lasts, it once turned light
// capsules a million times as fast. And the friction of a face a hair wide was no number.
TEST(Energy, DoesNotGrowWhereLightBodiesAreStruck) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng = Rng(seed).split("struck");
    std::vector<BodyModel> bodies;
    for (int i = 0; i < 12; ++i) {  // every third one heavy
      const Vector3 size(rng.uniform(0.08, 0.2), rng.uniform(0.02, 0.06), rng.uniform(0.02, 0.05));
      const double mass = i % 3 == 2 ? rng.uniform(5.0, 15.0) : rng.uniform(0.01, 0.03);
      bodies.push_back(box(size, mass, {rng.uniform(-0.1, 0.1), rng.uniform(-0.05, 0.05), 0.12 + 0.1 * i}));
      bodies.back().X_WB.R = exp_rotation(Vector3(rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2)));
      if (i % 3 == 2) continue;
      const double radius = rng.uniform(0.015, 0.03), half = rng.uniform(0.02, 0.06);
      bodies.back().geoms[0].shape = geometry::Capsule{half, radius};
      if (i % 3 == 1) bodies.back().geoms[0].shape = geometry::Cylinder{half, radius};
      const double across = mass * (half * half / 3.0 + radius * radius / 4.0);
      bodies.back().inertia.inertia = Vector3(across, across, 0.5 * mass * radius * radius).asDiagonal();
    }
    WorldModel model = in_container(bodies);
    model.laws.assign(4, {0.4, 0.1, 0.0, 0.0});
    for (ContactLaw& law : model.laws) law.bearing = Bearing{static_cast<int>(seed % 3)};
    model.settings.dt = seed % 2 == 0 ? 5e-3 : 1e-3;
    Simulation run(model);
    for (std::size_t i = 5; i < model.bodies.size(); ++i) {
      run.state.bodies[i].velocity = Vector3(rng.uniform(-2, 2), rng.uniform(-2, 2), -3.0);
      run.state.bodies[i].angular_velocity = 20.0 * Vector3(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    }
    const double start = total_energy(model, run.state);
    for (double t = 0.0; t < 1.5; t += model.settings.dt) {
      (void)run.step();
      // Steps in which bodies turn by a tenth of a radian add what `allowance` names.
      ASSERT_LE(total_energy(model, run.state), 1.01 * start) << t;
    }
  }
}

/// Kinetic energy after over before a collision in the air without friction, worst of many.
TEST(Energy, IsKeptByElasticCollisionsWithoutFriction) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng = Rng(seed).split("elastic");
    WorldModel model = world({0.0, 1.0, 0.0, 0.0}, {});
    for (const double side : {-1.0, 1.0}) {  // cubes: their inertia does not depend on how they are turned
      model.bodies.push_back(box(Vector3::Constant(0.1), rng.uniform(0.2, 2.0), {0.1 * side, 0.02 * side, 0.0}));
      const auto angle = [&rng] { return rng.uniform(-2.0, 2.0); };
      const Vector3 turn(angle(), angle(), angle());
      model.bodies.back().X_WB.R = exp_rotation(turn);
    }
    model.gravity.setZero();
    model.finalize();
    Simulation run(model);
    set_twist(model, run.state, BodyId{0}, Twist{Vector3(1.5, 0.0, 0.0), Vector3(1.0, 2.0, -1.0)});
    const double before = kinetic_energy(model, run.state);
    double impulses = 0.0;
    for (int i = 0; i < 300; ++i) {
      (void)run.step();
      for (const ContactReport& contact : run.work.contacts()) impulses += 1e-3 * contact.force_W.norm();
    }
    EXPECT_GT(impulses, 0.1);
    // xi_E + xi_A = 0 to the tolerance: no work. The cubes' inertia is a multiple of one to rounding.
    EXPECT_NEAR(kinetic_energy(model, run.state), before, impulses * model.settings.tolerance + 1e-12);
  }
}

}  // namespace
}  // namespace snug::physics::test
