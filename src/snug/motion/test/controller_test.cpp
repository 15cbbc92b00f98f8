// Tests of the two controllers on small programs built by hand.
#include "snug/motion/controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "snug/core/hash.hpp"
#include "snug/core/test/allocation_count.hpp"
#include "snug/motion/test/demonstrator.hpp"

namespace snug::motion {
namespace {

constexpr int kWaitTicks = 63;  // 0.5 s / 8 ms = 62.5, rounded up

Waypoint row(const std::string& name, const Vector3& p, const IO& io = {}, const Vector3& rotation = Vector3::Zero()) {
  Waypoint waypoint = parse_waypoint_name(name);
  waypoint.X_WE.p = p;
  waypoint.X_WE.R = exp_rotation(rotation);
  waypoint.io = io;
  return waypoint;
}

/// One entry "a" that matches the names of these tests.
ControllerSettings settings_of(const Tracking& tracking, const MotionLimits& limits = {0.005, 3.0, 0.5, 2.0, 2.0}) {
  ControllerSettings settings;
  settings.tracking = tracking;
  settings.limits = {{"a", limits}};
  return settings;
}

struct Tick {
  ControllerOutput output;
  ToolState measured;     ///< at the start of the tick
  ControllerState state;  ///< after it
};

/// Runs to the end of the program and `more` ticks beyond.
std::vector<Tick> run(const PreparedProgram& plan, const Pose& X_WE_start, int more = 0) {
  std::vector<Tick> ticks;
  ControllerState state = make_controller_state(X_WE_start);
  ToolState measured = state.command;
  int left = -1;
  while (left != 0 && ticks.size() < 100000) {
    const ControllerOutput output = tick(plan, measured, state);
    ticks.push_back({output, measured, state});
    measured = output.tool;
    if (left > 0) --left;
    if (output.finished_now) left = more;
  }
  return ticks;
}

/// Index of the tick at whose start row `index` took effect, or was reached.
std::size_t departure_of(const std::vector<Tick>& ticks, int index) {
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (ticks[i].output.departed == index) return i;
  }
  return ticks.size();
}
std::size_t arrival_of(const std::vector<Tick>& ticks, int index) {
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if (ticks[i].output.reached == index) return i;
  }
  return ticks.size();
}

class BothControllers : public testing::TestWithParam<Tracking> {};
INSTANTIATE_TEST_SUITE_P(Motion, BothControllers,
                         testing::Values(Tracking(LaggedTracking{}), Tracking(ExactTracking{})),
                         [](const auto& test) { return is_exact(test.param) ? "Exact" : "Lagged"; });

int waiting_ticks(const std::vector<Tick>& ticks, int index) {
  int count = 0;
  for (const Tick& t : ticks) count += t.output.row == index && t.output.phase == ControllerPhase::Waiting ? 1 : 0;
  return count;
}

TEST_P(BothControllers, SwitchesAtDepartureAndWaitsOnlyForVacuumChangesAndBlowOffOn) {
  const IO vacuum{.vacuum = true};
  const IO blow{.blow_off = true};
  const IO both{.vacuum = true, .blow_off = true};
  const IO conveyor{.conveyor_cw = true, .conveyor_ccw = true, .optitrack = true, .reserved = true};
  const std::vector<IO> io = {{}, vacuum, vacuum, both, vacuum, blow, blow, {}, conveyor, {}, blow, vacuum};
  const std::vector<int> waits = {0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 1, 1};
  Program program{"p", {}};
  for (std::size_t i = 0; i < io.size(); ++i) {
    program.waypoints.push_back(row("a", Vector3(0.02 * static_cast<double>(i % 3), 0.0, 0.0), io[i]));
  }
  const std::vector<Tick> ticks = run(prepare(program, settings_of(GetParam())), Pose{});
  for (std::size_t i = 0; i < io.size(); ++i) {
    SCOPED_TRACE(i);
    const std::size_t departure = departure_of(ticks, static_cast<int>(i));
    ASSERT_LT(departure, ticks.size());
    EXPECT_EQ(ticks[departure].output.io, io[i]);
    if (i > 0) {
      EXPECT_EQ(ticks[departure - 1].output.io, io[i - 1]);
      EXPECT_EQ(departure, arrival_of(ticks, static_cast<int>(i) - 1));
    }
    EXPECT_EQ(waiting_ticks(ticks, static_cast<int>(i)), waits[i] * kWaitTicks);
  }
}

TEST_P(BothControllers, StandUntilTheNextRowMayBegin) {
  Program program{"p", {row("a", Vector3(0.02, 0.0, 0.0)), row("a", Vector3(0.02, 0.1, 0.0), {.conveyor_cw = true})}};
  program.waypoints[1].not_before = 4.0;
  const std::vector<Tick> ticks = run(prepare(program, settings_of(GetParam())), Pose{});
  const std::size_t departure = departure_of(ticks, 1);
  EXPECT_EQ(departure, 500U);
  EXPECT_LT(arrival_of(ticks, 0), 300U);
  EXPECT_EQ(ticks[departure - 1].output.phase, ControllerPhase::Standing);
  EXPECT_FALSE(ticks[departure - 1].output.io.conveyor_cw);
  EXPECT_LT((ticks[departure - 1].output.tool.X_WE.p - program.waypoints[0].X_WE.p).norm(), 1e-4);
  program.waypoints[1].not_before = 1e-3;  // long past
  const std::vector<Tick> late = run(prepare(program, settings_of(GetParam())), Pose{});
  EXPECT_EQ(departure_of(late, 1), arrival_of(late, 0));
}

TEST_P(BothControllers, WaitAWholeNumberOfTicksExactly) {
  Program program{"p", {row("a", Vector3::Zero(), {.vacuum = true})}};
  for (const auto& [wait, count] : std::vector<std::pair<double, int>>{{0.0, 0}, {0.008, 1}, {0.4, 50}, {0.5, 63}}) {
    ControllerSettings settings = settings_of(GetParam());
    settings.vacuum_wait = wait;
    EXPECT_EQ(waiting_ticks(run(prepare(program, settings), Pose{}), 0), count) << wait;
  }
}

TEST_P(BothControllers, FinishOnDuplicateRowsAndRowsWhereTheToolIsAlready) {
  const Vector3 p(0.1, 0.2, 0.3);
  const Vector3 r(0.0, std::numbers::pi, 0.0);
  const Program program{"p",
                        {row("a", p, {}, r), row("a", p, {}, r), row("a", p, {.vacuum = true}, r), row("a", p, {}, r)}};
  const std::vector<Tick> ticks = run(prepare(program, settings_of(GetParam())), program.waypoints[0].X_WE);
  // Each row takes one tick; two of them wait.
  EXPECT_EQ(ticks.size(), 4u + 2u * kWaitTicks + 1u);
  for (const Tick& t : ticks) {
    EXPECT_EQ(t.output.tool.X_WE.p, p);
    EXPECT_LT(angle_between(t.output.tool.X_WE.R, program.waypoints[0].X_WE.R), 1e-12);
    EXPECT_LT(as_vector(t.output.tool.V_WE).norm(), 1e-12);
  }
}

TEST_P(BothControllers, GiveTheSameBytesAgainAndFromASnapshot) {
  const Program program{"p",
                        {row("a", Vector3(0.3, 0.0, 0.1), {}, Vector3(0.0, 0.0, 1.0)),
                         row("a", Vector3(0.3, 0.5, 0.1), {.vacuum = true}, Vector3(1.0, 0.0, 1.0)),
                         row("a", Vector3(0.0, 0.5, 0.0), {}, Vector3(0.0, 3.0, 0.0))}};
  const PreparedProgram plan = prepare(program, settings_of(GetParam()));
  const auto hash_of = [](const ToolState& tool, Hash& hash) {
    for (const double value : tool.X_WE.p) hash.add(value);
    for (const double value : tool.X_WE.R.reshaped()) hash.add(value);
    const Vector6 V = as_vector(tool.V_WE);
    for (const double value : V) hash.add(value);
  };
  const std::vector<Tick> ticks = run(plan, Pose{});
  const std::vector<Tick> again = run(plan, Pose{});
  Hash first;
  Hash second;
  for (const Tick& t : ticks) hash_of(t.output.tool, first);
  for (const Tick& t : again) hash_of(t.output.tool, second);
  EXPECT_EQ(first.value(), second.value());

  const std::size_t middle = ticks.size() / 2;
  ControllerState state = ticks[middle].state;
  ToolState measured = ticks[middle].output.tool;
  for (std::size_t i = middle + 1; i < ticks.size(); ++i) {
    measured = tick(plan, measured, state).tool;
    ASSERT_EQ(state, ticks[i].state) << i;
  }
}

TEST_P(BothControllers, DoNotAllocateInATick) {
  const Program program{"p", {row("a", Vector3(0.3, 0.0, 0.1)), row("a", Vector3(0.3, 0.5, 0.1), {.vacuum = true})}};
  const PreparedProgram plan = prepare(program, settings_of(GetParam()));
  ControllerState state = make_controller_state(Pose{});
  ToolState measured = state.command;
  const long before = test::allocation_count();
  for (int i = 0; i < 3000; ++i) measured = tick(plan, measured, state).tool;
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_EQ(state.phase, ControllerPhase::Finished);
}

TEST(LaggedController, AnswersAStepAsACriticallyDampedTask) {
  // Limits so high that the reference is at the goal after a tick: a step of 0.1 m and 0.2 rad.
  const Vector3 goal(0.1, 0.0, 0.0);
  const Vector3 turn(0.0, 0.0, 0.2);
  ControllerSettings settings = settings_of(LaggedTracking{}, {1e-5, 1e6, 1e6, 1e6, 1e6});
  const PreparedProgram plan = prepare({"p", {row("a", goal, {}, turn)}}, settings);
  const std::vector<Tick> ticks = run(plan, Pose{});
  const double w = std::sqrt(settings.task_stiffness);
  for (std::size_t i = 10; i < ticks.size(); i += 10) {
    const double t = static_cast<double>(i) * kTick;  // one tick later than t = 0: the first reference is the start
    const double left = (1.0 + w * t) * std::exp(-w * t);
    const Pose& X_WE = ticks[i].output.tool.X_WE;
    // First-order hold of the acceleration: error of order w dt = 0.025 of the step.
    EXPECT_NEAR(goal.x() - X_WE.p.x(), 0.1 * left, 0.1 * w * kTick) << t;
    EXPECT_NEAR(0.2 - log_rotation(X_WE.R).z(), 0.2 * left, 0.2 * w * kTick) << t;
  }
}

TEST(LaggedController, LagsBehindASteadyReferenceByTwiceSpeedOverRootStiffness) {
  const PreparedProgram plan =
      prepare({"p", {row("a", Vector3(6.0, 0.0, 0.0))}}, settings_of(LaggedTracking{}, {0.005, 4.0, 0.6, 1.0, 1.0}));
  const std::vector<Tick> ticks = run(plan, Pose{});
  const std::size_t i = 625;  // 5 s: the start-up error decayed by exp(-15)
  // Against the exact reference (the sampled coast runs slower by 4 %), so with the coast speed itself.
  const double speed = ticks[i].state.segment.translation().coast_speed;
  const double lag = (ticks[i].output.X_WE_reference.p - ticks[i].measured.X_WE.p).x();
  EXPECT_NEAR(lag, 2.0 * speed / std::sqrt(10.0), 1e-3);
  EXPECT_NEAR(lag, 0.38, 0.02);  // interfaces 2.4: 0.38 m at 0.6 m/s
  EXPECT_NEAR(ticks[i].measured.V_WE.linear.x(), speed, 1e-3);
}

TEST(LaggedController, ReachesARowAtTheFirstTickWithinItsPrecision) {
  for (const double precision : {0.0005, 0.005, 0.05, 0.2}) {
    SCOPED_TRACE(precision);
    const Waypoint goal = row("a", Vector3(0.4, 0.0, 0.0), {}, Vector3(0.0, 0.0, 0.5));
    ControllerSettings settings = settings_of(LaggedTracking{}, {precision, 3.0, 0.5, 2.0, 2.0});
    const std::vector<Tick> ticks = run(prepare({"p", {goal}}, settings), Pose{});
    for (std::size_t i = 1; i < ticks.size(); ++i) {
      const Pose& X_WE = ticks[i].measured.X_WE;
      const double angle_deg = angle_between(X_WE.R, goal.X_WE.R) * 180.0 / std::numbers::pi;
      const double error = (goal.X_WE.p - X_WE.p).norm() + angle_deg / 500.0;
      EXPECT_EQ(error <= precision, i + 1 == ticks.size()) << i;
      EXPECT_DOUBLE_EQ(convergence_error(X_WE, goal.X_WE, 500.0), error);
    }
  }
}

TEST(LaggedController, FliesByARowOfLowPrecisionAndRestartsTheReferenceFromTheMeasuredPose) {
  const Program program{"p", {row("a", Vector3(0.5, 0.0, 0.0)), row("a", Vector3(0.5, 0.5, 0.0))}};
  const PreparedProgram plan = prepare(program, settings_of(LaggedTracking{}, {0.05, 3.0, 0.5, 2.0, 2.0}));
  const std::vector<Tick> ticks = run(plan, Pose{});
  const Tick& departure = ticks[departure_of(ticks, 1)];
  EXPECT_GT(departure.measured.V_WE.linear.norm(), 0.05);
  EXPECT_LT(departure.measured.X_WE.p.x(), 0.5 - 0.03);
  EXPECT_EQ(departure.state.segment.start(), departure.measured.X_WE);
  EXPECT_EQ(departure.output.X_WE_reference, departure.measured.X_WE);
}

TEST(LaggedController, StartsAfterAWaitFromThePoseBeforeIt) {
  const Program program{"p", {row("a", Vector3(0.5, 0.0, 0.0)), row("a", Vector3(0.5, 0.5, 0.0), {.vacuum = true})}};
  const PreparedProgram plan = prepare(program, settings_of(LaggedTracking{}));
  const std::vector<Tick> ticks = run(plan, Pose{});
  const std::size_t departure = departure_of(ticks, 1);
  const std::size_t start = departure + kWaitTicks;
  EXPECT_EQ(ticks[start - 1].output.phase, ControllerPhase::Waiting);
  EXPECT_EQ(ticks[start].output.phase, ControllerPhase::Moving);
  EXPECT_EQ(ticks[start].state.segment.start(), ticks[departure].measured.X_WE);
  // Meanwhile the tool went on toward the row before.
  EXPECT_LT(0.5 - ticks[start].measured.X_WE.p.x(), 0.5 * (0.5 - ticks[departure].measured.X_WE.p.x()));
}

TEST(LaggedController, UsesWhatIsMeasuredNotWhatWasCommanded) {
  const Program program{"p", {row("a", Vector3(0.5, 0.0, 0.0))}};
  const PreparedProgram plan = prepare(program, settings_of(LaggedTracking{}));
  ControllerState state = make_controller_state(Pose{});
  ToolState measured;
  measured.X_WE.p = Vector3(0.0, 0.1, 0.0);
  EXPECT_EQ(tick(plan, measured, state).departed, 0);
  EXPECT_EQ(state.segment.start(), measured.X_WE);
  measured.X_WE = program.waypoints[0].X_WE;
  EXPECT_TRUE(tick(plan, measured, state).finished_now);
}

TEST(LaggedController, SettlesOnTheLastRow) {
  const Program program{"p", {row("a", Vector3(0.5, 0.1, 0.2), {}, Vector3(0.0, 2.0, 1.0))}};
  const PreparedProgram plan = prepare(program, settings_of(LaggedTracking{}, {0.2, 3.0, 0.5, 2.0, 2.0}));
  const std::vector<Tick> ticks = run(plan, Pose{}, 2000);
  const ToolState& last = ticks.back().output.tool;
  // 16 s are 50 time constants.
  EXPECT_LT(convergence_error(last.X_WE, program.waypoints[0].X_WE, 500.0), 1e-12);
  EXPECT_LT(as_vector(last.V_WE).norm(), 1e-12);
  EXPECT_EQ(ticks.back().output.phase, ControllerPhase::Finished);
  EXPECT_FALSE(ticks.back().output.finished_now);
}

TEST(LaggedController, MovesSmoothlyBetweenTicks) {
  const Program program{"p", {row("a", Vector3(0.5, 0.1, 0.2), {}, Vector3(0.0, 2.0, 1.0))}};
  const std::vector<Tick> ticks = run(prepare(program, settings_of(LaggedTracking{})), Pose{});
  for (const Tick& t : ticks) {
    const ToolState middle = interpolate(t.measured, t.output.tool, kTick, 0.5);
    const Twist& V0 = t.measured.V_WE;
    const Twist& V1 = t.output.tool.V_WE;
    // The acceleration is constant over a tick: the middle speed is the mean; for turns to the order (w dt)^2.
    EXPECT_LT((middle.V_WE.linear - 0.5 * (V0.linear + V1.linear)).norm(), 1e-13);
    EXPECT_LT((middle.V_WE.angular - 0.5 * (V0.angular + V1.angular)).norm(), 1e-4);
  }
}

TEST(IdealController, ReachesEveryRowExactlyAndAtRestAndStaysWhileWaiting) {
  const Program program{"p",
                        {row("a", Vector3(0.3, 0.0, 0.1), {}, Vector3(0.0, 0.0, 1.0)),
                         row("a", Vector3(0.3, 0.5, 0.1), {.vacuum = true}, Vector3(1.0, 0.0, 1.0)),
                         row("a", Vector3(0.0, 0.5, 0.0), {}, Vector3(0.0, 3.0, 0.0))}};
  const PreparedProgram plan = prepare(program, settings_of(ExactTracking{}));
  const std::vector<Tick> ticks = run(plan, Pose{}, 10);
  Pose X_WE_last;
  std::size_t expected_ticks = 0;
  for (int i = 0; i < 3; ++i) {
    SCOPED_TRACE(i);
    const std::size_t index = static_cast<std::size_t>(i);
    const Pose& X_WE = program.waypoints[index].X_WE;
    const Tick& arrival = ticks[arrival_of(ticks, i)];
    EXPECT_EQ(arrival.measured.X_WE, X_WE);
    EXPECT_EQ(arrival.measured.V_WE, Twist{});
    const LspbSegment segment(X_WE_last, X_WE, plan.row_limits[index]);
    expected_ticks += static_cast<std::size_t>(std::ceil(segment.duration() / kTick));
    if (i > 0) expected_ticks += kWaitTicks;  // on, off
    EXPECT_EQ(arrival_of(ticks, i), expected_ticks);
    X_WE_last = X_WE;
  }
  const std::size_t departure = departure_of(ticks, 1);
  for (std::size_t k = departure; k < departure + kWaitTicks; ++k) {
    EXPECT_EQ(ticks[k].output.tool.X_WE, program.waypoints[0].X_WE);
    EXPECT_EQ(ticks[k].output.tool.V_WE, Twist{});
  }
  EXPECT_EQ(ticks.back().output.tool.X_WE, program.waypoints[2].X_WE);
}

TEST(IdealController, IsOnTheReferenceAtEveryTick) {
  const Waypoint goal = row("a", Vector3(0.3, 0.0, 0.1), {}, Vector3(0.0, 0.0, 1.0));
  const PreparedProgram plan = prepare({"p", {goal}}, settings_of(ExactTracking{}));
  const LspbSegment segment(Pose{}, goal.X_WE, plan.row_limits[0]);
  const std::vector<Tick> ticks = run(plan, Pose{});
  for (std::size_t i = 0; i + 1 < ticks.size(); ++i) {
    const LspbSegment::Sample sample = segment.sample(static_cast<double>(i + 1) * kTick);
    EXPECT_EQ(ticks[i].output.tool.X_WE, sample.X_WE);
    EXPECT_EQ(ticks[i].output.tool.V_WE, sample.V_WE);
  }
}

TEST(Preparation, RefusesSettingsThatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Program program{"p.csv", {row("a", Vector3::Zero())}};
  const auto failing = [&](auto change) {
    ControllerSettings settings = settings_of(LaggedTracking{});
    change(settings);
    return where_it_fails([&] { (void)prepare(program, settings); });
  };
  EXPECT_EQ(failing([](auto&) {}), "no error");
  for (const double bad : {nan, 0.0, -1.0, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(failing([&](auto& s) { s.tick = bad; }), "p.csv controller tick");
    EXPECT_EQ(failing([&](auto& s) { s.task_stiffness = bad; }), "p.csv task stiffness");
    EXPECT_EQ(failing([&](auto& s) { s.convergence_deg_per_metre = bad; }), "p.csv convergence degrees per metre");
    EXPECT_EQ(failing([&](auto& s) { s.limits[0].limits.precision = bad; }), "p.csv limits of a: precision");
  }
  EXPECT_EQ(failing([&](auto& s) { s.vacuum_wait = nan; }), "p.csv vacuum wait");
  EXPECT_EQ(failing([&](auto& s) { s.vacuum_wait = -0.1; }), "p.csv vacuum wait");
  EXPECT_EQ(failing([&](auto& s) { s.task_stiffness = 1e6; }), "p.csv task stiffness");
  EXPECT_EQ(failing([&](auto& s) { s.limits[0].prefix = "b"; }), "p.csv row 1 column 7 (name)");
  EXPECT_EQ(where_it_fails([&] { (void)prepare({"p.csv", {}}, settings_of(ExactTracking{})); }), "p.csv ");
  Program bad = program;
  bad.waypoints[0].X_WE.p.x() = nan;
  EXPECT_EQ(where_it_fails([&] { (void)prepare(bad, settings_of(ExactTracking{})); }), "p.csv row 1 a");
}

}  // namespace
}  // namespace snug::motion
