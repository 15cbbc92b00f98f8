// Simulator: every allowed pair of messages, and whoever sends anything else moves nothing.
#include "snug/served_cell/simulator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "cell.hpp"
#include "snug/core/rng.hpp"

namespace snug::served_cell {
namespace {

using click::CommandList;
using click::Control;
using click::encode;
using click::Error;
using click::Handshake;
using click::HandshakeInit;
using click::kAcknowledgeEvent;
using click::kAxesSensor;
using click::kFeedEvent;
using click::kPresentSensor;
using click::kQuarterTurnEvent;
using click::kSizeSensor;
using click::kStandEvent;
using click::kTrackingSensor;
using click::kVersion;
using click::kWatcher;
using click::Message;
using click::ObjectDescription;
using click::ObjectSensors;
using click::Reset;
using click::Sensor;
using click::SensorRequest;
using click::SensorValue;
using click::ValueType;

using test::control_of;
using test::kStill;
using test::Talk;

std::vector<double> angles_of(const Message& message) { return std::get<Sensor>(message).objects.at("ur10").angles; }

TEST(Simulator, TellsInTheHandshakeWhatThereIs) {
  Talk talk;
  const Message answer = talk.say(HandshakeInit{});
  const auto& handshake = std::get<Handshake>(answer);
  EXPECT_EQ(handshake.version, kVersion);
  EXPECT_EQ(handshake.time_step, 0.008);
  const ObjectDescription& robot = handshake.objects.at("ur10");
  EXPECT_EQ(robot.controls.size(), 6u);
  EXPECT_EQ(robot.control_types, std::vector<ValueType>(6, ValueType::AngularVelocity1D));
  EXPECT_TRUE(robot.events.contains("vacuum"));
  EXPECT_EQ(robot.sensors.at("UR10FTSensor"), (std::vector<ValueType>{ValueType::Force3D, ValueType::Torque3D}));
  EXPECT_EQ(handshake.objects.size(), 1u + 18u);
  EXPECT_EQ(handshake.objects.at("box027").object_sensors,
            (std::vector<ValueType>{ValueType::Position, ValueType::Rpy}));
}

TEST(ServedCell, WritesOnlyWhatMovedAndStillAllOfIt) {
  const cell::Simulation& simulation = test::demonstrator_cell();
  for (const bool is_plant : {false, true}) {
    ServedCellSettings settings;
    settings.velocities = settings.is_plant = is_plant;
    const ServedCell cell(simulation, settings);
    runs::OutsideRun run(simulation, {});
    WrittenBodies written;
    for (int i = 0; i < 120; ++i) {  // boxes come, fall the last millimetre, and come to rest
      if (i % 20 == 10) (void)run.feed(i / 20, i % 4);
      (void)run.advance(cell.stand({}));
      const std::string frame = cell.write_sensor(run.state(), run.reading(), run.tool_load(), written);
      ASSERT_EQ(frame, encode(cell.sense(run.state(), run.reading(), run.tool_load()))) << i;
    }
  }
}

TEST(Simulator, SendsWhatTheHandshakePromised) {
  SimulatorSettings settings;
  settings.cell.velocities = settings.cell.joint_forces = true;
  Talk talk(settings);
  const Handshake handshake = std::get<Handshake>(talk.say(HandshakeInit{}));
  const Sensor sensor = std::get<Sensor>(talk.say(SensorRequest{}));
  ASSERT_EQ(sensor.objects.size(), handshake.objects.size());
  for (const auto& [name, object] : handshake.objects) {
    const ObjectSensors& sensed = sensor.objects.at(name);
    EXPECT_EQ(sensed.angles.size(), object.joints.size());
    EXPECT_EQ(sensed.forces.size(), object.joints.size());
    ASSERT_EQ(sensed.object.size(), object.object_sensors.size());
    for (std::size_t i = 0; i < sensed.object.size(); ++i) EXPECT_EQ(sensed.object[i].type, object.object_sensors[i]);
    ASSERT_EQ(sensed.sensors.size(), object.sensors.size());
    for (const auto& [sensor_name, types] : object.sensors) {
      const std::vector<SensorValue>& values = sensed.sensors.at(sensor_name);
      ASSERT_EQ(values.size(), types.size()) << sensor_name;
      for (std::size_t i = 0; i < types.size(); ++i) EXPECT_EQ(values[i].type, types[i]);
    }
  }
  // The first joint carries the whole arm: its weight, along its axis.
  const Vector3 force = sensor.objects.at("ur10").forces[0];
  double mass = 0.0;
  const robot::ArmModel& arm = test::demonstrator_cell().arm()->model();
  for (std::size_t i = 1; i < arm.segments.size(); ++i) mass += arm.segments[i].mass;
  EXPECT_NEAR(force.norm(), 9.81 * mass, 1e-6);
}

TEST(Simulator, StepsOnceForEachControlAndNeverForARequest) {
  Talk talk;
  (void)talk.say(HandshakeInit{});
  const Message before = talk.say(SensorRequest{});
  EXPECT_EQ(std::get<Sensor>(before).time, 0.0);
  for (int i = 1; i <= 20; ++i) {
    const Message after = talk.say(control_of(kStill));
    EXPECT_DOUBLE_EQ(std::get<Sensor>(after).time, 0.008 * i);
    EXPECT_EQ(talk.say(SensorRequest{}), after);
    EXPECT_EQ(angles_of(after), angles_of(before)) << "no speed, no motion";
  }
}

TEST(Simulator, FollowsEachJointInItsOwnWay) {
  SimulatorSettings settings;
  using control::DriveKind;
  settings.cell.controls = {DriveKind::Position, DriveKind::Speed, DriveKind::Speed,
                            DriveKind::Speed,    DriveKind::Speed, DriveKind::Torque};
  Talk talk(settings);
  const Handshake handshake = std::get<Handshake>(talk.say(HandshakeInit{}));
  EXPECT_EQ(handshake.objects.at("ur10").control_types[5], ValueType::Torque1D);
  const std::vector<double> start = angles_of(talk.say(SensorRequest{}));
  Message last;
  for (int i = 1; i <= 100; ++i) {
    last = talk.say(control_of({start[0] + 0.001 * i, 0.0, -0.1, 0.0, 0.0, 0.0}));
    ASSERT_TRUE(std::holds_alternative<Sensor>(last)) << std::get<Error>(last).text;
  }
  EXPECT_EQ(angles_of(last)[0], start[0] + 0.1);
  EXPECT_EQ(angles_of(last)[1], start[1]);
  EXPECT_NEAR(angles_of(last)[2], start[2] - 0.08 + 0.5 * 0.1 * 0.1 / 15.0, 1e-3);
}

TEST(Simulator, ResetsToTheStartAndWaits) {
  Talk talk;
  (void)talk.say(HandshakeInit{});
  const Message before = talk.say(SensorRequest{});
  for (int i = 0; i < 30; ++i) (void)talk.say(control_of({0.1, 0, 0, 0, 0, 0.2}, {{"vacuum", true}}));
  EXPECT_TRUE(std::holds_alternative<Reset>(talk.say(Reset{})));
  EXPECT_EQ(talk.say(SensorRequest{}), before);
  EXPECT_EQ(talk.simulator.counts().runs, 1);
}

TEST(Simulator, TellsItsOwnResetOnceAndNeverToAHandshake) {
  SimulatorSettings settings;
  settings.batch = 0.04;
  std::vector<std::string> ends;
  settings.end_run = [&](int, const runs::RunResult& result) { ends.push_back(result.ended_by); };
  Talk talk(settings);
  (void)talk.say(HandshakeInit{});
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(std::holds_alternative<Sensor>(talk.say(control_of(kStill)))) << i;
  EXPECT_EQ(ends.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<Reset>(talk.say(control_of({9, 9, 9, 9, 9, 9}))));
  EXPECT_EQ(std::get<Sensor>(talk.say(SensorRequest{})).time, 0.0);
  for (int i = 0; i < 5; ++i) (void)talk.say(control_of(kStill));
  EXPECT_TRUE(std::holds_alternative<Handshake>(talk.say(HandshakeInit{})));  // cancels the Reset
  EXPECT_TRUE(std::holds_alternative<Sensor>(talk.say(SensorRequest{})));
}

TEST(Simulator, RefusesAnotherVersion) {
  Talk talk;
  EXPECT_NE(talk.error(HandshakeInit{0}).find("version 0 is not supported, expected 1"), std::string::npos);
  EXPECT_NE(talk.error(HandshakeInit{2}).find("version 2"), std::string::npos);
}

TEST(Simulator, TakesAFirstControlForAHandshakeWhereNobodyCommands) {
  Talk talk;
  EXPECT_NE(talk.error(control_of({1, 2})).find("2 values for the 6 joints"), std::string::npos);
  EXPECT_FALSE(talk.simulator.has_controller()) << "what means nothing takes no place";
  (void)talk.say(HandshakeInit{}, "looks on");  // and has the place as long as nobody commands
  EXPECT_EQ(std::get<Sensor>(talk.say(control_of(kStill), "a")).time, 0.008);
  EXPECT_TRUE(talk.simulator.is_controller("a"));
  EXPECT_EQ(std::get<Sensor>(talk.say(SensorRequest{}, "looks on")).time, 0.008);
  EXPECT_NE(talk.error(control_of(kStill), "looks on").find("another controller"), std::string::npos);
  EXPECT_FALSE(talk.simulator.leave("looks on"));
  EXPECT_TRUE(talk.simulator.leave("a"));
  EXPECT_EQ(std::get<Sensor>(talk.say(control_of(kStill), "looks on")).time, 0.008) << "a new run";
}

TEST(Simulator, TellsWhereItsRobotStandsAndThePressureTwice) {
  Talk talk;
  const auto robot = std::get<Handshake>(talk.say(HandshakeInit{})).objects.at("ur10");
  EXPECT_EQ(robot.object_sensors, (std::vector<ValueType>{ValueType::Position, ValueType::Rpy}));
  for (int i = 0; i < 60; ++i) (void)talk.say(control_of(kStill, {{"vacuum", true}}));
  const auto sensed = std::get<Sensor>(talk.say(SensorRequest{})).objects.at("ur10");
  const Pose& X_WB = test::demonstrator_cell().arm()->model().X_WB;
  EXPECT_EQ(sensed.object[0].vector, X_WB.p);
  const double pressure = sensed.sensors.at("pressure")[0].scalar;
  const SensorValue& force = sensed.sensors.at("pressure_force")[0];
  EXPECT_EQ(force.type, ValueType::Force3D) << "clients of other makers read no Force1D";
  EXPECT_EQ(force.vector, Vector3(0.0, 0.0, pressure));
}

TEST(Simulator, MayRunBeforeThereIsAController) {
  SimulatorSettings settings;
  settings.is_async = settings.runs_at_once = true;
  Talk talk(settings);
  for (int i = 0; i < 25; ++i) talk.simulator.step();
  const Sensor still = std::get<Sensor>(talk.say(SensorRequest{}, "looks on"));
  EXPECT_DOUBLE_EQ(still.time, 0.2);
  EXPECT_EQ(still.objects.at("ur10").velocities, kStill);
  (void)talk.say(control_of({0, 0, 0, 0, 0, 0.24}));
  for (int i = 0; i < 20; ++i) talk.simulator.step();
  EXPECT_EQ(std::get<Sensor>(talk.say(SensorRequest{})).objects.at("ur10").velocities[5], 0.24);
  EXPECT_EQ(talk.simulator.counts().runs, 1);
  EXPECT_TRUE(talk.simulator.leave("a"));
  talk.simulator.step();
  EXPECT_DOUBLE_EQ(talk.simulator.time(), 0.008) << "the next run";
}

TEST(Simulator, SaysWhatIsWrongWithACommandAndMovesNothing) {
  Talk talk;
  (void)talk.say(HandshakeInit{});
  (void)talk.say(control_of({0.3, 0, 0, 0, 0, 0}, {{"vacuum", true}}));
  const std::uint64_t hash = talk.simulator.hash();
  const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
  Control unknown = control_of(kStill);
  unknown.objects["box27"].events["feed"] = true;
  Control listed = control_of({});
  listed.objects["ur10"] = {CommandList::Angles, kStill, {}};
  Control box = control_of(kStill);
  box.objects["box027"].list = CommandList::Values;
  box.objects["box027"].values = {1.0};
  Control two = control_of(kStill);
  two.objects["box013"].events["feed"] = two.objects["box028"].events["feed"] = true;
  const struct {
    Message message;
    const char* text;
  } cases[] = {
      {control_of({}), "0 values for the 6 joints"},
      {control_of({1, 2, 3, 4, 5}), "5 values for the 6 joints"},
      {control_of({1, 2, 3, 4, 5, 6, 7}), "7 values"},
      {control_of({0, nan, 0, 0, 0, 0}), "shoulder_lift_joint"},
      {control_of({0, 0, 0, 0, 0, -infinite}), "not a finite number"},
      {control_of(kStill, {{"vaccum", true}}), "is it 'vacuum'?"},
      {unknown, "object 'box27' is unknown; is it 'box027'?"},
      {listed, "'angles' for joint 'shoulder_pan_joint', which takes AngularVelocity1D"},
      {box, "object 'box027' has no joints to control"},
      {two, "two boxes are to come at once"},
      {Control{}, "no values for the joints of 'ur10'"},
      {Handshake{}, "is for controllers"},
      {Sensor{}, "is for controllers"},
  };
  for (const auto& bad : cases)
    EXPECT_NE(talk.error(bad.message).find(bad.text), std::string::npos) << talk.error(bad.message);
  EXPECT_NE(std::get<Error>(talk.hear(std::string(kLargestFrame + 1, 'x'))).text.find("are the most"),
            std::string::npos);
  EXPECT_NE(std::get<Error>(talk.hear("\xff\xff")).text.find("cannot be read"), std::string::npos);
  EXPECT_EQ(talk.simulator.hash(), hash);
  EXPECT_TRUE(std::holds_alternative<Sensor>(talk.say(control_of(kStill)))) << "the session goes on";
}

TEST(Simulator, HasOneControllerAtATime) {
  Talk talk;
  (void)talk.say(HandshakeInit{}, "a");
  (void)talk.say(control_of({0.3, 0, 0, 0, 0, 0}), "a");
  const std::uint64_t hash = talk.simulator.hash();
  EXPECT_TRUE(std::holds_alternative<Handshake>(talk.say(HandshakeInit{}, "b"))) << "it may look, whatever its name";
  EXPECT_EQ(talk.say(SensorRequest{}, "b"), talk.say(SensorRequest{}, "c"));
  for (const Message& message : {Message(control_of({1, 1, 1, 1, 1, 1})), Message(Reset{}), Message(Error{"stop"})}) {
    EXPECT_NE(talk.error(message, "b").find("another controller"), std::string::npos) << name_of(message);
  }
  EXPECT_FALSE(talk.simulator.leave("b"));
  EXPECT_EQ(talk.simulator.hash(), hash);
  EXPECT_TRUE(talk.simulator.leave("a"));
  EXPECT_TRUE(std::holds_alternative<Handshake>(talk.say(HandshakeInit{}, "b")));
  EXPECT_EQ(std::get<Sensor>(talk.say(SensorRequest{}, "b")).time, 0.0);
}

TEST(Simulator, AnswersWhoOnlyLooksBesideTheController) {
  Talk talk;
  const std::string watcher = std::string(kWatcher) + "-1";
  EXPECT_TRUE(std::holds_alternative<Handshake>(talk.say(HandshakeInit{}, watcher)));
  EXPECT_FALSE(talk.simulator.has_controller()) << "looking takes no place";
  (void)talk.say(HandshakeInit{}, "a");
  const Message sensor = talk.say(control_of({0.3, 0, 0, 0, 0, 0}), "a");
  const std::uint64_t hash = talk.simulator.hash();
  EXPECT_EQ(talk.say(SensorRequest{}, watcher), sensor);
  EXPECT_TRUE(std::holds_alternative<Handshake>(talk.say(HandshakeInit{}, watcher)));
  EXPECT_NE(talk.error(HandshakeInit{2}, watcher).find("not supported"), std::string::npos);
  for (const Message& message : {Message(control_of({1, 1, 1, 1, 1, 1})), Message(Reset{}), Message(Error{"stop"})}) {
    EXPECT_NE(talk.error(message, watcher).find("is an observer"), std::string::npos) << name_of(message);
  }
  EXPECT_FALSE(talk.simulator.leave(watcher));
  EXPECT_EQ(talk.simulator.hash(), hash);
  EXPECT_TRUE(talk.simulator.is_controller("a"));
}

TEST(Simulator, EndsTheRunWithAReason) {
  std::vector<std::string> ends;
  SimulatorSettings settings;
  settings.end_run = [&](int, const runs::RunResult& result) { ends.push_back(result.ended_by); };
  Talk talk(settings);
  const auto run = [&] {
    (void)talk.say(HandshakeInit{});
    (void)talk.say(control_of(kStill));
  };
  run();
  (void)talk.say(Reset{});
  run();
  EXPECT_FALSE(talk.simulator.answer("a", encode(Error{"I am lost"})).has_value());
  run();
  (void)talk.simulator.leave("a");
  EXPECT_EQ(ends, (std::vector<std::string>{"reset by the controller", "the controller reported: I am lost",
                                            "the controller left"}));
}

TEST(Simulator, StopsForProtectionUntilItIsReset) {
  SimulatorSettings settings;
  settings.cell.controls = {control::DriveKind::Torque};
  Talk talk(settings);
  (void)talk.say(HandshakeInit{});
  EXPECT_NE(talk.error(control_of({1e4, 0, 0, 0, 0, 0})).find("protective stop"), std::string::npos);
  EXPECT_NE(talk.error(control_of(kStill)).find("joint torque of shoulder_pan_joint"), std::string::npos);
  EXPECT_TRUE(std::holds_alternative<Sensor>(talk.say(SensorRequest{})));
  EXPECT_TRUE(std::holds_alternative<Reset>(talk.say(Reset{})));
  EXPECT_NE(talk.error(control_of({1e4, 0, 0, 0, 0, 0})).find("protective stop"), std::string::npos);
  EXPECT_TRUE(std::holds_alternative<Handshake>(talk.say(HandshakeInit{})));
  EXPECT_EQ(std::get<Sensor>(talk.say(SensorRequest{})).time, 0.0);
}

TEST(Simulator, AStopOfAPlantMayBeAcknowledged) {
  SimulatorSettings settings;
  settings.cell.is_plant = true;
  settings.cell.controls = {control::DriveKind::Torque};
  int ended = 0;
  settings.end_run = [&](int, const runs::RunResult&) { ++ended; };
  Talk talk(settings);
  (void)talk.say(HandshakeInit{});
  EXPECT_NE(talk.error(control_of({1e4, 0, 0, 0, 0, 0})).find("protective stop"), std::string::npos);
  EXPECT_NE(talk.error(control_of(kStill)).find("protective stop"), std::string::npos) << "not acknowledged";
  EXPECT_EQ(ended, 0);
  Control release;
  release.objects["ur10"].events = {{kAcknowledgeEvent, true}};
  const Message released = talk.say(release);
  ASSERT_TRUE(std::holds_alternative<Sensor>(released));
  const ObjectSensors& robot = std::get<Sensor>(released).objects.at("ur10");
  EXPECT_EQ(robot.velocities, kStill) << "the brakes are closed";
  EXPECT_DOUBLE_EQ(std::get<Sensor>(released).time, 0.008) << "no step";
  EXPECT_TRUE(std::holds_alternative<Sensor>(talk.say(control_of(kStill))));
  EXPECT_NE(talk.error(control_of({1e4, 0, 0, 0, 0, 0})).find("protective stop"), std::string::npos);
  EXPECT_TRUE(std::holds_alternative<Handshake>(talk.say(HandshakeInit{})));
  EXPECT_EQ(ended, 1) << "nobody acknowledged it";
  EXPECT_DOUBLE_EQ(std::get<Sensor>(talk.say(SensorRequest{})).time, 0.0);
}

TEST(Simulator, StandsAtOnceWithoutAStep) {
  Talk talk;
  (void)talk.say(HandshakeInit{});
  for (int i = 0; i < 5; ++i) (void)talk.say(control_of({0.3, 0, 0, 0, 0, 0}));
  Control stand;
  stand.objects["ur10"].events = {{kStandEvent, true}, {"vacuum", true}};
  const auto standing = std::get<Sensor>(talk.say(stand));
  EXPECT_DOUBLE_EQ(standing.time, 0.04);
  EXPECT_EQ(standing.objects.at("ur10").velocities, kStill);
  const double q = standing.objects.at("ur10").angles[0];
  const auto after = std::get<Sensor>(talk.say(control_of(kStill)));
  EXPECT_EQ(after.objects.at("ur10").angles[0], q) << "it does not roll on";
  Control off = stand;
  off.objects["ur10"].events = {{kStandEvent, false}};
  EXPECT_NE(talk.error(off).find("0 "), std::string::npos) << "values are missing where it is not to stand";
}

TEST(Simulator, BringsABoxWithoutAStepAndTakesAwayWhatIsThere) {
  Talk talk;
  (void)talk.say(HandshakeInit{});
  const auto bring = [&](const char* box) {
    Control control;
    control.objects[box].events = {{kFeedEvent, true}};
    return std::get<Sensor>(talk.say(control));
  };
  const auto is_there = [](const Sensor& sensor, const char* box) {
    return sensor.objects.at(box).sensors.at(kPresentSensor)[0].is_active;
  };
  const Sensor first = bring("box028");
  EXPECT_TRUE(is_there(first, "box028"));
  EXPECT_EQ(first.time, 0.0);
  for (int i = 0; i < 50; ++i) (void)talk.say(control_of(kStill));
  EXPECT_FALSE(is_there(std::get<Sensor>(talk.say(SensorRequest{})), "box027")) << "boxes no longer come by themselves";
  const Sensor second = bring("box013");
  EXPECT_TRUE(is_there(second, "box013"));
  EXPECT_FALSE(is_there(second, "box028")) << "it stood there";
  Control nothing;
  nothing.objects["box028"].events = {{kFeedEvent, true}};
  EXPECT_NE(talk.error(nothing).find("no values for the joints"), std::string::npos) << "it is on already";
}

TEST(Simulator, APlantTellsAxesSizesAndTracking) {
  SimulatorSettings settings;
  settings.cell.is_plant = true;
  Talk talk(settings);
  const auto shake = std::get<Handshake>(talk.say(HandshakeInit{}));
  const auto sensed = std::get<Sensor>(talk.say(SensorRequest{}));
  for (const auto& [name, object] : shake.objects) {
    for (const auto& [sensor, types] : object.sensors) {
      const std::vector<SensorValue>& values = sensed.objects.at(name).sensors.at(sensor);
      ASSERT_EQ(values.size(), types.size()) << sensor;
      for (std::size_t i = 0; i < types.size(); ++i) EXPECT_EQ(values[i].type, types[i]) << sensor;
    }
  }
  const ObjectSensors& box = sensed.objects.at("box028");
  const model::Scenario& scenario = test::demonstrator_cell().scenario();
  EXPECT_EQ(box.sensors.at(kSizeSensor)[0].vector,
            model::collision_size(scenario, *model::find_parcel(scenario, "BOX028")));
  EXPECT_EQ(box.sensors.at(kAxesSensor)[1].vector, Vector3::UnitY()) << "parked";
  EXPECT_EQ(sensed.objects.at("ur10").sensors.at(kTrackingSensor)[0].vector.x(), 10.0) << "1/s^2, of the report";
}

TEST(Simulator, BringsTheBoxesItselfUnlessTheControllerDoes) {
  const auto is_present = [](const Message& message, const char* box) {
    return std::get<Sensor>(message).objects.at(box).sensors.at(kPresentSensor)[0].is_active;
  };
  Talk talk;
  (void)talk.say(HandshakeInit{});
  EXPECT_FALSE(is_present(talk.say(SensorRequest{}), "box027"));
  const Message first = talk.say(control_of(kStill));
  EXPECT_TRUE(is_present(first, "box027"));
  EXPECT_FALSE(is_present(first, "box028"));

  (void)talk.say(Reset{});
  Control control = control_of(kStill);
  control.objects["box028"].events[kFeedEvent] = false;
  EXPECT_FALSE(is_present(talk.say(control), "box027"));
  control.objects["box028"].events = {{kFeedEvent, true}, {kQuarterTurnEvent, true}};
  const Message fed = talk.say(control);
  EXPECT_TRUE(is_present(fed, "box028"));
  EXPECT_FALSE(is_present(fed, "box027"));
  const Message again = talk.say(control);  // still on: nothing new
  EXPECT_TRUE(std::holds_alternative<Sensor>(again));
  control.objects["box028"].events[kFeedEvent] = false;
  (void)talk.say(control);
  control.objects["box028"].events[kFeedEvent] = true;
  EXPECT_NE(talk.error(control).find("'box028' is to come, but it is in the cell"), std::string::npos);
}

TEST(Simulator, FreelyRunningFollowsTheLatestCommandAndBrakesWhenItIsOld) {
  SimulatorSettings settings;
  settings.is_async = true;
  Talk talk(settings);
  (void)talk.say(HandshakeInit{});
  talk.simulator.step();
  EXPECT_EQ(talk.simulator.time(), 0.0) << "nothing moves before the first Control";
  const Message start = talk.say(control_of({0, 0, 0, 0, 0, 0.24}));
  EXPECT_EQ(std::get<Sensor>(start).time, 0.0);
  for (int i = 0; i < 20; ++i) talk.simulator.step();
  const Sensor moving = std::get<Sensor>(talk.say(SensorRequest{}));
  EXPECT_DOUBLE_EQ(moving.time, 0.16);
  EXPECT_EQ(moving.objects.at("ur10").velocities[5], 0.24);
  for (int i = 0; i < 40; ++i) talk.simulator.step();  // 0.25 s are 32 steps
  EXPECT_EQ(std::get<Sensor>(talk.say(SensorRequest{})).objects.at("ur10").velocities[5], 0.0);
}

TEST(Simulator, GivesTheSameAnswersToTheSameFrames) {
  std::vector<std::string> first;
  for (int run = 0; run < 2; ++run) {
    Talk talk;
    Rng rng = Rng(4).split("frames");
    std::vector<std::string> answers = {*talk.simulator.answer("a", encode(HandshakeInit{}))};
    for (int i = 0; i < 150; ++i) {
      std::vector<double> speeds(6);
      for (double& speed : speeds) speed = rng.uniform(-0.3, 0.3);
      answers.push_back(*talk.simulator.answer("a", encode(control_of(speeds, {{"vacuum", i % 50 > 25}}))));
    }
    if (run == 0) first = answers;
    EXPECT_EQ(answers, first);
  }
}

}  // namespace
}  // namespace snug::served_cell
