// Tests of the held cup in the physics step: decay after a release, energy, and rest where statics says.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "snug/cup/statics.hpp"
#include "snug/cup/suction_cup.hpp"
#include "snug/cup/test/vectors.hpp"
#include "snug/physics/world.hpp"

namespace snug::cup {
namespace {

constexpr physics::BodyId kGripper{0}, kLoad{1};

/// One load on a cup in a world with nothing to touch; the load's frame is the lip S.
struct SwingScene {
  physics::WorldModel model;
  physics::WorldState state;
  SuctionCup cup;
  Pose X_WE;

  [[nodiscard]] Pose X_ES() const { return X_WE.inverse() * physics::pose_of(model, state, kLoad); }
  [[nodiscard]] double energy() const {
    physics::ElementQuery query;
    query.X_WE = X_WE;
    query.X_WB = physics::pose_of(model, state, kLoad);
    query.p_WBcm = state.bodies[1].p_WBcm;
    return physics::kinetic_energy(model, state) + physics::potential_energy(model, state) + cup.evaluate(query).energy;
  }
};

struct SwingSetup {
  Matrix6 K, D;  // in S1
  Pose X_ES2, X_SS1;
  Pose X_WE, X_ES;  // at the start
  SpatialInertia inertia;
};

SwingScene make_swing(const SwingSetup& setup, double dt) {
  SwingScene swing;
  swing.X_WE = setup.X_WE;
  swing.cup = SuctionCup(setup.K, setup.D, setup.X_ES2, Pose{}, setup.X_SS1);
  physics::BodyModel gripper, load;
  gripper.name = "gripper";
  gripper.kind = physics::BodyKind::Kinematic;
  gripper.X_WB = setup.X_WE;
  load.name = "load";
  load.inertia = setup.inertia;
  load.X_WB = setup.X_WE * setup.X_ES;
  load.geoms.push_back({geometry::Box{Vector3(0.1, 0.1, 0.05)}, Pose{Matrix3::Identity(), setup.inertia.com}, 0, true});
  swing.model.bodies = {gripper, load};
  swing.model.laws.resize(1);
  swing.model.settings.dt = dt;
  swing.model.finalize();
  swing.state = physics::make_state(swing.model);
  return swing;
}

void run(SwingScene& swing, physics::Workspace& work, int steps) {
  const std::array<physics::ElementUse, 1> elements{{{&swing.cup, kGripper, Pose{}, kLoad}}};
  physics::WorldInput input;
  input.elements = elements;
  for (int i = 0; i < steps; ++i) {
    const physics::StepReport report = physics::step(swing.model, input, swing.state, work);
    ASSERT_EQ(report.status, physics::StepStatus::Converged);
    ASSERT_EQ(report.contacts, 0);
    ASSERT_LE(report.element_residual, swing.model.settings.tolerance);
  }
}

SwingSetup setup_of(const nlohmann::json& c) {
  SwingSetup setup;
  setup.K = test::matrix6(c.at("K"));
  setup.D = test::matrix6(c.at("D_at_S1"));
  setup.X_ES2.p = test::vector3(c.at("E_H_S2_o"));
  setup.X_SS1.p = test::vector3(c.at("S_H_S1_o"));
  setup.X_WE.R = test::matrix3(c.at("W_R_E"));
  setup.X_ES = {test::quaternion(c.at("E_q_S").at(0)).toRotationMatrix(), test::vector3(c.at("E_o_S").at(0))};
  setup.inertia = {c.at("mass").get<double>(), test::vector3(c.at("com_S")), test::matrix3(c.at("Ic_S_axes"))};
  return setup;
}

struct Deviation {
  double position = 0.0;  // m
  double turn = 0.0;      // rad
};

/// Largest distance from the reference trajectory, with this many steps for each of its samples.
Deviation deviation_from(const nlohmann::json& c, int steps_per_sample) {
  SwingScene swing = make_swing(setup_of(c), c.at("dt").get<double>() / steps_per_sample);
  // The step's own 1e-7 m/s would add up to more than what is measured here: 15000 steps of 0.1 ms.
  swing.model.settings.tolerance = 1e-11;
  physics::Workspace work(swing.model);
  Deviation worst;
  for (std::size_t k = 1; k < c.at("E_o_S").size(); ++k) {
    run(swing, work, steps_per_sample);
    if (testing::Test::HasFatalFailure()) return {1.0, 1.0};
    const Pose X_ES = swing.X_ES();
    const Matrix3 R_ES = test::quaternion(c.at("E_q_S").at(k)).toRotationMatrix();
    worst.position = std::max(worst.position, (X_ES.p - test::vector3(c.at("E_o_S").at(k))).norm());
    worst.turn = std::max(worst.turn, angle_between(X_ES.R, R_ES));
  }
  return worst;
}

nlohmann::json decay_vectors() { return test::load_vectors("decay.json"); }

TEST(CupDecay, DampingGivenAtTheCentreIsTheReferencesDampingAtTheLip) {
  const nlohmann::json vectors = decay_vectors();
  if (vectors.is_null()) GTEST_SKIP() << "reference data not found: " << test::vectors_path("decay.json");
  for (const nlohmann::json& c : vectors.at("cases")) {
    const SwingSetup setup = setup_of(c);
    const Matrix6 X = wrench_transform(setup.X_SS1);
    EXPECT_LE((X * setup.D * X.transpose() - test::matrix6(c.at("D_S"))).norm(), 1e-14);
  }
}

TEST(CupDecay, FollowsTheReferenceTrajectories) {
  const nlohmann::json vectors = decay_vectors();
  if (vectors.is_null()) GTEST_SKIP() << "reference data not found: " << test::vectors_path("decay.json");
  ASSERT_EQ(vectors.at("cases").size(), 5u);
  test::Worst position("position_m"), turn("turn_rad");
  for (const nlohmann::json& c : vectors.at("cases")) {
    SCOPED_TRACE(c.at("id").dump());
    const Deviation coarse = deviation_from(c, 14), fine = deviation_from(c, 28);
    // The vectors' own tolerances.
    EXPECT_LE(position.add(fine.position), 1e-6);
    EXPECT_LE(turn.add(fine.turn), 1e-5);
    // Second order: a quarter of the error for half the step; 3.5 leaves room for what is not yet asymptotic.
    EXPECT_LE(fine.position, coarse.position / 3.5);
    EXPECT_LE(fine.turn, coarse.turn / 3.5);
  }
}

TEST(CupDecay, NeverGainsEnergyAtAnyStepUpTo20Milliseconds) {
  const nlohmann::json vectors = decay_vectors();
  if (vectors.is_null()) GTEST_SKIP() << "reference data not found: " << test::vectors_path("decay.json");
  test::Worst gain("gain_J");
  for (const double dt : {0.001, 0.004, 0.008, 0.012, 0.020}) {
    for (const nlohmann::json& c : vectors.at("cases")) {
      SCOPED_TRACE(std::to_string(dt) + " s, case " + c.at("id").dump());
      SwingScene swing = make_swing(setup_of(c), dt);
      physics::Workspace work(swing.model);
      const double start = swing.energy();
      double before = start, largest_gain = 0.0;
      for (int i = 0; i < static_cast<int>(3.0 / dt); ++i) {
        ASSERT_NO_FATAL_FAILURE(run(swing, work, 1));
        const double now = swing.energy();
        largest_gain = std::max(largest_gain, now - before);
        before = now;
      }
      EXPECT_LE(gain.add(largest_gain), 1e-12);  // rounding: 16 epsilon of up to 1 J, a few terms
      EXPECT_LT(before, start);
    }
  }
}

TEST(CupDecay, ComesToRestWhereStaticsSays) {
  const nlohmann::json vectors = test::load_vectors("static.json");
  if (vectors.is_null()) GTEST_SKIP() << "reference data not found: " << test::vectors_path("static.json");
  test::Worst position("position_m"), turn("turn_rad");
  for (const nlohmann::json& c : vectors.at("cases")) {
    SCOPED_TRACE(c.at("id").dump());
    SwingSetup setup;
    setup.K = test::matrix6(c.at("K"));
    setup.D = 0.02 * setup.K;  // damps the slow modes within a second
    setup.X_ES2 = test::pose(c.at("E_H_S2"));
    setup.X_SS1 = test::pose(c.at("S_H_S1"));
    setup.X_WE.R = test::matrix3(c.at("W_R_E"));
    setup.X_ES = setup.X_ES2 * setup.X_SS1.inverse();
    setup.inertia = {c.at("mass").get<double>(), test::vector3(c.at("com_S")),
                     Matrix3(c.at("mass").get<double>() * Vector3(0.004, 0.005, 0.007).asDiagonal())};
    SwingScene swing = make_swing(setup, 0.004);
    physics::Workspace work(swing.model);
    ASSERT_NO_FATAL_FAILURE(run(swing, work, 2500));
    // The vectors' own tolerances.
    EXPECT_LE(position.add((swing.X_ES().p - test::vector3(c.at("E_o_S"))).norm()), 1e-7);
    EXPECT_LE(turn.add(angle_between(swing.X_ES().R, test::matrix3(c.at("E_R_S")))), 1e-6);
  }
}

}  // namespace
}  // namespace snug::cup
