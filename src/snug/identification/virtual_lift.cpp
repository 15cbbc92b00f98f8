// Virtual lift: a box on a cup under a gripper that moves, in the physics of everything else.
#include "snug/identification/virtual_lift.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "snug/core/check.hpp"
#include "snug/cup/suction_cup.hpp"
#include "snug/identification/internal/at_rest.hpp"
#include "snug/physics/world.hpp"

namespace snug::identification {
namespace {

using internal::normal3;

constexpr physics::BodyId kGripper{0}, kLoad{1};
constexpr double kStep = 0.001;  // s

/// From 0 to 1 between two times, with rest at both ends.
double smooth(double t, double begin, double end) {
  const double s = std::clamp((t - begin) / (end - begin), 0.0, 1.0);
  return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
}

Pose gripper_at(double t) {
  const Matrix3 down = Vector3(1.0, -1.0, -1.0).asDiagonal();
  const double aside = smooth(t, 0.4, 1.4);
  return {exp_rotation(Vector3(0.0, 0.25 * aside, 0.0)) * down, Vector3(0.3 * aside, 0.0, 0.25 * smooth(t, 0.0, 0.8))};
}

physics::WorldModel make_world(const Lift& lift, const Pose& X_ES) {
  physics::WorldModel model;
  physics::BodyModel gripper, load;
  gripper.name = "gripper";
  gripper.kind = physics::BodyKind::Kinematic;
  gripper.X_WB = gripper_at(0.0);
  load.name = "load";
  load.inertia = lift.load_S;
  load.X_WB = gripper.X_WB * X_ES;
  load.geoms.push_back({geometry::Box{Vector3(0.1, 0.1, 0.05)}, Pose{Matrix3::Identity(), lift.load_S.com}, 0, true});
  model.bodies = {gripper, load};
  model.laws.resize(1);
  model.settings.dt = kStep;
  model.finalize();
  return model;
}

PayloadSample sample_of(const physics::WorldModel& model, const physics::WorldState& state,
                        const cup::SuctionCup& cup) {
  physics::ElementQuery query;
  query.X_WE = physics::pose_of(model, state, kGripper);
  query.V_WE = physics::twist_of(model, state, kGripper);
  query.X_WB = physics::pose_of(model, state, kLoad);
  query.V_WB = physics::twist_of(model, state, kLoad);
  query.p_WBcm = state.bodies[1].p_WBcm;
  const Wrench F_S = cup.lip_wrench(query);
  const Pose X_ES = query.X_WE.inverse() * query.X_WB;  // the load's frame is the lip
  const Vector3 force = X_ES.R * F_S.force;
  PayloadSample sample;
  sample.time = state.time(model);
  sample.X_WE = query.X_WE;
  sample.wrench_E << force, X_ES.R * F_S.torque + X_ES.p.cross(force);
  return sample;
}

}  // namespace

std::vector<PayloadSample> make_lift(const Lift& lift) {
  const cup::SettleResult rest = internal::hang(lift.load_S, gripper_at(0.0).R, lift.K, lift.frames);
  const physics::WorldModel model = make_world(lift, rest.X_ES);
  physics::WorldState state = physics::make_state(model);
  physics::Workspace work(model);
  const cup::SuctionCup cup(lift.K, lift.D, lift.frames.X_ES2, Pose{}, lift.frames.X_SS1);
  const std::array<physics::ElementUse, 1> elements{{{&cup, kGripper, Pose{}, kLoad}}};
  const int steps = static_cast<int>(std::lround(lift.duration / kStep));
  const int each = std::max(1, static_cast<int>(std::lround(1.0 / (lift.rate * kStep))));
  std::vector<PayloadSample> samples{sample_of(model, state, cup)};
  for (int i = 1; i <= steps; ++i) {
    const std::array<physics::KinematicTarget, 1> target{{{kGripper, gripper_at(i * kStep)}}};
    physics::WorldInput input;
    input.kinematic = target;
    input.elements = elements;
    const physics::StepReport report = physics::step(model, input, state, work);
    SNUG_CHECK(report.status == physics::StepStatus::Converged, "a box that hangs freely can be simulated");
    if (i % each == 0) samples.push_back(sample_of(model, state, cup));
  }
  return samples;
}

void add_noise(std::vector<PayloadSample>& samples, const MeasurementNoise& noise, double force_bias,
               double torque_bias, Rng& rng) {
  Vector6 bias;
  bias << normal3(rng, force_bias), normal3(rng, torque_bias);
  for (PayloadSample& sample : samples) {
    sample.wrench_E += bias;
    sample.wrench_E.head<3>() += normal3(rng, noise.force);
    sample.wrench_E.tail<3>() += normal3(rng, noise.torque);
  }
}

}  // namespace snug::identification
