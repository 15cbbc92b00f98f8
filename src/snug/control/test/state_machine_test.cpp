// StateMachine: the demonstrator's states, one more, and how closely the robot keeps to the point model.
#include "snug/control/state_machine.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "demonstrator.hpp"
#include "snug/control/states.hpp"
#include "snug/motion/program_csv.hpp"

namespace snug::control {
namespace {

struct MachineDrive {
  JointController controller;
  StateMachine machine;
  motion::PreparedProgram plan;
  MachineState state;
  JointControllerWork work;

  MachineDrive(motion::Program program, const motion::Tracking& tracking, double stiffness = 10.0,
               const StateSettings& settings = {})
      : controller(test::make_controller(stiffness)),
        machine(make_demonstrator_machine(settings)),
        plan(motion::prepare(std::move(program), test::program_settings(tracking, stiffness))),
        state(machine.make_state(controller, test::start_joints(controller))) {}
  MachineTick tick() { return machine.tick(plan, controller, state, work); }
};

motion::Program moves(const std::vector<Vector3>& offsets) {
  motion::Program program{"test", {}};
  for (const Vector3& offset : offsets) {
    motion::Waypoint row =
        motion::make_waypoint(motion::MotionClass::Home, {}, test::demonstrator().controller.X_WE_start);
    row.X_WE.p += offset;
    program.waypoints.push_back(row);
  }
  return program;
}

struct Agreement {
  double robot_duration = 0.0, point_duration = 0.0;  ///< s
  double worst_distance = 0.0;                        ///< m, between the tools at equal times
  double worst_row_time = 0.0;                        ///< s, between the moments at which a row is reached
  int limited_ticks = 0;
};

Agreement compare(MachineDrive& drive) {
  Agreement result;
  motion::ControllerState point = motion::make_controller_state(drive.state.tool.X_WE);
  motion::ToolState tool = point.command;
  std::vector<std::int64_t> robot_reached, point_reached;
  bool robot_ends = false, point_ends = false;
  for (std::int64_t i = 0; i < 60000 && !(robot_ends && point_ends); ++i) {
    if (!robot_ends) {
      const MachineTick tick = drive.tick();
      if (tick.program.reached >= 0) robot_reached.push_back(i);
      result.limited_ticks += tick.joints.active_count > 0 || tick.joints.is_holding ? 1 : 0;
      robot_ends = tick.program.finished_now;
      result.robot_duration = 0.008 * static_cast<double>(i);
    }
    if (!point_ends) {
      const motion::ControllerOutput out = motion::tick(drive.plan, tool, point);
      tool = out.tool;
      if (out.reached >= 0) point_reached.push_back(i);
      point_ends = out.finished_now;
      result.point_duration = 0.008 * static_cast<double>(i);
    }
    result.worst_distance = std::max(result.worst_distance, (tool.X_WE.p - drive.state.tool.X_WE.p).norm());
  }
  for (std::size_t i = 0; i < std::min(robot_reached.size(), point_reached.size()); ++i) {
    result.worst_row_time =
        std::max(result.worst_row_time, 0.008 * std::abs(static_cast<double>(robot_reached[i] - point_reached[i])));
  }
  return result;
}

TEST(StateMachine, PassesFromInitialToOperationInTheFirstTick) {
  MachineDrive drive(moves({{0.05, 0.0, 0.0}}), motion::LaggedTracking{});
  const MachineTick tick = drive.tick();
  EXPECT_EQ(drive.machine.name_of(tick.state), "Operation");
  EXPECT_EQ(tick.program.departed, 0);
}

TEST(StateMachine, EndsWithOkWhenTheProgramIsDone) {
  MachineDrive drive(moves({{0.02, 0.0, 0.0}}), motion::LaggedTracking{});
  for (int i = 0; i < 2000; ++i) {
    const MachineTick tick = drive.tick();
    if (!tick.program.finished_now) continue;
    EXPECT_EQ(tick.outcome, Outcome::Ok);
    EXPECT_EQ(drive.machine.name_of(drive.state.state), "Operation");  // nothing follows: it settles on the last row
    return;
  }
  FAIL() << "did not end";
}

TEST(StateMachine, KeepsToThePointModelWhereNoLimitIsActive) {
  MachineDrive drive(moves({{0.1, 0.0, 0.0}, {0.1, 0.15, -0.05}, {-0.05, 0.1, 0.0}, {0.0, 0.0, 0.0}}),
                     motion::LaggedTracking{});
  const Agreement result = compare(drive);
  EXPECT_EQ(result.limited_ticks, 0);
  // The joints' accelerations are constant over a tick, the tool's are not quite: nothing else differs.
  EXPECT_LT(result.worst_distance, 1e-4);
  EXPECT_LE(result.worst_row_time, 0.008);
  EXPECT_NEAR(result.robot_duration, result.point_duration, 0.0081);
}

TEST(StateMachine, IsOnTheReferenceOfTheIdealController) {
  MachineDrive drive(moves({{0.1, 0.0, 0.0}, {0.1, 0.15, -0.05}, {0.0, 0.0, 0.0}}), motion::ExactTracking{});
  double worst = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const MachineTick tick = drive.tick();
    worst = std::max(worst, (tick.program.X_WE_reference.p - drive.state.tool.X_WE.p).norm());
    if (tick.program.finished_now) break;
  }
  EXPECT_LT(worst, 1e-4);  // accelerations of 3 m/s^2 begin at once: half of 3 * (8 ms)^2 is 96 um
}

TEST(StateMachine, ComesToHoldWhenARowIsOutOfReach) {
  MachineDrive drive(moves({{0.1, 0.0, 0.0}, {0.0, -3.0, 0.0}}), motion::LaggedTracking{}, 10.0, {2.0});
  for (int i = 0; i < 5000; ++i) {
    const MachineTick tick = drive.tick();
    if (tick.outcome != Outcome::Stuck) continue;
    EXPECT_EQ(tick.program.row, 1);
    EXPECT_EQ(drive.machine.name_of(drive.state.state), "Hold");
    for (int k = 0; k < 200; ++k) (void)drive.tick();
    EXPECT_LT(drive.state.joints.qd.norm(), 1e-12);
    EXPECT_EQ(drive.machine.name_of(drive.state.state), "Hold");
    return;
  }
  FAIL() << "never stuck";
}

TEST(StateMachine, GoesOnFromACopyWithTheSameBytes) {
  MachineDrive drive(moves({{0.1, 0.0, 0.0}, {0.0, 0.2, 0.0}}), motion::LaggedTracking{});
  for (int i = 0; i < 100; ++i) (void)drive.tick();
  const MachineState kept = drive.state;
  for (int i = 0; i < 300; ++i) (void)drive.tick();
  const MachineState first = drive.state;
  drive.state = kept;
  drive.work = JointControllerWork();
  for (int i = 0; i < 300; ++i) (void)drive.tick();
  EXPECT_TRUE(drive.state == first);
}

/// A state of a test: counts how often each part of its life is called, moves nothing.
class CountingState final : public State {
 public:
  struct Calls {
    int configured = 0, started = 0, run = 0, torn_down = 0;
  };
  explicit CountingState(Calls& calls) : calls_(calls) {}
  [[nodiscard]] std::string_view name() const override { return "Counting"; }
  void configure(const StateSettings&) override { ++calls_.configured; }
  void start(StateContext&) const override { ++calls_.started; }
  [[nodiscard]] Outcome run(StateContext& context) const override {
    context.stand();
    return ++calls_.run == 3 ? Outcome::Ok : Outcome::GoesOn;
  }
  void teardown(StateContext&) const override { ++calls_.torn_down; }

 private:
  Calls& calls_;
};

TEST(StateMachine, LeadsAStateThroughItsLife) {
  MachineDrive drive(moves({{0.1, 0.0, 0.0}}), motion::LaggedTracking{});
  CountingState::Calls calls;
  std::vector<std::unique_ptr<State>> states;
  states.push_back(std::make_unique<CountingState>(calls));
  states.push_back(make_hold_state());
  drive.machine = StateMachine(std::move(states), {{"Counting", Outcome::Ok, "Hold"}}, {});
  drive.state = drive.machine.make_state(drive.controller, test::start_joints(drive.controller));
  for (int i = 0; i < 5; ++i) (void)drive.tick();
  EXPECT_EQ(calls.configured, 1);
  EXPECT_EQ(calls.started, 1);
  EXPECT_EQ(calls.run, 3);
  EXPECT_EQ(calls.torn_down, 1);
  EXPECT_EQ(drive.machine.name_of(drive.state.state), "Hold");
}

TEST(StateMachine, RunsTheRealProgramsAtTheTempoOfThePointModel) {
  const std::filesystem::path path =
      std::filesystem::path(SNUG_SOURCE_DIR) / ".." / "shared" / "data" / "waypoints" / "poses1real.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  MachineDrive drive(motion::load_program(path), motion::LaggedTracking{});
  const Agreement result = compare(drive);
  // Without limits it would be as above. Half of the shoulder's speed, which the controller may use, cuts its fastest
  // turns for 3 % of the ticks: it catches up within the row, and the whole takes half a second longer (measured 0.47
  // s).
  EXPECT_GT(result.limited_ticks, 0);
  EXPECT_LT(result.limited_ticks, 1500);
  EXPECT_NEAR(result.robot_duration, result.point_duration, 1.0);
}

}  // namespace
}  // namespace snug::control
