// The messages of CLICK as plain data, and as the bytes of a frame.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "snug/core/expected.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::click {

/// Of the protocol; in HandshakeInit and Handshake.
inline constexpr int kVersion = 1;

/// What a number (or three) is; the values are those of the protocol.
enum class ValueType : int {
  Angle = 0,                  ///< rad
  AngularVelocity1D = 1,      ///< rad/s
  Torque1D = 2,               ///< Nm
  Position = 3,               ///< m
  Rpy = 4,                    ///< rad
  Activated = 5,              ///< yes or no
  Acceleration3D = 6,         ///< m/s^2
  Force3D = 7,                ///< N
  Torque3D = 8,               ///< Nm
  AngularAcceleration3D = 9,  ///< rad/s^2
  Velocity3D = 10,            ///< m/s
  AngularVelocity3D = 11,     ///< rad/s
  Force1D = 12,               ///< N
  Multiple = 15,              ///< joints of one scene have different ones
};
[[nodiscard]] const char* name_of(ValueType type);

/// By name, in the order of the names: the same content makes the same bytes.
template <class T>
using Named = std::map<std::string, T, std::less<>>;

/// From the controller: who is there?
struct HandshakeInit {
  int version = kVersion;
  bool operator==(const HandshakeInit&) const = default;
};

/// What one object of the scene can be told and tells.
struct ObjectDescription {
  std::vector<std::string> controls;      ///< joints, in the order of commands
  std::vector<ValueType> control_types;   ///< one for each
  Named<ValueType> events;                ///< that may be switched
  std::vector<std::string> joints;        ///< in the order of joint sensors
  std::vector<ValueType> joint_sensors;   ///< that each joint has
  std::vector<ValueType> object_sensors;  ///< of the object as a body
  Named<std::vector<ValueType>> sensors;  ///< with names
  bool operator==(const ObjectDescription&) const = default;
};

struct Handshake {
  int version = kVersion;
  Named<ObjectDescription> objects;
  double time_step = 0.0;  ///< s
  bool operator==(const Handshake&) const = default;
};

/// Which of its lists a command uses: `values`, whose types the handshake gave, or one of the older ones.
enum class CommandList { Nothing, Values, Angles, AngularVelocities, Torques };

struct ObjectControl {
  CommandList list = CommandList::Nothing;
  std::vector<double> values;
  Named<bool> events;
  bool operator==(const ObjectControl&) const = default;
};

/// From the controller: one step with this.
struct Control {
  Named<ObjectControl> objects;
  bool operator==(const Control&) const = default;
};

struct SensorValue {
  ValueType type = ValueType::Angle;
  Vector3 vector = Vector3::Zero();  ///< of types with three numbers
  double scalar = 0.0;               ///< of types with one
  bool is_active = false;            ///< Activated
  bool operator==(const SensorValue&) const = default;
};

struct ObjectSensors {
  std::vector<double> angles;      ///< rad (m)
  std::vector<double> velocities;  ///< rad/s (m/s)
  std::vector<double> torques;     ///< Nm (N)
  std::vector<Vector3> forces;     ///< N, of each joint
  std::vector<SensorValue> object;
  Named<std::vector<SensorValue>> sensors;
  bool operator==(const ObjectSensors&) const = default;
};

struct Sensor {
  Named<ObjectSensors> objects;
  double time = 0.0;  ///< s, simulated
  bool operator==(const Sensor&) const = default;
};

struct Reset {
  bool operator==(const Reset&) const = default;
};
struct SensorRequest {
  bool operator==(const SensorRequest&) const = default;
};
struct Error {
  std::string text;
  bool operator==(const Error&) const = default;
};

using Message = std::variant<HandshakeInit, Handshake, Control, Sensor, Reset, Error, SensorRequest>;
/// "Control".
[[nodiscard]] const char* name_of(const Message& message);

/// The bytes of one frame.
[[nodiscard]] std::string encode(const Message& message);
/// What a frame says, or why it says nothing: not a message, an unknown type, two lists of values for one object, a
/// vector without three numbers. Numbers are taken as they are: finite or not.
[[nodiscard]] Expected<Message, std::string> decode(std::string_view frame);

}  // namespace snug::click
