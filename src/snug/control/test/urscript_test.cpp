// URScript: what the controller of a UR is given, read back by a few lines that know only the format.
#include "snug/control/urscript.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <sstream>

#include "exported.hpp"
#include "snug/control/joint_knots.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::control {
namespace {

using test::Exported;

UrScriptOptions wired_elsewhere() {
  UrScriptOptions options;
  options.io.vacuum.number = 3;
  options.io.blow_off->number = 4;
  options.io.vacuum_reached->number = 5;
  return options;
}

/// How often the part stands in the text.
std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

// What a script does when it runs: tests/urscript_test.py.
TEST(UrScript, MovesTheToolInTheControllersBaseFrame) {
  const Exported exported;
  const UrScript script = format_urscript(exported.for_robot(), wired_elsewhere());
  const std::string& text = script.text;
  // W is the controller's base in this cell, so that the waypoint's own numbers appear.
  const Vector3 p = exported.plan.program.waypoints[1].X_WE.p;
  char expected[80];
  std::snprintf(expected, sizeof expected, "movel(p[%.6f, %.6f, %.6f,", p.x(), p.y(), p.z());
  EXPECT_NE(text.find(expected), std::string::npos) << text;
  EXPECT_NE(text.find("a=4.00000, v=0.60000"), std::string::npos);                     // Box
  EXPECT_NE(text.find("set_tcp(p[0.000000, 0.000000, 0.335000,"), std::string::npos);  // 35 mm sensor, 300 mm rod
  const std::size_t on = text.find("set_standard_digital_out(3, True)");
  ASSERT_NE(on, std::string::npos);
  EXPECT_LT(text.find("# 3 PostPick013"), on);  // acts before the motion to its row, then waits
  const std::size_t wait = text.find("snug_wait_for_vacuum(True");
  EXPECT_LT(on, wait);
  EXPECT_LT(wait, text.find("movel(", on));
  EXPECT_EQ(script.moves, 4);
}

TEST(UrScript, CapsBlendsByTheMovesOnBothSides) {
  // Rows that may be passed at 0.05 m, 0.2 to 120 mm apart, in random directions.
  Rng rng = Rng(5).split("blends");
  motion::Program program{"test", {}};
  Pose X_WE = test::demonstrator().controller.X_WE_start;
  for (int i = 0; i < 300; ++i) {
    const Vector3 way(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    if (i % 7 != 3) X_WE.p += way.normalized() * std::pow(10.0, rng.uniform(-3.7, -0.92));  // else no way at all
    program.waypoints.push_back(motion::named_waypoint("PostPick013", X_WE));
  }
  const JointController controller = test::make_controller();
  const motion::PreparedProgram plan = motion::prepare(program, test::program_settings(motion::LaggedTracking{}));
  const UrScript script = format_urscript({plan, controller.arm(), test::start_joints(controller),
                                           std::vector<std::optional<CarriedLoad>>(program.waypoints.size())},
                                          {});
  std::istringstream lines(script.text);
  Vector3 before = test::demonstrator().controller.X_WE_start.p;
  double blend_before = 0.0;
  int moves = 0, blends = 0;
  for (std::string line; std::getline(lines, line);) {
    Vector3 p;
    if (std::sscanf(line.c_str(), "  movel(p[%lf, %lf, %lf,", &p.x(), &p.y(), &p.z()) != 3) continue;
    const std::size_t at = line.find(", r=");
    const double blend = at == std::string::npos ? 0.0 : std::stod(line.substr(at + 4));
    const double length = (p - before).norm();
    EXPECT_GT(length, 1e-4) << line;
    EXPECT_LT(blend + blend_before, length) << line;
    EXPECT_LE(blend, 0.05);
    before = p;
    blend_before = blend;
    ++moves;
    blends += blend > 0.0 ? 1 : 0;
  }
  EXPECT_EQ(blend_before, 0.0) << "the last move ends in a stop";
  EXPECT_EQ(moves, script.moves);
  EXPECT_EQ(moves, 300 - 43);
  EXPECT_GT(blends, 60);  // of 257 moves, 0.2 to 120 mm: two of five have both neighbours long enough
}

TEST(UrScript, TellsTheControllerWhatTheGripperCarries) {
  Exported exported;
  RobotProgram program = exported.for_robot();
  program.loads[2] = program.loads[3] = CarriedLoad{2.0, Vector3(0.01, 0.0, 0.1)};
  const std::string text = format_urscript(program, {}).text;
  const SpatialInertia gripper = robot::distal_inertia(program.arm, robot::find_link(program.arm, "tool0"));
  char expected[80];
  std::snprintf(expected, sizeof expected, "set_payload(%.4f, [", gripper.mass);
  EXPECT_LT(text.find(expected), text.find("movel("));
  std::snprintf(expected, sizeof expected, "set_payload(%.4f, [", gripper.mass + 2.0);
  const std::size_t at = text.find(expected);
  ASSERT_NE(at, std::string::npos) << text;
  Vector3 com;
  ASSERT_EQ(std::sscanf(text.c_str() + at + std::strlen(expected), "%lf, %lf, %lf", &com.x(), &com.y(), &com.z()), 3);
  // E is turned by half a turn about z against tool0, 335 mm before it.
  const Vector3 moment = gripper.mass * gripper.com + 2.0 * Vector3(-0.01, 0.0, 0.335 + 0.1);
  EXPECT_LT((com - moment / (gripper.mass + 2.0)).norm(), 2e-5);
}

TEST(UrScript, SwitchesAndReadsAsTheCellIsWired) {
  const Exported exported;
  UrScriptOptions options;
  options.io.vacuum = {model::DigitalKind::Tool, 1, true};
  options.io.blow_off = std::nullopt;
  options.io.vacuum_reached = model::DigitalIo{model::DigitalKind::Configurable, 2, true};
  options.io.part_present = model::DigitalIo{model::DigitalKind::Standard, 6, false};
  options.io.vacuum_gauge = model::GaugeIo{model::AnalogKind::Standard, 1, 5.0, 1.0, -1e5};
  const std::string text = format_urscript(exported.for_robot(), options).text;
  EXPECT_LT(text.find("set_tool_digital_out(1, True)"), text.find("movej(")) << "low is on: off at first";
  EXPECT_NE(text.find("set_tool_digital_out(1, False)\n  snug_wait_for_vacuum(True"), std::string::npos) << text;
  EXPECT_EQ(count_of(text, "_digital_out("), 2U) << "no blow-off is wired";
  EXPECT_NE(text.find("while (get_configurable_digital_in(2) == False) != is_wanted:"), std::string::npos);
  EXPECT_NE(text.find("while get_standard_analog_in(1) < 4.92:"), std::string::npos) << "2 kPa of 100 on 4 V down";
  EXPECT_NE(text.find("while get_standard_digital_in(6) == False:"), std::string::npos);
  const std::size_t wait = text.find("  snug_wait_for_part(\"Box013\")\n  movel(");
  EXPECT_NE(wait, std::string::npos) << "right before the tool goes down to the box";
  options.io.part_present = std::nullopt;
  options.io.vacuum_reached = std::nullopt;
  const std::string bare = format_urscript(exported.for_robot(), options).text;
  EXPECT_EQ(count_of(bare, "snug_wait_for_part"), 0U);
  EXPECT_NE(bare.find("while (get_standard_analog_in(1) < 3.8) != is_wanted:"), std::string::npos) << bare;
  options.io.vacuum_gauge = std::nullopt;
  EXPECT_THROW((void)format_urscript(exported.for_robot(), options), InputError);
}

TEST(UrScript, TellsTheInertiaOfGripperAndBoxWhereItIsAskedTo) {
  Exported exported;
  RobotProgram program = exported.for_robot();
  const Matrix3 inertia = Vector3(0.01, 0.02, 0.03).asDiagonal();
  program.loads[2] = program.loads[3] = CarriedLoad{2.0, Vector3(0.0, 0.0, 0.1), inertia};
  UrScriptOptions options;
  options.has_inertia = true;
  const std::string text = format_urscript(program, options).text;
  const std::size_t at = text.rfind("set_target_payload(");
  ASSERT_NE(at, std::string::npos) << text;
  double mass = 0.0, i[6], over = 0.0;
  Vector3 com;
  ASSERT_EQ(
      std::sscanf(text.c_str() + at, "set_target_payload(%lf, [%lf, %lf, %lf], [%lf, %lf, %lf, %lf, %lf, %lf], %lf)",
                  &mass, &com.x(), &com.y(), &com.z(), &i[0], &i[1], &i[2], &i[3], &i[4], &i[5], &over),
      11);
  // Two bodies, the box 0.435 m before tool0, turned by half a turn about z: moments about x and y grow with the
  // distances to the common centre.
  const SpatialInertia gripper = robot::distal_inertia(program.arm, robot::find_link(program.arm, "tool0"));
  const double reduced = gripper.mass * 2.0 / (gripper.mass + 2.0);
  const Vector3 r = Vector3(0.0, 0.0, 0.435) - gripper.com;
  EXPECT_NEAR(i[0], gripper.inertia(0, 0) + 0.01 + reduced * (r.y() * r.y() + r.z() * r.z()), 2e-6);
  EXPECT_NEAR(i[1], gripper.inertia(1, 1) + 0.02 + reduced * (r.x() * r.x() + r.z() * r.z()), 2e-6);
  EXPECT_NEAR(i[2], gripper.inertia(2, 2) + 0.03 + reduced * (r.x() * r.x() + r.y() * r.y()), 2e-6);
  EXPECT_NEAR(over, 0.1, 1e-9);
}

TEST(UrScript, ADryRunSwitchesNothingAndStaysAboveEveryRow) {
  const Exported exported;
  UrScriptOptions options;
  options.is_dry = true;
  const UrScript dry = format_urscript(exported.for_robot(), options), wet = format_urscript(exported.for_robot(), {});
  EXPECT_EQ(count_of(dry.text, "_digital_out("), 2U) << "both off at first";
  EXPECT_EQ(count_of(dry.text, "snug_wait"), 0U);
  const Vector3 p = exported.plan.program.waypoints[1].X_WE.p;
  char expected[80];
  std::snprintf(expected, sizeof expected, "movel(p[%.6f, %.6f, %.6f,", p.x(), p.y(), p.z() + 0.02);
  EXPECT_NE(dry.text.find(expected), std::string::npos) << dry.text;
  EXPECT_NE(dry.text.find("a=0.25000, v=0.15000"), std::string::npos) << "Box: 4 and 0.6";
  EXPECT_EQ(dry.moves, wet.moves);
}

TEST(UrScript, BeginsWithARowThatIsAskedFor) {
  const Exported exported;
  UrScriptOptions options;
  options.first_row = 2;
  const UrScript script = format_urscript(exported.for_robot(), options);
  EXPECT_EQ(script.text.find("# 1 PrePick013"), std::string::npos);
  EXPECT_NE(script.text.find("# 3 PostPick013"), std::string::npos);
}

TEST(UrScript, IsRefusedForAnArmThatIsNoUr) {
  const Exported exported;
  const auto expect_refused = [&](const robot::ArmModel& arm, const std::string& part) {
    RobotProgram program{exported.plan, arm, test::start_joints(exported.controller), exported.for_robot().loads};
    try {
      (void)format_urscript(program, {});
      ADD_FAILURE() << "accepted; expected a complaint with '" << part << "'";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find("ros-trajectory"), std::string::npos) << error.what();
    }
  };
  robot::ArmModel arm = exported.controller.arm();
  arm.links[static_cast<std::size_t>(robot::find_link(arm, "tool0"))].name = "other";
  expect_refused(arm, "tool0");
  arm = exported.controller.arm();
  arm.joints[3].name = "joint_a4";
  expect_refused(arm, "wrist_1_joint");
  arm = exported.controller.arm();
  arm.joints[4].X_SJ.R = exp_rotation(Vector3(0.3, 0.0, 0.0)) * arm.joints[4].X_SJ.R;
  expect_refused(arm, "axes");
  arm = exported.controller.arm();
  arm.joints.pop_back();
  expect_refused(arm, "5 joints");
}

/// A line of a script that follows joints.
struct Followed {
  TimedJoints to;      ///< time: since the script began, without what it waits
  double begin = 0.0;  ///< s
  std::size_t at = 0;  ///< where it stands in the text
  bool rests = false;
};

std::vector<double> numbers_of(const std::string& line) {
  std::vector<double> numbers;
  for (std::size_t i = line.find('['); i < line.size(); ++i) {
    if (std::strchr("0123456789-", line[i]) == nullptr) continue;
    std::size_t length = 0;
    numbers.push_back(std::stod(line.substr(i), &length));
    i += length;
  }
  return numbers;
}

std::vector<Followed> followed_of(const std::string& text) {
  std::vector<Followed> lines;
  double time = 0.0;
  std::size_t at = text.find("movej(");
  while (at < text.size()) {
    const std::size_t end = text.find('\n', at);
    const std::string line = text.substr(at, end - at);
    const bool rests = line.find("snug_rest(") != std::string::npos;
    if (rests || line.find("snug_follow(") != std::string::npos) {
      const std::vector<double> numbers = numbers_of(line);
      EXPECT_EQ(numbers.size(), rests ? 6U : 13U) << line;
      Followed followed{{0.0, robot::JointVector::Zero(6), robot::JointVector::Zero(6)}, time, at, rests};
      for (Eigen::Index j = 0; j < 6; ++j) {
        followed.to.q[j] = numbers[static_cast<std::size_t>(j)];
        if (!rests) followed.to.qd[j] = numbers[static_cast<std::size_t>(j) + 6];
      }
      if (!rests) time += numbers[12];
      followed.to.time = time;
      lines.push_back(followed);
    }
    at = end + 1;
  }
  return lines;
}

UrServoScript servo_script(const Exported& exported) {
  return format_servo_urscript(exported.run, exported.for_robot(), {});
}

/// The first joint gains speed for 50 samples, brakes for 50, and stands for 10. `row_of(sample)`.
template <class RowOf>
JointRun run_of(const RobotProgram& program, RowOf row_of, double acceleration = 2.0) {
  JointRun run;
  run.is_complete = true;
  JointState joints;
  joints.q = program.q_start;
  joints.qd = joints.qdd = robot::JointVector::Zero(6);
  for (int i = 0; i < 110; ++i) {
    JointSample sample;
    sample.time = 0.008 * i;
    sample.before = joints;
    const double qdd = i < 50 ? acceleration : i < 100 ? -acceleration : 0.0;
    joints.q[0] += 0.008 * joints.qd[0] + 0.5 * 0.008 * 0.008 * qdd;
    joints.qd[0] += 0.008 * qdd;
    sample.after = joints;
    sample.row = row_of(i);
    sample.io = program.plan.program.waypoints[static_cast<std::size_t>(sample.row)].io;
    run.samples.push_back(sample);
  }
  return run;
}

TEST(ServoUrScript, PassesEverySampleOfTheMotion) {
  const Exported exported{motion::FastTracking{}};
  ASSERT_TRUE(exported.run.is_complete);
  const UrServoScript script = servo_script(exported);
  const std::vector<Followed> lines = followed_of(script.text);
  const std::vector<JointSample>& samples = exported.run.samples;
  // From the start to the pick, where the vacuum comes on: as long as it takes in the run.
  TimedJoints from{0.0, samples[0].before.q, samples[0].before.qd};
  std::size_t i = 0;
  for (const Followed& line : lines) {
    if (line.rests) break;
    for (; samples[i].time <= line.to.time + 1e-9; ++i) {
      const robot::JointVector error = interpolate(from, line.to, samples[i].time) - samples[i].before.q;
      EXPECT_LT(error.cwiseAbs().maxCoeff(), 1.6e-5) << samples[i].time;  // kKnotTolerance and what printing rounds
    }
    from = line.to;
  }
  EXPECT_FALSE(samples[i - 2].io.vacuum);
  EXPECT_TRUE(samples[i].io.vacuum);
  EXPECT_EQ(script.knots, lines.size() - 2);  // rests: at the pick, and at the end
  EXPECT_LT(script.knots, samples.size() / 5);
  EXPECT_NEAR(lines.back().to.q[0], samples.back().after.q[0], 1e-7);
}

TEST(ServoUrScript, StandsWhereTheVacuumChangesAndDoesNotWaitTwice) {
  const Exported exported{motion::FastTracking{}};
  const std::string text = servo_script(exported).text;
  const std::size_t row = text.find("# 3 PostPick013");
  const std::size_t rest = text.find("snug_rest(", row);
  const std::size_t output = text.find("set_standard_digital_out(0, True)", row);
  const std::size_t wait = text.find("snug_wait_for_vacuum(True, \"PostPick013\")", row);
  const std::size_t payload = text.find("set_payload(", row);
  ASSERT_NE(payload, std::string::npos) << text;
  EXPECT_LT(rest, output);
  EXPECT_LT(output, wait);
  EXPECT_LT(wait, payload);
  EXPECT_LT(payload, text.find("snug_follow(", row));
  const std::vector<Followed> lines = followed_of(text);
  const double waited = exported.run.samples.back().time + 0.008 - lines.back().to.time;
  EXPECT_NEAR(waited, exported.plan.settings.vacuum_wait, 0.03);  // and the ticks in which the joints hardly move yet
}

TEST(ServoUrScript, HasAKnotWhereEachRowEnds) {
  const Exported exported{motion::FastTracking{}};
  const std::string text = servo_script(exported).text;
  const std::vector<Followed> lines = followed_of(text);
  for (std::size_t i = 1; i < exported.run.samples.size(); ++i) {
    const JointSample& sample = exported.run.samples[i];
    if (sample.row == exported.run.samples[i - 1].row) continue;
    const std::size_t name = text.find("  # " + std::to_string(sample.row + 1) + " ");
    ASSERT_NE(name, std::string::npos);
    const auto last = std::find_if(lines.rbegin(), lines.rend(), [&](const Followed& line) { return line.at < name; });
    ASSERT_NE(last, lines.rend());
    EXPECT_LT((last->to.q - sample.before.q).cwiseAbs().maxCoeff(), 1e-6) << sample.row;
  }
}

TEST(ServoUrScript, DoesNotStopForAnOutputThatChangesOnTheWay) {
  Exported exported;
  const RobotProgram program = exported.for_robot();
  const JointRun run = run_of(program, [](int i) { return i < 40 ? 1 : 2; });  // the vacuum comes on at 0.64 rad/s
  const std::string text = format_servo_urscript(run, program, {}).text;
  const std::vector<Followed> lines = followed_of(text);
  EXPECT_EQ(std::count_if(lines.begin(), lines.end(), [](const Followed& line) { return line.rests; }), 1);
  EXPECT_TRUE(lines.back().rests);
  EXPECT_EQ(text.find("snug_wait_for_vacuum(True"), std::string::npos);
  const std::size_t output = text.find("set_standard_digital_out(0, True)");
  const std::size_t payload = text.find("set_payload(", output);
  ASSERT_NE(payload, std::string::npos);
  const auto next = std::find_if(lines.begin(), lines.end(), [&](const Followed& line) { return line.at > output; });
  EXPECT_LT(payload, next->at);
  EXPECT_NEAR(next->begin, 40 * 0.008, 1e-9);
}

TEST(ServoUrScript, SwitchesAtRestWhenTheJointsBrakeForIt) {
  Exported exported;
  const RobotProgram program = exported.for_robot();
  const JointRun run = run_of(program, [](int i) { return i < 50 ? 1 : 2; });  // the vacuum comes on at 0.8 rad/s
  const std::string text = format_servo_urscript(run, program, {}).text;
  const std::size_t output = text.find("set_standard_digital_out(0, True)");
  EXPECT_NE(text.find("snug_wait_for_vacuum(True", output), std::string::npos) << text;
  const std::vector<Followed> lines = followed_of(text);
  const auto rest = std::find_if(lines.begin(), lines.end(), [](const Followed& line) { return line.rests; });
  EXPECT_LT(rest->at, output);
  EXPECT_NEAR(rest->to.time, 0.8, 1e-9);
}

TEST(ServoUrScript, WaitsForItsFirstBoxBeforeItMoves) {
  const Exported exported{motion::FastTracking{}};
  const std::string text = servo_script(exported).text;
  const std::size_t wait = text.find("  snug_wait_for_part(\"Box013\")");
  ASSERT_NE(wait, std::string::npos) << text;
  EXPECT_LT(text.find("movej("), wait);
  EXPECT_LT(wait, text.find("  snug_follow([", wait));
  EXPECT_EQ(count_of(text, "snug_wait_for_part("), 2U) << "with its definition";
}

TEST(ServoUrScript, ARunThatIsBegunOnTheWayComesUpToItsSpeed) {
  Exported exported;
  const RobotProgram program = exported.for_robot();
  const JointRun run = run_of(program, [](int) { return 1; });
  const JointRun begun = begin_at(run, 20, 15, 0.008);
  ASSERT_EQ(begun.samples.size(), run.samples.size() - 20 - 15 + 30);
  EXPECT_EQ(begun.samples.front().before.q, run.samples[20].before.q);
  EXPECT_EQ(begun.samples.front().before.qd.norm(), 0.0);
  for (std::size_t i = 0; i + 1 < begun.samples.size(); ++i) {
    const JointSample &one = begun.samples[i], &next = begun.samples[i + 1];
    EXPECT_NEAR(one.time, 0.008 * static_cast<double>(i), 1e-12);
    EXPECT_LT((one.after.q - next.before.q).norm(), 1e-12);
    EXPECT_LT((one.after.qd - next.before.qd).norm(), 1e-9) << i;
    // The run's own acceleration, and its speed at the end of the ramp, 0.56 rad/s, over the 0.24 s that it takes.
    // Positions are those that the speeds lead to.
    const robot::JointVector mean = 0.5 * (one.before.qd + next.before.qd);
    EXPECT_LT((next.before.q - one.before.q - 0.008 * mean).norm(), 2e-5) << i;
    EXPECT_LT(((next.before.qd - one.before.qd) / 0.008).cwiseAbs().maxCoeff(), 2.0 + 0.56 / 0.24) << i;
  }
  const std::string text = format_servo_urscript(begun, program, {}).text;
  EXPECT_EQ(count_of(text, "movej("), 2U) << "to the start, then to where it begins";
}

TEST(ServoUrScript, OfAnArmThatStandsHasOneKnot) {
  Exported exported;
  const RobotProgram program = exported.for_robot();
  const UrServoScript script = format_servo_urscript(run_of(
                                                         program, [](int) { return 0; }, 0.0),
                                                     program, {});
  EXPECT_EQ(script.knots, 1U);
  EXPECT_NEAR(script.followed_duration, 0.88 + 0.12, 1e-9);
}

TEST(ServoUrScript, OfNoSamplesGoesToTheStartOnly) {
  Exported exported;
  const UrServoScript script = format_servo_urscript({}, exported.for_robot(), {});
  EXPECT_EQ(script.knots, 0U);
  EXPECT_TRUE(followed_of(script.text).empty());
}

TEST(ServoUrScript, IsRefusedForJointsThatAreNotFinite) {
  Exported exported;
  exported.run.samples[3].before.q[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)servo_script(exported), InputError);
}

}  // namespace
}  // namespace snug::control
