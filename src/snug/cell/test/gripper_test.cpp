// Gripper of several cups: what they hold together, how they share a load, what an open one costs the others.
#include "snug/cell/gripper.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/cell/simulation.hpp"
#include "snug/cell/test/demonstrator.hpp"
#include "snug/motion/program_csv.hpp"

namespace snug::cell {
namespace {

constexpr double kGravity = 9.81;
constexpr double kHalfHeight = 0.1;

struct Cell {
  double mass = 1.0;
  double com_x = 0.0;
  Vector3 size = Vector3(0.6, 0.4, 2.0 * kHalfHeight);
  std::string gripper;     ///< what stands in the scenario
  std::string cup = "{}";  ///< the same
  double time_step = 1e-3;
};

model::Scenario scenario_of(const Cell& cell) {
  return model::parse_scenario(fmt::format(R"(name: lift
time_step: {}
materials: [{{name: box}}, {{name: bench}}]
contacts: {{default: {{friction: 0.3, restitution: 0.0}}}}
parcel_types: [{{name: b, size: [{}, {}, {}], mass: {}}}]
parcels: [{{id: P1, type: b, material: box, com: [{}, 0, 0]}}, {{id: P2, type: b, material: box}}]
containers: [{{name: pallet, pose: {{position: [5, 0, 0]}}, inner_size: [0.6, 0.4, 0.3], material: bench, walls: false}}]
bodies: [{{name: bench, kind: static, material: bench, size: [4, 4, 0.1], pose: {{position: [0, 0, -0.05]}}}}]
aligner: {{pose: {{position: [-1, -1, 0]}}, support_height: 0.0}}
tool: {{mass: 1.0}}
cup: {}
{}
controller: {{start_pose: {{position: [0, 0, 0.5], rpy_deg: [180, 0, 0]}}}}
sequences: [{{name: s, items: [{{parcel: P1, up: Z}}, {{parcel: P2, up: Z}}]}}]
)",
                                           cell.time_step, cell.size.x(), cell.size.y(), cell.size.z(), cell.mass,
                                           cell.com_x, cell.cup, cell.gripper),
                               "lift.yaml");
}

/// A tool that is led: it presses the cups on, waits for the vacuum, lifts slowly and waits.
class Lift {
 public:
  explicit Lift(const Cell& cell, double second_x = 0.0)
      : scenario(scenario_of(cell)),
        simulation(scenario, "s", {}),
        state(simulation.make_state()),
        work(simulation.make_workspace()) {
    const double first = second_x > 0.0 ? -second_x : 0.0;
    EXPECT_TRUE(simulation.feed(0, Pose{Matrix3::Identity(), Vector3(first, 0.0, kHalfHeight)}, state));
    state.waiting_item = -1;
    if (second_x > 0.0) {
      EXPECT_TRUE(simulation.feed(1, Pose{Matrix3::Identity(), Vector3(second_x, 0.0, kHalfHeight)}, state));
    }
    lead(2.0 * kHalfHeight + 0.055, 0.0, 1.5);
  }
  /// At this height or up from it, for so long, s.
  void lead(double height, double speed, double duration, bool vacuum = true) {
    const double tick = scenario.controller.tick;
    for (double t = 0.0; t < duration; t += tick) {
      height += speed * tick;
      ToolCommand command;
      command.tool.X_WE = {exp_rotation(Vector3(std::numbers::pi, 0.0, 0.0)), Vector3(0.0, 0.0, height)};
      command.tool.V_WE.linear.z() = speed;
      command.cup.vacuum = vacuum;
      ASSERT_FALSE(simulation.advance(command, state, work).failure);
    }
    height_ = height;
  }
  void lift() {
    lead(height_, 0.02, 4.0);
    lead(height_, 0.0, 2.0);
  }
  [[nodiscard]] bool holds() const { return state.gripper.cup.body == simulation.world().parcels[0].index; }
  [[nodiscard]] double pull_of(std::size_t cup) const { return -state.gripper.cups[cup].F_S.force.z(); }
  [[nodiscard]] int events(const std::string& kind) const {
    return static_cast<int>(
        std::ranges::count_if(state.event_log.events(), [&](const auto& e) { return e.kind == kind; }));
  }

  model::Scenario scenario;
  Simulation simulation;
  CellState state;
  CellWorkspace work;

 private:
  double height_ = 0.0;
};

std::string square(double x, double y, const std::string& more = "") {
  return fmt::format(
      "gripper: {{cups: [{{at: [{0}, {1}]}}, {{at: [-{0}, {1}]}}, {{at: [-{0}, -{1}]}}, {{at: [{0}, -{1}]}}]{2}}}", x,
      y, more);
}
const std::string kPair = "gripper: {cups: [{at: [0.1, 0]}, {at: [-0.1, 0]}]}";

/// N that the vacuum of one cup holds.
double limit_of_one() {
  const model::CupParams cup;
  return -cup.vacuum.pressure_gauge_hold * 0.25 * std::numbers::pi * cup.effective_diameter * cup.effective_diameter;
}

TEST(Gripper, OfOneCupAtEMovesABoxWithTheSameBytesAsThatCup) {
  const auto hash = [](const model::Scenario& scenario) {
    motion::Program program = motion::load_program(kSource / "src/snug/cell/test/demo_program.csv");
    program.waypoints.resize(8);
    const Simulation simulation(scenario, "1", {});
    const motion::PreparedProgram plan = simulation.prepare(program);
    CellState state = simulation.make_state();
    CellWorkspace work = simulation.make_workspace();
    while (!simulation.is_at_end(plan, state)) EXPECT_FALSE(simulation.advance(plan, state, work).failure);
    return simulation.hash(state);
  };
  model::Scenario scenario = demonstrator();
  const std::uint64_t alone = hash(scenario);
  model::MountedCup cup;
  cup.name = "1";
  cup.cup = scenario.cup;
  scenario.gripper = model::GripperParams{{"main"}, {cup}, {}};
  EXPECT_EQ(hash(scenario), alone);
}

TEST(Gripper, OfCupsAboutTheCentreOfMassHoldsAsManyTimesWhatOneHolds) {
  // Leaving the bench at 20 mm/s adds v sqrt(k m), at most 2 N a cup, 1.2 % of its limit.
  const auto holds = [](const std::string& gripper, double share, double count) {
    Lift lift({share * count * limit_of_one() / kGravity, 0.0, Vector3(0.6, 0.4, 0.2), gripper});
    lift.lift();
    return lift.holds();
  };
  EXPECT_TRUE(holds(kPair, 0.96, 2.0));
  EXPECT_FALSE(holds(kPair, 1.04, 2.0));
  EXPECT_TRUE(holds(square(0.15, 0.1), 0.96, 4.0));
  EXPECT_FALSE(holds(square(0.15, 0.1), 1.04, 4.0));
}

TEST(Gripper, SharesALoadBesideItsMiddleAsTheElasticLawSays) {
  const double mass = 8.0, com = 0.03;
  Lift lift({mass, com, Vector3(0.6, 0.4, 0.2), kPair});
  lift.lift();
  ASSERT_TRUE(lift.holds());
  // Two springs at +-a and their bending against the weight, whose lever shrinks as the box tilts about their centre.
  const model::CupParams cup;
  const double a = 0.1, h = cup.centre_from_lip + kHalfHeight, weight = mass * kGravity;
  const double stiffness = 2.0 * (cup.stiffness.axial * a * a + cup.stiffness.bend);
  const double tilt = weight * com / (stiffness + weight * h);
  const double near = 0.5 * weight + cup.stiffness.axial * a * tilt, far = weight - near;
  EXPECT_NEAR(lift.pull_of(0), near, 0.01 * weight);
  EXPECT_NEAR(lift.pull_of(1), far, 0.01 * weight);
  // What all do together is the weight, at the place where Ez met the face.
  EXPECT_NEAR(lift.state.gripper.F_S.force.norm(), weight, 0.005 * weight);
  EXPECT_NEAR(lift.state.gripper.F_S.torque.norm(), weight * com, 0.08 * weight * com);
}

TEST(Gripper, CarriesAMomentThatGrowsWithItsLever) {
  // The cup that carries most is at its limit: the factor counts for the wider pair, with the same box beside its
  // middle.
  const auto factor = [](double a) {
    Lift lift({8.0, 0.05, Vector3(0.6, 0.4, 0.2),
               fmt::format("gripper: {{cups: [{{at: [{0}, 0]}}, {{at: [-{0}, 0]}}]}}", a)});
    lift.lift();
    return std::min(lift.state.gripper.cups[0].least_hold_factor, lift.state.gripper.cups[1].least_hold_factor);
  };
  EXPECT_GT(factor(0.2), 1.15 * factor(0.08));
}

TEST(Gripper, LosesVacuumThroughAnOpenCupAsTheSupplyBalancesIt) {
  // The box is so narrow that the cups at +x find no face.
  const std::string supply = ", supply: {flow: 2.0e-2, pressure_gauge: -6.0e4}";
  Lift lift({2.0, 0.0, Vector3(0.25, 0.4, 0.2), square(0.16, 0.1, supply)});
  EXPECT_EQ(holding_cups(lift.state.gripper, lift.simulation.world().parcels[0].index), 0);  // all beside it
  const std::string beside =
      "gripper: {cups: [{at: [0.0, 0.1]}, {at: [0.0, -0.1]}, {at: [0.2, 0.0]}], supply: {flow: 2.0e-2}}";
  Lift open({2.0, 0.0, Vector3(0.25, 0.4, 0.2), beside});
  open.lift();
  ASSERT_TRUE(open.holds());
  const double b = 0.25 * std::numbers::pi * 0.004 * 0.004 * std::sqrt(2.0 / 1.2), a = 2.0e-2 / 6.0e4;
  const double x = (-b + std::sqrt(b * b + 4.0 * a * 2.0e-2)) / (2.0 * a);
  ASSERT_LT(x * x, 5.9e4);
  for (const std::size_t cup : {0U, 1U})
    EXPECT_NEAR(open.state.gripper.cups[cup].cup.pressure_gauge, -x * x, 0.01 * x * x);
  EXPECT_EQ(open.state.gripper.cups[2].cup.pressure_gauge, 0.0);
  EXPECT_EQ(open.events("cups"), 1);
}

TEST(Gripper, SwitchesItsZonesOneByOne) {
  const std::string zones = "gripper: {cups: [{at: [0.1, 0], zone: A}, {at: [-0.1, 0], zone: B}]}";
  Lift lift({2.0, 0.0, Vector3(0.6, 0.4, 0.2), zones});
  ASSERT_EQ(holding_cups(lift.state.gripper, lift.simulation.world().parcels[0].index), 2);
  ToolCommand command;
  command.tool = lift.state.controller.command;
  command.tool.V_WE = Twist{};
  command.cup = {true, false, 1U};
  command.tool.V_WE.linear.z() = 0.03;
  for (int i = 0; i < 250; ++i) {  // up by 60 mm, beyond the length of the cup without vacuum
    command.tool.X_WE.p.z() += 0.03 * lift.scenario.controller.tick;
    ASSERT_FALSE(lift.simulation.advance(command, lift.state, lift.work).failure);
  }
  EXPECT_EQ(holding_cups(lift.state.gripper, lift.simulation.world().parcels[0].index), 1);
  EXPECT_TRUE(lift.holds());
  EXPECT_LT(lift.state.gripper.cups[0].cup.pressure_gauge, -5.0e4);
}

TEST(Gripper, LetsGoAlikeWithLongAndShortSteps) {
  // m, how far a hanging box has fallen 0.136 s after the switch: the bellows grew by 30 mm, then the lip opened.
  const auto fallen = [](double time_step) {
    Cell cell;
    cell.cup = "{release: {growth: 0.0297}}";
    cell.time_step = time_step;
    Lift lift(cell);
    lift.lift();
    const auto height = [&] {
      return physics::pose_of(lift.simulation.world().model, lift.state.world, lift.simulation.world().parcels[0])
          .p.z();
    };
    const double before = height();
    ToolCommand command;
    command.tool.X_WE = lift.state.controller.command.X_WE;
    command.cup.blow_off = true;
    for (int i = 0; i < 17; ++i) EXPECT_FALSE(lift.simulation.advance(command, lift.state, lift.work).failure);
    EXPECT_FALSE(lift.holds());
    return before - height();
  };
  const double exact = fallen(0.1e-3);
  EXPECT_GT(exact, 0.05);
  EXPECT_LT(exact, 0.08);
  // The lip opens at the end of a step: for up to 1 ms it pulls with 4 N, 50 ms before.
  EXPECT_NEAR(fallen(1e-3), exact, 0.2e-3);
}

TEST(Gripper, SaysThatItHoldsTwoBoxes) {
  Lift lift({2.0, 0.0, Vector3(0.3, 0.4, 0.2), kPair}, 0.155);
  EXPECT_EQ(lift.events("two boxes"), 1);
  EXPECT_EQ(lift.events("seal"), 1);
}

TEST(Gripper, SaysWhichCupCameOffAndLetsTheBoxGoOnce) {
  Lift lift({1.1 * 2.0 * limit_of_one() / kGravity, 0.06, Vector3(0.6, 0.4, 0.2), kPair});
  lift.lift();
  EXPECT_FALSE(lift.holds());
  EXPECT_EQ(lift.events("cup lost"), 2);
  EXPECT_EQ(lift.events("lost"), 1);
}

}  // namespace
}  // namespace snug::cell
