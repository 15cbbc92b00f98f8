// Reading the robot: which arm, where it stands, and the limits it is driven with.
#include <filesystem>

#include "snug/model/internal/fields.hpp"
#include "snug/model/internal/scenario_reader.hpp"

namespace snug::model::internal {
namespace {

/// Beyond these a bias or drift is a slip.
constexpr double kLargestSensorError = 1e4;  // N, Nm, N/s, Nm/s

std::vector<double> read_joints(const Value& value) {
  std::vector<double> q;
  for (const Value& entry : value.list())
    q.push_back(entry.number_within(-100.0, 100.0, "a joint position in rad or m"));
  if (q.empty()) value.fail("one number for each joint");
  return q;
}

Vector3 read_sensor_error(const Value& value) {
  const Vector3 v = value.vector3();
  if (!(v.cwiseAbs().maxCoeff() <= kLargestSensorError)) value.fail("numbers no larger than 1e4");
  return v;
}

SelfCollisionPair read_pair(const Value& value) {
  const MapReader map = value.map("self_collision", {"links", "interaction", "safety"});
  SelfCollisionPair pair;
  const std::vector<Value> links = map.require("links").list_of(2, "link names");
  pair.link_a = links[0].name();
  pair.link_b = links[1].name();
  if (pair.link_a == pair.link_b) map.require("links").fail("one link twice", "two links");
  pair.interaction = map.require("interaction").number_within(0.0, kLargestSize, "a distance in metres");
  pair.safety = map.require("safety").number_within(0.0, kLargestSize, "a distance in metres");
  if (!(pair.safety < pair.interaction))
    value.fail("safety " + to_text(pair.safety) + ", interaction " + to_text(pair.interaction), "safety < interaction");
  return pair;
}

ForceSensorParams read_sensor(const Value& value) {
  ForceSensorParams sensor;
  const MapReader map =
      value.map("sensor", keys_with<ForceSensorParams>({"force_bias", "torque_bias", "force_drift", "torque_drift"}));
  read_fields(map, sensor);
  if (const auto v = map.find("force_bias")) sensor.force_bias = read_sensor_error(*v);
  if (const auto v = map.find("torque_bias")) sensor.torque_bias = read_sensor_error(*v);
  if (const auto v = map.find("force_drift")) sensor.force_drift = read_sensor_error(*v);
  if (const auto v = map.find("torque_drift")) sensor.torque_drift = read_sensor_error(*v);
  return sensor;
}

}  // namespace

void ScenarioReader::read_robot(const Value& value) {
  const MapReader map =
      value.map("robot", keys_with<RobotParams>({"name", "urdf", "tool_frame", "flange_frame", "sensor_frame", "pose",
                                                 "posture", "joints_start", "self_collision", "sensor"}));
  RobotParams robot;
  const Value urdf = map.require("urdf");
  robot.urdf = urdf.name();
  robot.name = std::filesystem::path(robot.urdf).stem().string();
  if (const auto name = map.find("name")) robot.name = name->name();
  if (const auto frame = map.find("tool_frame")) robot.tool_frame = frame->name();
  if (const auto frame = map.find("flange_frame")) robot.flange_frame = frame->name();
  if (const auto frame = map.find("sensor_frame")) robot.sensor_frame = frame->name();
  robot.X_WB = read_world_pose(map.find("pose"));
  robot.posture = read_joints(map.require("posture"));
  if (const auto start = map.find("joints_start")) {
    robot.joints_start = read_joints(*start);
    if (robot.joints_start.size() != robot.posture.size())
      start->fail(std::to_string(robot.joints_start.size()) + " numbers",
                  std::to_string(robot.posture.size()) + ", as many as 'posture' has");
  }
  read_fields(map, robot);
  if (!(robot.velocity_fraction > 0.0)) map.require("velocity_fraction").fail("0", "more than 0, at most 1");
  if (!(robot.damper.safety < robot.damper.interaction && robot.damper.interaction <= 0.5))
    map.require("damper").fail(
        "safety " + to_text(robot.damper.safety) + ", interaction " + to_text(robot.damper.interaction),
        "safety < interaction <= 0.5");
  if (const auto pairs = map.find("self_collision"))
    for (const Value& entry : pairs->list()) robot.self_collision.push_back(read_pair(entry));
  if (const auto sensor = map.find("sensor")) robot.sensor = read_sensor(*sensor);
  scenario_.robot = robot;
}

}  // namespace snug::model::internal
