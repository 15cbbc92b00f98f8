// Controller: modes, safety, outputs and what is told of the cell, a period after the other.
#include "snug/served_ur/controller.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "cell.hpp"
#include "snug/core/temporary_folder.hpp"
#include "snug/served_ur/dashboard.hpp"
#include "snug/ur/rtde.hpp"

namespace snug::served_ur {
namespace {

using test::demonstrator_cell;

std::string ask(Controller& controller, std::string_view line) { return answer_dashboard(line, controller).line; }

void step(Controller& controller, int periods) {
  for (int i = 0; i < periods; ++i) controller.step();
}

TEST(Controller, StartsReadyAndGoesThroughItsModes) {
  Controller controller(demonstrator_cell(), {});
  EXPECT_EQ(ask(controller, "robotmode"), "Robotmode: RUNNING");
  EXPECT_EQ(ask(controller, "power off"), "Powering off");
  controller.step();
  EXPECT_EQ(ask(controller, "robotmode"), "Robotmode: POWER_OFF");
  step(controller, 200);
  EXPECT_EQ(ask(controller, "robotmode"), "Robotmode: POWER_OFF");
  EXPECT_EQ(ask(controller, "power on"), "Powering on");
  controller.step();
  EXPECT_EQ(ask(controller, "robotmode"), "Robotmode: POWER_ON");
  step(controller, 200);
  EXPECT_EQ(ask(controller, "robotmode"), "Robotmode: IDLE");
  EXPECT_EQ(ask(controller, "brake release"), "Brake releasing");
  controller.step();
  EXPECT_EQ(ask(controller, "robotmode"), "Robotmode: IDLE");
  step(controller, 200);
  EXPECT_EQ(ask(controller, "robotmode"), "Robotmode: RUNNING");
  EXPECT_EQ(ask(controller, "safetystatus"), "Safetystatus: NORMAL");
}

TEST(Controller, ReleasesBrakesOfARobotWithoutPower) {
  Controller controller(demonstrator_cell(), {});
  controller.power_off();
  controller.release_brakes();
  step(controller, 200);
  EXPECT_EQ(controller.data().robot_mode, ur::RobotMode::Running);
}

TEST(Controller, TellsThePoseOfTheToolInTheControllersBase) {
  const cell::Simulation& simulation = demonstrator_cell();
  Controller controller(simulation, {});
  controller.step();
  // W is the base of this scenario, and the first TCP is the tool's end.
  const Pose X_WE = simulation.make_state().arm->machine.tool.X_WE;
  const Pose told = to_pose(controller.data().actual_tcp_pose);
  EXPECT_LT((told.p - X_WE.p).norm(), 1e-9);
  EXPECT_LT(angle_between(told.R, X_WE.R), 1e-9);
}

TEST(Controller, InverseFindsTheJointsOfItsForward) {
  const UrArm arm(demonstrator_cell());
  const ur::Values6 q = {-3.0, -1.4, -1.7, -1.5, 1.6, 1.2};
  const auto found = arm.inverse(arm.forward(q), q);
  ASSERT_TRUE(found);
  for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR((*found)[j], q[j], 1e-8);
  EXPECT_FALSE(arm.inverse({Matrix3::Identity(), Vector3(3.0, 0.0, 0.0)}, q));
}

TEST(Controller, SpeedOfTheTcpIsThatOfItsPose) {
  const UrArm arm(demonstrator_cell());
  const ur::Values6 q = {-3.0, -1.4, -1.7, -1.5, 1.6, 1.2}, qd = {0.3, -0.2, 0.5, 0.1, -0.4, 0.7};
  const Pose X_FT{exp_rotation(Vector3(0.1, 0.2, 0.3)), Vector3(0.02, -0.03, 0.25)};
  constexpr double kStep = 1e-6;
  ur::Values6 before = q, after = q;
  for (std::size_t j = 0; j < 6; ++j) {
    before[j] -= kStep * qd[j];
    after[j] += kStep * qd[j];
  }
  const Pose a = arm.forward(before) * X_FT, b = arm.forward(after) * X_FT;
  const Vector3 v = (b.p - a.p) / (2.0 * kStep), w = log_rotation(b.R * a.R.transpose()) / (2.0 * kStep);
  const ur::Values6 speed = arm.tcp_speed(q, qd, X_FT);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(speed[static_cast<std::size_t>(i)], v[i], 1e-6);  // central differences of 1e-6 s: 1e-9 of rounding
    EXPECT_NEAR(speed[static_cast<std::size_t>(i) + 3], w[i], 1e-6);
  }
}

TEST(Controller, OutputsSwitchTheCupAndBeginTheRun) {
  int begun = 0, ended = 0;
  ControllerSettings settings;
  settings.begin_run = [&](int) {
    ++begun;
    return runs::OutsideRunOptions{};
  };
  settings.end_run = [&](int, const runs::RunResult&) { ++ended; };
  Controller controller(demonstrator_cell(), std::move(settings));
  step(controller, 10);
  EXPECT_EQ(begun, 0);
  controller.inputs().standard_mask = 0x81;
  controller.inputs().standard = 0xff;
  controller.step();
  EXPECT_EQ(begun, 1);
  EXPECT_EQ(controller.data().digital_outputs, 0x81u);
  EXPECT_EQ(controller.inputs().standard_mask, 0);  // used up
  step(controller, 5);
  EXPECT_EQ(controller.data().digital_inputs, 2u);  // the first box has come to the aligner; no vacuum in free air
  controller.end("enough");
  EXPECT_EQ(ended, 1);
}

TEST(Controller, WithoutALoadTheForceIsZeroAndAWrongPayloadShows) {
  Controller controller(demonstrator_cell(), {});
  controller.step();
  for (const double value : controller.data().actual_tcp_force) EXPECT_NEAR(value, 0.0, 1e-9);
}

std::string messages_of(Controller& controller) {
  std::string all;
  for (const std::string& message : controller.take_messages()) all += message;
  return all;
}

TEST(Controller, RunsAProgramThatMovesTheArmAndSaysSo) {
  Controller controller(demonstrator_cell(), {});
  const ur::Values6 start = controller.data().actual_q;
  controller.run_program(
      "def lift():\n  q = get_actual_joint_positions()\n  q[0] = q[0] + 0.1\n  movej(q, a=1.4, v=1.05)\n"
      "  set_standard_digital_out(2, True)\n  write_output_integer_register(3, 7)\nend\n");
  controller.step();
  EXPECT_NE(messages_of(controller).find("PROGRAM_XXX_STARTEDlift"), std::string::npos);
  EXPECT_EQ(ask(controller, "programState"), "PLAYING lift");
  for (int i = 0; i < 500 && controller.data().is_program_running(); ++i) controller.step();
  EXPECT_NE(messages_of(controller).find("PROGRAM_XXX_STOPPEDlift"), std::string::npos);
  EXPECT_EQ(ask(controller, "running"), "Program running: false");
  EXPECT_NEAR(controller.data().actual_q[0], start[0] + 0.1, 1e-6);
  for (std::size_t j = 1; j < 6; ++j) EXPECT_NEAR(controller.data().actual_q[j], start[j], 1e-6);
  EXPECT_EQ(controller.data().digital_outputs, 4u);
  EXPECT_EQ(controller.data().outputs.ints[3], 7);
}

TEST(Controller, SecondaryProgramsSwitchOutputsWhileAnotherRuns) {
  Controller controller(demonstrator_cell(), {});
  controller.run_program("def wait():\n  sleep(1)\nend\n");
  step(controller, 5);
  controller.run_program("sec out():\n  set_standard_digital_out(3, True)\nend\n");
  step(controller, 3);
  EXPECT_EQ(controller.data().digital_outputs, 8u);
  EXPECT_EQ(ask(controller, "programState"), "PLAYING wait");
  EXPECT_TRUE(controller.obey("stop program"));
  step(controller, 3);
  EXPECT_FALSE(controller.data().is_program_running());
}

TEST(Controller, SaysWhatIsWrongWithAProgram) {
  Controller controller(demonstrator_cell(), {});
  controller.run_program("def bad():\n  x = = 1\nend\n");
  controller.step();
  const std::string message = messages_of(controller);
  ASSERT_GE(message.size(), 24u);
  EXPECT_EQ(message[14], 10);  // a runtime exception
  EXPECT_EQ(message[18], 2);   // in this line
  controller.run_program("def bad():\n  calldoesntexist()\nend\n");
  controller.step();
  EXPECT_NE(messages_of(controller).find("compile_error_name_not_found:calldoesntexist:"), std::string::npos)
      << "clients compare these words";
  EXPECT_FALSE(controller.data().is_program_running());
}

TEST(Controller, LoadsProgramsOfItsFolderAndPlaysThem) {
  const TemporaryFolder own("controller-programs");
  const std::filesystem::path folder = own.path() / "programs";
  std::filesystem::create_directory(folder);
  std::ofstream(folder / "wait_program.script") << "def p():\n  while True:\n    sleep(0.1)\n  end\nend\n";
  std::ofstream(folder / "bad.script") << "def p(\n";
  std::ofstream(folder.parent_path() / "outside.script") << "def p():\n  sync()\nend\n";
  ControllerSettings settings;
  settings.programs = folder.string();
  Controller controller(demonstrator_cell(), settings);
  EXPECT_EQ(ask(controller, "play"), "Failed to execute: play");
  EXPECT_EQ(ask(controller, "get loaded program"), "No program loaded");
  for (const std::string file : {"../outside.urp", "..", "", ".urp", "other.urp", "/etc/passwd"})
    EXPECT_EQ(ask(controller, "load " + file), "File not found: " + file);
  EXPECT_EQ(ask(controller, "load /ursim/programs/wait_program.urp"),
            "Loading program: /ursim/programs/wait_program.urp");
  EXPECT_EQ(ask(controller, "programState"), "STOPPED wait_program.urp");
  EXPECT_EQ(ask(controller, "get loaded program"), "Loaded program: /programs/wait_program.urp");
  EXPECT_EQ(ask(controller, "isProgramSaved"), "true wait_program.urp");
  EXPECT_EQ(ask(controller, "play"), "Starting program");
  step(controller, 3);
  EXPECT_EQ(ask(controller, "programState"), "PLAYING wait_program.urp");
  EXPECT_EQ(ask(controller, "pause"), "Pausing program");
  step(controller, 3);
  EXPECT_EQ(ask(controller, "programState"), "PAUSED wait_program.urp");
  EXPECT_EQ(ask(controller, "play"), "Starting program");
  step(controller, 3);
  EXPECT_EQ(ask(controller, "running"), "Program running: true");
  EXPECT_EQ(ask(controller, "load bad.urp"), "Loading program: bad.urp");  // the one that ran has ended
  step(controller, 1);
  EXPECT_EQ(ask(controller, "programState"), "STOPPED bad.urp");
  EXPECT_EQ(ask(controller, "play"), "Failed to execute: play");
  controller.run_program("def sent():\n  sleep(1)\nend\n");
  step(controller, 1);
  EXPECT_EQ(ask(controller, "programState"), "PLAYING sent");
}

TEST(Controller, AProgramMayAskForAProtectiveStop) {
  Controller controller(demonstrator_cell(), {});
  const ur::Values6 start = controller.data().actual_q;
  controller.run_program(
      "def p():\n  set_standard_digital_out(0, True)\n  speedj([0.5, 0, 0, 0, 0, 0], 1, 0.5)\n  protective_stop()\n"
      "  sleep(0.1)\n  movej([0, -1, 1, 0, 0, 0])\nend\n");
  for (int i = 0; i < 200 && controller.data().safety_mode == ur::SafetyMode::Normal; ++i) controller.step();
  EXPECT_EQ(ask(controller, "safetystatus"), "Safetystatus: PROTECTIVE_STOP");
  step(controller, 30);
  const ur::Values6 stands = controller.data().actual_q;
  EXPECT_GT(stands[0], start[0] + 0.05);
  EXPECT_EQ(ask(controller, "running"), "Program running: false");
  EXPECT_EQ(controller.data().digital_outputs, 1u);  // the vacuum stays on
  EXPECT_FALSE(controller.unlock_protective_stop()) << "it lasts 5 s";
  EXPECT_EQ(ask(controller, "unlock protective stop").find("Cannot unlock protective stop until 5s"), 0U);
  step(controller, 600);
  EXPECT_EQ(controller.data().safety_mode, ur::SafetyMode::ProtectiveStop);
  EXPECT_EQ(ask(controller, "unlock protective stop"), "Protective stop releasing");
  step(controller, 50);
  EXPECT_EQ(controller.data().safety_mode, ur::SafetyMode::Normal);
  EXPECT_EQ(controller.data().actual_q, stands);
}

TEST(Controller, ATargetFarAwayStopsForProtectionAndIsNoException) {
  for (const char* body : {"  servoj([0, 0, 0, 0, 0, 0], t=0.008)\n  sleep(1)\n", "  movel(p[9, 0, 0, 0, 0, 0])\n"}) {
    Controller controller(demonstrator_cell(), {});
    const ur::Values6 before = controller.data().actual_q;
    (void)controller.take_messages();
    controller.run_program(std::string("def p():\n") + body + "end\n");
    step(controller, 20);
    EXPECT_EQ(controller.data().safety_mode, ur::SafetyMode::ProtectiveStop) << body;
    EXPECT_NE(controller.program_error(), "") << body;
    for (std::size_t j = 0; j < before.size(); ++j) EXPECT_NEAR(controller.data().actual_q[j], before[j], 1e-3);
    constexpr char kMessage = 20, kRuntimeException = 10;
    for (const std::string& packet : controller.take_messages())
      EXPECT_FALSE(packet[4] == kMessage && packet[14] == kRuntimeException) << body;
  }
}

TEST(Controller, AStopThatIsToBeReleasedTooEarlyIsReleasedWhenItMayBe) {
  Controller controller(demonstrator_cell(), {});
  controller.run_program("protective_stop()\n");
  step(controller, 10);
  EXPECT_EQ(controller.data().safety_mode, ur::SafetyMode::ProtectiveStop);
  constexpr char kRobotState = 16;
  const std::vector<std::string> told = controller.take_messages();
  EXPECT_TRUE(std::ranges::any_of(told, [](const auto& one) { return one[4] == kRobotState; })) << "at once";
  constexpr char kMessage = 20, kError = 6, kAskedFor = static_cast<char>(209);
  EXPECT_TRUE(std::ranges::any_of(told, [](const auto& one) {
    return one[4] == kMessage && one[14] == kError && one[18] == kAskedFor;
  })) << "with the code that clients know";
  EXPECT_TRUE(controller.obey("set unlock protective stop"));
  step(controller, 540);
  EXPECT_EQ(controller.data().safety_mode, ur::SafetyMode::ProtectiveStop);
  step(controller, 20);  // the maker's client waits 5 s from when it asks
  EXPECT_EQ(controller.data().safety_mode, ur::SafetyMode::Normal);
}

TEST(Controller, AWatchdogPausesAProgramWhoseInputNobodySets) {
  Controller controller(demonstrator_cell(), {});
  ur::InputOwners owners;
  ur::RtdeSession session(controller.model(), 1, owners);
  const auto ask_rtde = [&](ur::rtde::Frame type, std::string_view payload) {
    (void)session.answer({static_cast<std::uint8_t>(type), payload}, controller.inputs());
  };
  ask_rtde(ur::rtde::Frame::Version, std::string_view("\0\2", 2));
  ask_rtde(ur::rtde::Frame::Inputs, "input_int_register_0");
  controller.run_program("def p():\n  rtde_set_watchdog(\"input_int_register_0\", 10, \"PAUSE\")\n  sleep(9)\nend\n");
  for (int i = 0; i < 5; ++i) {
    ask_rtde(ur::rtde::Frame::Data, std::string_view("\1\0\0\0\7", 5));  // the same value: it counts
    step(controller, 10);
    EXPECT_EQ(controller.data().runtime_state, ur::RuntimeState::Playing) << i;
  }
  step(controller, 10);
  EXPECT_EQ(controller.data().runtime_state, ur::RuntimeState::Paused);
}

TEST(Controller, StartsNoProgramWithoutPowerAndEndsOneThatRuns) {
  Controller controller(demonstrator_cell(), {});
  controller.run_program("def wait():\n  sleep(5)\nend\n");
  step(controller, 3);
  EXPECT_TRUE(controller.data().is_program_running());
  controller.power_off();
  step(controller, 2);
  EXPECT_FALSE(controller.data().is_program_running());
  controller.run_program("def wait():\n  sleep(5)\nend\n");
  step(controller, 2);
  EXPECT_FALSE(controller.data().is_program_running());
}

TEST(Controller, TwoOfThemGiveTheSameBytes) {
  Controller a(demonstrator_cell(), {}), b(demonstrator_cell(), {});
  for (Controller* controller : {&a, &b}) {
    controller->inputs().standard_mask = controller->inputs().standard = 1;
    step(*controller, 40);
  }
  EXPECT_EQ(a.data().actual_q, b.data().actual_q);
  EXPECT_EQ(a.data().actual_tcp_force, b.data().actual_tcp_force);
  EXPECT_EQ(a.data().digital_inputs, b.data().digital_inputs);
}

TEST(Feeder, KnowsWhetherTheBoxBeforeIsPlaced) {
  const cell::Simulation& simulation = demonstrator_cell();
  cell::CellState state = simulation.make_state();
  served_cell::Feeder feeder;
  EXPECT_TRUE(feeder.is_last_placed(simulation, state));
  feeder.advance();
  physics::BodyState& box = state.world.bodies[static_cast<std::size_t>(simulation.world().parcels[0].index)];
  EXPECT_TRUE(feeder.is_last_placed(simulation, state));  // not in the cell
  box.is_present = true;
  const model::Container* target = model::find_container(simulation.scenario(), simulation.scenario().target);
  box.p_WBcm = target->X_WT * Vector3(0.5 * target->inner_size.x() + 0.2, 0, 0.1);
  EXPECT_FALSE(feeder.is_last_placed(simulation, state));
  box.p_WBcm = target->X_WT * Vector3(0, 0, 0.1);
  EXPECT_TRUE(feeder.is_last_placed(simulation, state));
}

TEST(Dashboard, AnswersAsAController) {
  Controller controller(demonstrator_cell(), {});
  EXPECT_EQ(ask(controller, "PolyscopeVersion"), "URSoftware 3.15.8.106339 (Jan 01 2020)");
  EXPECT_EQ(ask(controller, "get robot model"), "UR10");
  EXPECT_EQ(ask(controller, "running"), "Program running: false");
  EXPECT_EQ(ask(controller, "is in remote control"), "true");
  EXPECT_EQ(ask(controller, "load x.urp"), "File not found: x.urp");
  EXPECT_EQ(ask(controller, "load installation default.installation"), "Loading installation: default.installation");
  EXPECT_EQ(ask(controller, "load installation other.installation"), "File not found: installation other.installation");
  EXPECT_EQ(ask(controller, "saveLog"), "Log saved to disk");
  EXPECT_EQ(ask(controller, "make coffee"), "could not understand: 'make coffee'");
  EXPECT_TRUE(answer_dashboard("quit", controller).is_last);
}

}  // namespace
}  // namespace snug::served_ur
