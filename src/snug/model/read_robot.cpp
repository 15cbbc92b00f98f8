// Reading the robot: which arm, where it stands, and the limits it is driven with.
#include <filesystem>
#include <optional>
#include <string>

#include "snug/model/internal/fields.hpp"
#include "snug/model/internal/scenario_reader.hpp"
#include "snug/model/robot_io.hpp"

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

/// What a key of `io` may say instead of a mapping.
bool is_not_wired(const Value& value) {
  if (!value.is_scalar()) return false;
  (void)value.choice({"none"});
  return true;
}

DigitalIo read_digital(const Value& value, DigitalIo io) {
  const MapReader map = value.map("digital_io", {"kind", "number", "active_low"});
  if (const auto kind = map.find("kind"))
    io.kind = static_cast<DigitalKind>(kind->choice({"standard", "configurable", "tool"}));
  if (const auto number = map.find("number")) io.number = static_cast<int>(number->integer(0, 7));
  if (io.kind == DigitalKind::Tool && io.number > 1)
    value.fail("number " + std::to_string(io.number) + " of the tool", "0 or 1: the tool has two");
  if (const auto low = map.find("active_low")) io.active_low = low->boolean();
  return io;
}

GaugeIo read_gauge(const Value& value) {
  constexpr double kMost = 30.0;  // V: no input of a controller takes more
  const MapReader map = value.map("gauge_io", {"kind", "number", "at_ambient", "at_vacuum", "pressure_gauge"});
  GaugeIo io;
  if (const auto kind = map.find("kind")) io.kind = static_cast<AnalogKind>(kind->choice({"standard", "tool"}));
  if (const auto number = map.find("number")) io.number = static_cast<int>(number->integer(0, 1));
  if (const auto v = map.find("at_ambient")) io.at_ambient = v->number_within(-kMost, kMost, "V or A");
  if (const auto v = map.find("at_vacuum")) io.at_vacuum = v->number_within(-kMost, kMost, "V or A");
  if (io.at_ambient == io.at_vacuum) value.fail("at_ambient = at_vacuum", "two readings that differ");
  if (const auto v = map.find("pressure_gauge"))
    io.pressure_gauge = v->number_within(-1.2e5, -1.0, "a vacuum in Pa, gauge");
  return io;
}

/// Not wired, or as the mapping says; what is not there stays.
void read_optional(const MapReader& map, const char* key, std::optional<DigitalIo>& io) {
  const auto value = map.find(key);
  if (!value) return;
  if (is_not_wired(*value)) {
    io.reset();
  } else {
    io = read_digital(*value, *io);
  }
}

void expect_apart(const MapReader& map, const char* key, const std::optional<DigitalIo>& one, const char* other_key,
                  const std::optional<DigitalIo>& other) {
  if (!one || !other || one->bit() != other->bit()) return;
  const Value& at = map.has(other_key) ? map.require(other_key) : map.require(key);
  at.fail("the same as '" + std::string(map.has(other_key) ? key : other_key) + "'", "one of its own, or none");
}

RobotIo read_io(const Value& value) {
  const MapReader map =
      value.map("io", {"vacuum", "blow_off", "vacuum_reached", "vacuum_gauge", "part_present", "next_part"});
  RobotIo io;
  if (const auto vacuum = map.find("vacuum")) io.vacuum = read_digital(*vacuum, io.vacuum);
  read_optional(map, "blow_off", io.blow_off);
  read_optional(map, "vacuum_reached", io.vacuum_reached);
  read_optional(map, "part_present", io.part_present);
  read_optional(map, "next_part", io.next_part);
  if (const auto gauge = map.find("vacuum_gauge")) {
    io.vacuum_gauge.reset();
    if (!is_not_wired(*gauge)) io.vacuum_gauge = read_gauge(*gauge);
  }
  expect_apart(map, "vacuum", io.vacuum, "blow_off", io.blow_off);
  expect_apart(map, "vacuum", io.vacuum, "next_part", io.next_part);
  expect_apart(map, "blow_off", io.blow_off, "next_part", io.next_part);
  expect_apart(map, "vacuum_reached", io.vacuum_reached, "part_present", io.part_present);
  return io;
}

}  // namespace

void ScenarioReader::read_robot(const Value& value) {
  const MapReader map = value.map(
      "robot", keys_with<RobotParams>({"name", "urdf", "tool_frame", "tool_pose", "flange_frame", "sensor_frame",
                                       "pose", "posture", "joints_start", "self_collision", "sensor", "io"}));
  RobotParams robot;
  const Value urdf = map.require("urdf");
  robot.urdf = urdf.file();
  robot.name = std::filesystem::path(robot.urdf).stem().string();
  if (const auto name = map.find("name")) robot.name = name->name();
  if (const auto frame = map.find("tool_frame")) robot.tool_frame = frame->name();
  if (const auto pose = map.find("tool_pose")) {
    robot.X_LE = read_local_pose(pose);
    robot.flange_frame = robot.sensor_frame = robot.tool_frame;
  }
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
  if (const auto io = map.find("io")) (void)read_io(*io);
  scenario_.robot = robot;
}

}  // namespace snug::model::internal

namespace snug::model {

RobotIo robot_io(const Scenario& scenario) {
  const YAML::Node root = YAML::Load(scenario.source_text);
  if (!root.IsMap() || !root["robot"] || !root["robot"]["io"]) return {};
  internal::Document document{scenario.source_name, {}};
  const YAML::Node node = root["robot"]["io"];
  return internal::read_io(internal::Value(node, "robot.io", document, node.Mark().line + 1));
}

}  // namespace snug::model
