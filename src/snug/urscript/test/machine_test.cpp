// Machine: language, threads and motions against what can be computed by hand.
#include "snug/urscript/machine.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/urscript/test/fake_host.hpp"

namespace snug::urscript {
namespace {

using test::FakeHost;

Machine machine_of(const std::string& body) {
  auto program = parse("def p():\n" + body + "\nend\n");
  if (!program) ADD_FAILURE() << program.error().line << ": " << program.error().text;
  return Machine(program ? std::move(*program) : std::move(*parse("halt\n")));
}
/// The messages of a program that ends.
std::vector<std::string> said(const std::string& body) {
  FakeHost host;
  Machine machine = machine_of(body);
  const Status status = host.run(machine);
  EXPECT_EQ(status.state, MachineState::Ended) << status.error.line << ": " << status.error.text;
  return host.messages;
}
std::string value(const std::string& expression) {
  const std::vector<std::string> messages = said("textmsg(" + expression + ")");
  return messages.empty() ? "" : messages.front();
}

TEST(UrScriptMachine, Expressions) {
  EXPECT_EQ(value("1 + 2 * 3"), "7");
  EXPECT_EQ(value("(1 + 2) * -3"), "-9");
  EXPECT_EQ(value("7 / 2"), "3.5");
  EXPECT_EQ(value("7 % 4"), "3");
  EXPECT_EQ(value("1 < 2 and not 3 <= 2 or False"), "True");
  EXPECT_EQ(value("True xor True"), "False");
  EXPECT_EQ(value("[1, 2] + [3, 4.5]"), "[4, 6.5]");
  EXPECT_EQ(value("2 * [1, 2]"), "[2, 4]");
  EXPECT_EQ(value("[1, [2, 3]][1][0]"), "2");
  EXPECT_EQ(value("str_cat(\"a\", 3)"), "a3");
  EXPECT_EQ(value("0xff"), "255");
  EXPECT_EQ(value("p[1,0,0,0,0,0][0]"), "1");
  EXPECT_EQ(value("norm([3, 4])"), "5");
  EXPECT_EQ(value("pose_trans(p[1,0,0,0,0,d2r(90)], p[1,0,0,0,0,0])"), "p[1, 1, 0, 0, 0, 1.5708]");
  EXPECT_EQ(value("False and 1 / 0 == 1"), "False");
}

TEST(UrScriptMachine, FunctionsScopesAndLoops) {
  const auto messages = said(R"(  global count = 0
  total = 0
  def add(a, b=2, c=10):
    local sum = a + b + c
    total = total + sum
    own = 5
    return sum
  end
  while True:
    count = count + 1
    if count == 2:
      continue
    elif count > 4:
      break
    else:
      add(count)
    end
  end
  textmsg(count)
  textmsg(total)
  textmsg(add(1, c=0))
  list = [1, 2, 3]
  list[1] = 7
  textmsg(list))");
  EXPECT_EQ(messages, (std::vector<std::string>{"5", "44", "3", "[1, 7, 3]"}));
}

TEST(UrScriptMachine, ThreadsRunSideBySide) {
  FakeHost host;
  Machine machine = machine_of(R"(  global beats = 0
  thread beat():
    while True:
      beats = beats + 1
      sync()
    end
  end
  thread short():
    sleep(0.1)
    return 0
  end
  handle = run beat()
  join run short()
  kill handle
  now = beats
  sleep(0.1)
  textmsg(beats - now)
  textmsg(now))");
  const Status status = host.run(machine);
  EXPECT_EQ(status.state, MachineState::Ended) << status.error.text;
  ASSERT_EQ(host.messages.size(), 2U);
  EXPECT_EQ(host.messages[0], "0");
  EXPECT_NEAR(std::stod(host.messages[1]), 0.1 / 0.008, 1.5);
}

TEST(UrScriptMachine, WhoWaitsInACriticalSectionLetsOthersRun) {
  FakeHost host;
  Machine machine = machine_of(R"(  global beats = 0
  thread beat():
    while True:
      enter_critical
      beats = beats + 1
      servoj([0.001 * beats, 0, 0, 0, 0, 0], t=0.008)
      exit_critical
    end
  end
  run beat()
  socket_open("127.0.0.1", 50001)
  n = 0
  while n < 50:
    enter_critical
    params = socket_read_binary_integer(1, timeout=0.008)
    n = n + 1
    exit_critical
  end
  textmsg(beats))");
  EXPECT_EQ(host.run(machine).state, MachineState::Ended) << machine.status().error.text;
  ASSERT_EQ(host.messages.size(), 1U);
  EXPECT_GT(std::stod(host.messages[0]), 40.0);
  EXPECT_GT(host.way.back()[0], 0.03);
}

TEST(UrScriptMachine, WhatHasComeIsReadAtOnce) {
  FakeHost host;
  host.incoming = std::string("\0\0\0\7", 4) + std::string("\0\0\0\1", 4) + std::string(4 * 98, '\0');
  Machine machine = machine_of(R"(  socket_open("127.0.0.1", 50003)
  sum = 0
  n = 0
  while n < 100:
    got = socket_read_binary_integer(1)
    sum = sum + got[1]
    n = n + 1
  end
  textmsg(sum))");
  EXPECT_EQ(host.run(machine).state, MachineState::Ended) << machine.status().error.text;
  ASSERT_EQ(host.messages.size(), 1U);
  EXPECT_EQ(host.messages[0], "8");
  EXPECT_LT(host.way.size(), 5U);  // periods
}

TEST(UrScriptMachine, ACriticalSectionThatDoesNotWaitIsNotInterrupted) {
  FakeHost host;
  MachineLimits limits;
  limits.instructions_per_step = 50;
  Machine machine(*parse(R"(def p():
  global seen = 0
  global inside = False
  thread look():
    while True:
      if inside:
        seen = seen + 1
      end
    end
  end
  run look()
  n = 0
  while n < 20:
    enter_critical
    inside = True
    k = 0
    while k < 100:
      k = k + 1
    end
    inside = False
    exit_critical
    n = n + 1
  end
  textmsg(seen)
end
)"),
                  limits);
  EXPECT_EQ(host.run(machine).state, MachineState::Ended) << machine.status().error.text;
  ASSERT_EQ(host.messages.size(), 1U);
  EXPECT_EQ(host.messages[0], "0");
}

TEST(UrScriptMachine, MovesTakeTheTimeOfATrapezoidWithinTheirSpeed) {
  FakeHost host;
  Machine machine = machine_of("  movej([1, 0.5, 0, 0, 0, 0], a=2, v=0.5)");
  EXPECT_EQ(host.run(machine).state, MachineState::Ended);
  EXPECT_NEAR(host.state_.q[0], 1.0, 1e-12);
  EXPECT_NEAR(host.state_.q[1], 0.5, 1e-12);
  EXPECT_NEAR(static_cast<double>(host.way.size()) * 0.008, 1.0 / 0.5 + 0.5 / 2.0, 0.025);
  EXPECT_LE(host.fastest, 0.5 + 1e-9);
  EXPECT_LE(host.jump, 2.0 + 1e-6);
}

TEST(UrScriptMachine, ForceModeMovesAndTurnsUntilForceAndTorqueAreMet) {
  FakeHost host;
  host.state_.F_Eo_Base = {Vector3(0, 0, 20), Vector3(0, 0, 1)};  // of the surroundings on the tool
  Machine machine = machine_of(
      "  force_mode(p[0, 0, 0, 0, 0, 0], [0, 0, 1, 0, 0, 1], [5, 0, -50, 0, 0, 3], 2, [1, 1, 1, 1, 1, 1])\n  "
      "sleep(0.8)");
  (void)host.run(machine);
  const Joints& q = host.way.back();
  EXPECT_NEAR(q[2], -4e-4 * 30.0 * 0.8, 4e-4 * 30.0 * 0.02);
  EXPECT_NEAR(q[5], 0.02 * 4.0 * 0.8, 0.02 * 4.0 * 0.02);
  for (const std::size_t stiff : {0U, 1U, 3U, 4U}) EXPECT_EQ(q[stiff], 0.0);
  FakeHost met;
  met.state_.F_Eo_Base = {Vector3(0, 0, 50), Vector3(0, 0, -3)};
  Machine rests = machine_of(
      "  force_mode(p[0, 0, 0, 0, 0, 0], [0, 0, 1, 0, 0, 1], [0, 0, -50, 0, 0, 3], 2, [1, 1, 1, 1, 1, 1])\n  "
      "sleep(0.8)");
  (void)met.run(rests);
  for (const double joint : met.way.back()) EXPECT_NEAR(joint, 0.0, 1e-12);
}

TEST(UrScriptMachine, AnArmThatNobodyGuidesStandsInFreedrive) {
  FakeHost host;
  Machine machine = machine_of(
      "  freedrive_mode(freeAxes=[1, 1, 1, 1, 1, 1])\n  sleep(0.1)\n  end_freedrive_mode()\n  q = "
      "get_joint_positions()\n"
      "  textmsg(q[1])");
  host.state_.q[1] = host.state_.target.q[1] = 0.5;
  EXPECT_EQ(host.run(machine).state, MachineState::Ended) << machine.status().error.text;
  for (const Joints& q : host.way) EXPECT_EQ(q[1], 0.5);
  ASSERT_EQ(host.messages.size(), 1U);
  EXPECT_EQ(host.messages[0], "0.5");
}

TEST(UrScriptMachine, LinesAreStraightAndArcsAreRound) {
  FakeHost host;
  Machine machine = machine_of("  movel(p[0.3, 0.4, 0, 0, 0, 0.6], a=1, v=0.25)");
  (void)host.run(machine);
  for (const Joints& q : host.way) {
    EXPECT_NEAR(q[1], q[0] * 4.0 / 3.0, 1e-12);
    EXPECT_NEAR(q[5], 2.0 * q[0], 1e-9);
  }
  FakeHost round;
  Machine arc = machine_of("  movec(p[0.1, 0.1, 0, 0, 0, 0], p[0.2, 0, 0, 0, 0, 0], a=1, v=0.1)");
  EXPECT_EQ(round.run(arc).state, MachineState::Ended);
  for (const Joints& q : round.way) EXPECT_NEAR(std::hypot(q[0] - 0.1, q[1]), 0.1, 1e-10);
  EXPECT_NEAR(round.way.back()[0], 0.2, 1e-10);
  double highest = 0.0;
  for (const Joints& q : round.way) highest = std::max(highest, q[1]);
  EXPECT_NEAR(highest, 0.1, 1e-4);
}

TEST(UrScriptMachine, BlendsGoOnWithoutAJumpAndStayWithinTheirRadius) {
  FakeHost host;
  Machine machine = machine_of(R"(  movel(p[0.5, 0, 0, 0, 0, 0], a=1, v=0.25, r=0.05)
  movel(p[0.5, 0.5, 0, 0, 0, 0], a=1, v=0.25))");
  EXPECT_EQ(host.run(machine).state, MachineState::Ended);
  EXPECT_NEAR(host.way.back()[1], 0.5, 1e-12);
  EXPECT_LE(host.jump, 1.0 + 1e-6);
  double nearest = 1.0;
  for (const Joints& q : host.way) nearest = std::min(nearest, std::hypot(q[0] - 0.5, q[1]));
  EXPECT_GT(nearest, 0.001);
  EXPECT_LT(nearest, 0.05);
}

TEST(UrScriptMachine, ServoFollowsItsTargetsAndStopsBrake) {
  FakeHost host;
  Machine machine = machine_of(R"(  i = 0
  while i < 100:
    i = i + 1
    servoj([0.002 * i, 0, 0, 0, 0, 0], 0, 0, t=get_steptime(), lookahead_time=0.03, gain=2000)
  end
  stopj(2.0))");
  EXPECT_EQ(host.run(machine).state, MachineState::Ended);
  for (std::size_t k = 0; k < 100; ++k) EXPECT_NEAR(host.way[k][0], 0.002 * static_cast<double>(k + 1), 1e-12);
  // 0.25 rad/s, braked at 2 rad/s^2.
  EXPECT_NEAR(host.way.back()[0], 0.2 + 0.25 * 0.25 / 4.0, 2e-3);
}

TEST(UrScriptMachine, SpeedsAreReachedAtTheirAcceleration) {
  FakeHost host;
  Machine machine =
      machine_of("  speedj([0.4, 0, 0, 0, 0, 0], 2.0, 1.0)\n  stopj(2.0)\n  speedl([0, 0, 0.1, 0, 0, 0], 1.0, 0.5)");
  EXPECT_EQ(host.run(machine).state, MachineState::Ended);
  EXPECT_NEAR(host.way.back()[0], 0.4 * 1.0 - 0.5 * 0.4 * 0.2 + 0.4 * 0.4 / 4.0, 0.01);
  EXPECT_NEAR(host.way.back()[2], 0.1 * 0.5 - 0.005, 0.004);
  EXPECT_LE(host.fastest, 0.4 + 1e-9);
}

/// Time of motions passes as the slider lets it: what lasts 1 s then takes as much longer, on the same way.
TEST(UrScriptMachine, TimedCallsTakeAsMuchLongerAsTheSliderIsSlow) {
  for (const double slider : {1.0, 0.5, 0.3, 0.25}) {
    SCOPED_TRACE(slider);
    for (const auto& [body, goal] : {std::pair{"servoj([0.001 * i, 0, 0, 0, 0, 0], t=0.008)", 0.125},
                                     // From rest to 0.25 rad/s in the first of 125 calls.
                                     std::pair{"speedj([0.25, 0, 0, 0, 0, 0], 31.25, 0.008)", 0.25},
                                     std::pair{"speedl([0.25, 0, 0, 0, 0, 0], 31.25, 0.008)", 0.25}}) {
      SCOPED_TRACE(body);
      FakeHost host;
      host.state_.speed_fraction = slider;
      Machine machine = machine_of("  i = 0\n  while i < 125:\n    i = i + 1\n    " + std::string(body) +
                                   "\n  end\n  write_output_float_register(0, get_target_joint_positions()[0])");
      EXPECT_EQ(host.run(machine).state, MachineState::Ended);
      EXPECT_NEAR(host.state_.outputs.floats[0], goal, 0.002);
      EXPECT_NEAR(static_cast<double>(host.way.size()), 125.0 / slider, 0.02 * 125.0 / slider + 3.0);
      EXPECT_LE(host.fastest, 0.25 * slider * 1.4);  // a call of 3.33 periods may take 3
      EXPECT_LE(host.jump, 31.25 * slider + 1e-6);
    }
  }
}

/// A polynomial's speeds, a call for each period, as the maker's client library runs splines: where the slider is slow,
/// the way is the same.
TEST(UrScriptMachine, SpeedsOfAPolynomialLeadAlongItAtAnySlider) {
  for (const double slider : {1.0, 0.4, 0.25}) {
    SCOPED_TRACE(slider);
    FakeHost host;
    host.state_.speed_fraction = slider;
    // q = 0.5 t^2 (3 - 2 t), 0 <= t <= 1
    Machine machine = machine_of(R"(  dt = get_steptime()
  k = 0
  last = 0
  while k < 125:
    k = k + 1
    t = k * dt
    v = 3 * t * (1 - t)
    a = norm(v - last) / dt
    last = v
    write_output_float_register(1, t)
    speedj([v, 0, 0, 0, 0, 0], a, dt)
  end)");
    double off = 0.0;
    for (int i = 0; i < 2000 && machine.status().is_active(); ++i) {
      const double t = host.state_.outputs.floats[1];
      machine.step(host);
      // Somewhere within the call that began at t - dt.
      const double q = host.state_.target.q[0];
      const auto at = [](double u) { return 0.5 * u * u * (3.0 - 2.0 * u); };
      off = std::max(
          {off, at(std::max(0.0, t - 0.012)) - q, q - at(std::min(1.0, host.state_.outputs.floats[1] + 0.004))});
      host.state_.q = host.state_.target.q;
    }
    EXPECT_EQ(machine.status().state, MachineState::Ended);
    EXPECT_NEAR(host.state_.target.q[0], 0.5, 1e-3);
    EXPECT_LT(off, 1e-3);
  }
}

/// To brake takes what it says, whatever the slider says; what follows begins at the speed that there is.
TEST(UrScriptMachine, StopsBrakeAtAnySlider) {
  for (const double slider : {1.0, 0.25}) {
    FakeHost host;
    host.state_.speed_fraction = slider;
    Machine machine = machine_of(R"(  speedj([0.8, 0, 0, 0, 0, 0], 8.0, 0.4)
  write_output_float_register(0, get_target_joint_positions()[0])
  stopj(0.5)
  write_output_float_register(1, get_target_joint_positions()[0])
  speedj([0.08, 0, 0, 0, 0, 0], 1.0, 0.008))");
    EXPECT_EQ(host.run(machine).state, MachineState::Ended);
    const double speed = 0.8 * slider;
    EXPECT_NEAR(host.state_.outputs.floats[1] - host.state_.outputs.floats[0], speed * speed / (2.0 * 0.5), 5e-3);
    EXPECT_LT(host.way.back()[0] - host.state_.outputs.floats[1], 1e-3);
  }
  FakeHost host;  // from servoj on, whose speed is not lost
  Machine machine = machine_of(R"(  i = 0
  while i < 50:
    i = i + 1
    servoj([0.004 * i, 0, 0, 0, 0, 0], t=0.008)
  end
  speedj([0.5, 0, 0, 0, 0, 0], 1.0, 0.2))");
  EXPECT_EQ(host.run(machine).state, MachineState::Ended);
  EXPECT_NEAR(host.way[70][0] - host.way[60][0], 0.04, 1e-9);
}

TEST(UrScriptMachine, OutputsInputsAndRegisters) {
  FakeHost host;
  host.state_.digital_inputs = 1U << 3U;
  host.state_.inputs.integers[5] = 42;
  Machine machine = machine_of(R"(  set_standard_digital_out(2, True)
  digital_out[0] = True
  set_tool_digital_out(1, True)
  textmsg(get_standard_digital_in(3))
  write_output_float_register(7, 1.5)
  textmsg(read_input_integer_register(5))
  set_payload(2.5, [0, 0, 0.1]))");
  EXPECT_EQ(host.run(machine).state, MachineState::Ended);
  EXPECT_EQ(host.state_.digital_outputs, 1U | 4U | (1U << 17U));
  EXPECT_EQ(host.messages, (std::vector<std::string>{"True", "42"}));
  EXPECT_EQ(host.state_.outputs.floats[7], 1.5);
  EXPECT_EQ(host.state_.payload.mass, 2.5);
  EXPECT_EQ(host.state_.payload.com_F.z(), 0.1);
}

TEST(UrScriptMachine, SocketsCarryIntegersAndLines) {
  FakeHost host;
  host.incoming = std::string("\0\0\0\x02\xff\xff\xff\xfe", 8) + "hello\nrest";
  Machine machine = machine_of(R"(  textmsg(socket_open("127.0.0.1", 50001, "reverse"))
  textmsg(socket_read_binary_integer(2, "reverse", 0.5))
  textmsg(socket_read_line("reverse"))
  socket_send_int(-2, "reverse")
  textmsg(socket_read_binary_integer(3, "reverse", 0.1)))");
  EXPECT_EQ(host.run(machine).state, MachineState::Ended);
  EXPECT_EQ(host.messages, (std::vector<std::string>{"True", "[2, 2, -2]", "hello", "[0, 0, 0, 0]"}));
  EXPECT_EQ(host.sent, std::string("\xff\xff\xff\xfe", 4));
}

TEST(UrScriptMachine, MistakesEndTheProgramWithTheirLine) {
  const auto error = [](const std::string& body) {
    FakeHost host;
    Machine machine = machine_of(body);
    const Status status = host.run(machine, 2000);
    EXPECT_EQ(status.state, MachineState::Failed) << body;
    return status.error;
  };
  EXPECT_EQ(error("  x = [1]\n  y = x[1]").line, 3);
  EXPECT_NE(error("  movel(p[9,0,0,0,0,0])").text.find("reach"), std::string::npos);
  EXPECT_NE(error("  x = 1 / 0").text, "");
  EXPECT_NE(error("  movej([9,0,0,0,0,0])").text, "");
  EXPECT_NE(error("  def f(a):\n  return f(a)\n  end\n  f(1)").text, "");
  EXPECT_NE(error("  a = [1]\n  while True:\n    a = [a, a]\n  end").text, "");
  EXPECT_NE(error("  s = \"x\"\n  while True:\n    s = str_cat(s, s)\n  end").text, "");
  EXPECT_NE(error("  thread t():\n    sync()\n    sleep(9)\n  end\n  while True:\n    run t()\n  end").text, "");
  EXPECT_NE(error("  def f(a):\n  return a\n  end\n  f(b=2)").text, "");
}

TEST(UrScriptMachine, ALoopThatNeverWaitsTakesItsShareOfEachPeriodAndNoMore) {
  FakeHost host;
  Machine machine = machine_of("  i = 0\n  while True:\n    i = i + 1\n  end");
  EXPECT_TRUE(host.run(machine, 20).is_active());
  machine.stop();
  EXPECT_EQ(host.run(machine).state, MachineState::Stopped);
}

TEST(UrScriptMachine, NoTargetIsBeyondAJointsSpeedOrRange) {
  for (const std::string body :
       {"  servoj([3,0,0,0,0,0], t=0.008)\n  stopj(10)", "  speedl([50,0,0,0,0,0], a=1000, t=1)",
        "  i = 0\n  while True:\n    i = i + 1\n    servoj([0.02 * i,0,0,0,0,0], t=0.008)\n  end"}) {
    FakeHost host;
    Machine machine = machine_of(body);
    EXPECT_EQ(host.run(machine, 5000).state, MachineState::Failed) << body;
    EXPECT_TRUE(host.state_.wants_protective_stop) << body;
    EXPECT_NE(host.state_.stop_reason.find("joint would be beyond"), std::string::npos) << host.state_.stop_reason;
    EXPECT_LE(host.fastest, 3.0 * (1.0 + 1e-5)) << body;
    for (const Joints& q : host.way) EXPECT_LE(std::abs(q[0]), 6.3 + 1e-5) << body;
  }
}

TEST(UrScriptMachine, AWayOutOfReachStopsTheArmAPoseOutOfReachTheProgram) {
  for (const auto& [body, stops] : {std::pair{"  movel(p[10, 0, 0, 0, 0, 0])", true},
                                    std::pair{"  movec(p[1, 1, 0, 0, 0, 0], p[9, 0, 0, 0, 0, 0])", true},
                                    std::pair{"  movej(p[10, 0, 0, 0, 0, 0])", false}}) {
    FakeHost host;
    Machine machine = machine_of(body);
    EXPECT_EQ(host.run(machine).state, MachineState::Failed) << body;
    EXPECT_EQ(host.state_.wants_protective_stop, stops) << body;
  }
}

TEST(UrScriptMachine, AWatchdogPausesOrStopsWhereItsInputIsNotSet) {
  for (const auto& [action, is_paused] : {std::pair{"", true}, {", \"PAUSE\"", true}, {", \"stop\"", false}}) {
    FakeHost host;
    Machine machine = machine_of("  rtde_set_watchdog(\"input_int_register_0\", 10" + std::string(action) +
                                 ")\n  while True:\n    sync()\n  end");
    for (int i = 0; i < 50; ++i) {
      if (i % 10 == 0) ++host.input_sets;
      (void)host.run(machine, 1);
    }
    EXPECT_TRUE(machine.status().is_active() && !machine.is_paused()) << "set each 80 ms";
    for (int i = 0; i < 20; ++i) (void)host.run(machine, 1);
    EXPECT_EQ(machine.is_paused(), is_paused) << action;
    EXPECT_EQ(machine.status().state, is_paused ? MachineState::Running : MachineState::Stopped) << action;
    if (!is_paused) continue;
    machine.resume();
    (void)host.run(machine, 10);
    EXPECT_FALSE(machine.is_paused()) << "it has the whole time again";
  }
  (void)said(
      "  rtde_set_watchdog(\"input_int_register_0\", 100)\n  rtde_set_watchdog(\"input_int_register_0\", 0)\n"
      "  sleep(0.1)");
  (void)said("  rtde_set_watchdog(\"input_int_register_0\", 100, \"IGNORE\")\n  sleep(0.1)");
  for (const char* bad : {"\"x\", 1", "\"input_int_register_0\", -1", "\"input_int_register_0\", 1, \"jump\""}) {
    FakeHost host;
    Machine machine = machine_of("  rtde_set_watchdog(" + std::string(bad) + ")");
    EXPECT_EQ(host.run(machine).state, MachineState::Failed) << bad;
  }
}

TEST(UrScriptMachine, AfterAProtectiveStopTheMoveGoesOnBeforeTheNextStatement) {
  FakeHost host;
  Machine machine = machine_of("  movej([1, 0, 0, 0, 0, 0], a=2, v=0.5)\n  set_digital_out(0, True)");
  (void)host.run(machine, 80);
  host.state_.is_protectively_stopped = true;
  host.state_.target.q[0] -= 0.01;  // where the arm came to stand
  host.state_.target.qd = {};
  (void)host.run(machine, 50);
  const double stood = host.state_.q[0];
  EXPECT_LT(stood, 0.5);
  EXPECT_EQ(host.state_.digital_outputs, 0U);
  host.jump = 0.0;
  host.state_.is_protectively_stopped = false;
  EXPECT_EQ(host.run(machine).state, MachineState::Ended);
  EXPECT_NEAR(host.state_.q[0], 1.0, 1e-9);
  EXPECT_EQ(host.state_.digital_outputs, 1U);
  EXPECT_LE(host.jump, 10.0);
}

TEST(UrScriptMachine, AStoppedProgramBrakesAPausedOneGoesOn) {
  FakeHost host;
  Machine machine = machine_of("  movej([1, 0, 0, 0, 0, 0], a=2, v=0.5)");
  (void)host.run(machine, 80);
  machine.pause();
  (void)host.run(machine, 60);
  const double stood = host.state_.q[0];
  (void)host.run(machine, 20);
  EXPECT_EQ(host.state_.q[0], stood);
  EXPECT_LT(stood, 0.5);
  machine.resume();
  EXPECT_EQ(host.run(machine).state, MachineState::Ended);
  EXPECT_NEAR(host.state_.q[0], 1.0, 1e-12);

  FakeHost other;
  Machine stopped = machine_of("  movej([1, 0, 0, 0, 0, 0], a=2, v=0.5)");
  (void)other.run(stopped, 80);
  stopped.stop();
  EXPECT_EQ(other.run(stopped).state, MachineState::Stopped);
  EXPECT_NEAR(other.state_.target.qd[0], 0.0, 1e-9);
  EXPECT_LT(other.state_.q[0], 0.6);
}

}  // namespace
}  // namespace snug::urscript
