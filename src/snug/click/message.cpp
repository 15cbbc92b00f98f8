// The messages of CLICK as plain data, and as the bytes of a frame.
#include "snug/click/message.hpp"

#include <click.pb.h>
#include <fmt/format.h>
#include <google/protobuf/arena.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/stubs/logging.h>

#include <array>
#include <climits>
#include <cstddef>
#include <optional>
#include <type_traits>

#include "snug/click/sensor_writer.hpp"
#include "snug/core/check.hpp"

namespace snug::click {
namespace {

namespace proto = ::click::protobuf;
using Reason = Unexpected<std::string>;

/// Where a message of usual size lives without the heap: reading and writing them is a good part of a round trip.
class Room {
 public:
  Room() : arena_(options()) {}
  template <class Wire>
  [[nodiscard]] Wire* make() {
    return google::protobuf::Arena::CreateMessage<Wire>(&arena_);
  }

 private:
  [[nodiscard]] google::protobuf::ArenaOptions options() {
    google::protobuf::ArenaOptions options;
    options.initial_block = block_.data();
    options.initial_block_size = block_.size();
    return options;
  }
  alignas(std::max_align_t) std::array<char, 131072> block_;
  google::protobuf::Arena arena_;
};

proto::ValueType_Kind as_wire(ValueType type) { return static_cast<proto::ValueType_Kind>(static_cast<int>(type)); }

// ---- what is sent

/// The older scene-wide type: that of all joints, or Multiple.
ValueType common_type(const Handshake& handshake) {
  std::optional<ValueType> common;
  for (const auto& [name, object] : handshake.objects) {
    for (const ValueType type : object.control_types) {
      if (common && *common != type) return ValueType::Multiple;
      common = type;
    }
  }
  return common.value_or(ValueType::Multiple);
}

void put(const ObjectDescription& object, proto::HandshakeMessage_Object* out) {
  for (const std::string& name : object.controls) out->add_controlsinorder(name);
  for (const ValueType type : object.control_types) out->add_controltypesinorder(as_wire(type));
  for (const std::string& name : object.joints) out->add_jointsensorsinorder(name);
  for (const ValueType type : object.joint_sensors) out->add_jointsensors(as_wire(type));
  for (const ValueType type : object.object_sensors) out->add_objectsensors(as_wire(type));
  for (const auto& [name, type] : object.events) (*out->mutable_controlevents())[name] = as_wire(type);
  for (const auto& [name, types] : object.sensors) {
    for (const ValueType type : types) (*out->mutable_sensors())[name].add_types(as_wire(type));
  }
}

void put(const ObjectControl& object, proto::ControlMessage_Object* out) {
  using List = google::protobuf::RepeatedField<double>;
  List* list = nullptr;
  if (object.list == CommandList::Values) list = out->mutable_values();
  if (object.list == CommandList::Angles) list = out->mutable_angles();
  if (object.list == CommandList::AngularVelocities) list = out->mutable_angularvelocities();
  if (object.list == CommandList::Torques) list = out->mutable_torques();
  if (list != nullptr) list->Add(object.values.begin(), object.values.end());
  for (const auto& [name, is_on] : object.events) (*out->mutable_controlevents())[name] = is_on;
}

void put(const HandshakeInit& message, proto::HandshakeInitMessage* out) {
  out->set_messagetype(proto::MessageType::HandshakeInit);
  out->set_version(static_cast<proto::Version_Kind>(message.version));
}
void put(const Handshake& message, proto::HandshakeMessage* out) {
  out->set_messagetype(proto::MessageType::Handshake);
  out->set_version(static_cast<proto::Version_Kind>(message.version));
  out->set_controltype(as_wire(common_type(message)));
  out->mutable_simsettings()->set_timestep(message.time_step);
  for (const auto& [name, object] : message.objects) put(object, &(*out->mutable_objects())[name]);
}
void put(const Control& message, proto::ControlMessage* out) {
  out->set_messagetype(proto::MessageType::Control);
  for (const auto& [name, object] : message.objects) put(object, &(*out->mutable_objects())[name]);
}
void put(const Reset&, proto::ResetMessage* out) { out->set_messagetype(proto::MessageType::Reset); }
void put(const SensorRequest&, proto::SensorRequestMessage* out) {
  out->set_messagetype(proto::MessageType::SensorRequest);
}
void put(const Error& message, proto::ErrorMessage* out) {
  out->set_messagetype(proto::MessageType::Error);
  out->set_error(proto::ErrorMessage::VersionNotSupported);  // there is no other
  out->set_errormessage(message.text);
}

template <class T>
struct WireOf;
template <>
struct WireOf<HandshakeInit> : std::type_identity<proto::HandshakeInitMessage> {};
template <>
struct WireOf<Handshake> : std::type_identity<proto::HandshakeMessage> {};
template <>
struct WireOf<Control> : std::type_identity<proto::ControlMessage> {};
template <>
struct WireOf<Reset> : std::type_identity<proto::ResetMessage> {};
template <>
struct WireOf<SensorRequest> : std::type_identity<proto::SensorRequestMessage> {};
template <>
struct WireOf<Error> : std::type_identity<proto::ErrorMessage> {};

template <class T>
std::string encode_one(const T& message) {
  Room room;
  auto* out = room.make<typename WireOf<T>::type>();
  put(message, out);
  std::string bytes;
  bytes.reserve(out->ByteSizeLong());
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream coded(&stream);
  coded.SetSerializationDeterministic(true);
  SNUG_CHECK(out->SerializeToCodedStream(&coded), "a message of ours can be written");
  coded.Trim();
  return bytes;
}

std::string encode_one(const Sensor& sensor) { return wire::write_sensor(sensor); }

// ---- what is received

template <class Wire>
bool parse(std::string_view frame, Wire& out) {
  return frame.size() <= INT_MAX && out.ParseFromArray(frame.data(), static_cast<int>(frame.size()));
}

template <class List>
std::vector<ValueType> types_of(const List& list) {
  std::vector<ValueType> types;
  for (const int type : list) types.push_back(static_cast<ValueType>(type));
  return types;
}

Expected<ObjectControl, std::string> take(const std::string& name, const proto::ControlMessage_Object& in) {
  ObjectControl object;
  const auto use = [&](const google::protobuf::RepeatedField<double>& list, CommandList kind) {
    if (list.empty()) return true;
    if (object.list != CommandList::Nothing) return false;
    object.list = kind;
    object.values.assign(list.begin(), list.end());
    return true;
  };
  if (!use(in.values(), CommandList::Values) || !use(in.angles(), CommandList::Angles) ||
      !use(in.angularvelocities(), CommandList::AngularVelocities) || !use(in.torques(), CommandList::Torques)) {
    return Reason(fmt::format("object '{}' has more than one list of values", name));
  }
  for (const auto& [event, is_on] : in.controlevents()) object.events[event] = is_on;
  return object;
}

Expected<Vector3, std::string> take(const proto::Vec3& in) {
  if (in.arr_size() != 3) return Reason(fmt::format("a vector of {} numbers, expected 3", in.arr_size()));
  return Vector3(in.arr(0), in.arr(1), in.arr(2));
}

Expected<SensorValue, std::string> take(const proto::Sensor& in) {
  SensorValue value;
  const auto scalar = [&](ValueType type, double x) -> Expected<SensorValue, std::string> {
    value.type = type;
    value.scalar = x;
    return value;
  };
  const auto vector = [&](ValueType type, const proto::Vec3& x) -> Expected<SensorValue, std::string> {
    const auto three = take(x);
    if (!three) return Reason(three.error());
    value.type = type;
    value.vector = *three;
    return value;
  };
  switch (in.sensor_case()) {
    case proto::Sensor::kAngle:
      return scalar(ValueType::Angle, in.angle());
    case proto::Sensor::kAngularVelocity1D:
      return scalar(ValueType::AngularVelocity1D, in.angularvelocity1d());
    case proto::Sensor::kTorque1D:
      return scalar(ValueType::Torque1D, in.torque1d());
    case proto::Sensor::kForce1D:
      return scalar(ValueType::Force1D, in.force1d());
    case proto::Sensor::kPosition:
      return vector(ValueType::Position, in.position());
    case proto::Sensor::kRpy:
      return vector(ValueType::Rpy, in.rpy());
    case proto::Sensor::kAcceleration3D:
      return vector(ValueType::Acceleration3D, in.acceleration3d());
    case proto::Sensor::kForce3D:
      return vector(ValueType::Force3D, in.force3d());
    case proto::Sensor::kTorque3D:
      return vector(ValueType::Torque3D, in.torque3d());
    case proto::Sensor::kAngularAcceleration3D:
      return vector(ValueType::AngularAcceleration3D, in.angularacceleration3d());
    case proto::Sensor::kVelocity3D:
      return vector(ValueType::Velocity3D, in.velocity3d());
    case proto::Sensor::kAngularVelocity3D:
      return vector(ValueType::AngularVelocity3D, in.angularvelocity3d());
    case proto::Sensor::kActivated:
      value.type = ValueType::Activated;
      value.is_active = in.activated();
      return value;
    case proto::Sensor::SENSOR_NOT_SET:
      break;
  }
  return Reason("a sensor without a value");
}

/// Appends the values of a list; the reason when one has none.
template <class List>
std::string take_all(const List& list, std::vector<SensorValue>& values) {
  for (const proto::Sensor& in : list) {
    const auto value = take(in);
    if (!value) return value.error();
    values.push_back(*value);
  }
  return {};
}

Expected<ObjectSensors, std::string> take(const proto::SensorMessage_Object& in) {
  ObjectSensors object;
  object.angles.assign(in.anglesensors().begin(), in.anglesensors().end());
  object.velocities.assign(in.angularvelocitysensors().begin(), in.angularvelocitysensors().end());
  object.torques.assign(in.torquesensors().begin(), in.torquesensors().end());
  for (const proto::Vec3& force : in.forcesensors()) {
    const auto three = take(force);
    if (!three) return Reason(three.error());
    object.forces.push_back(*three);
  }
  std::string trouble = take_all(in.objectsensors(), object.object);
  for (const auto& [name, sensors] : in.sensors()) {
    if (trouble.empty()) trouble = take_all(sensors.sensor(), object.sensors[name]);
  }
  if (!trouble.empty()) return Reason(std::move(trouble));
  return object;
}

ObjectDescription take(const proto::HandshakeMessage_Object& in) {
  ObjectDescription object;
  object.controls.assign(in.controlsinorder().begin(), in.controlsinorder().end());
  object.control_types = types_of(in.controltypesinorder());
  object.joints.assign(in.jointsensorsinorder().begin(), in.jointsensorsinorder().end());
  object.joint_sensors = types_of(in.jointsensors());
  object.object_sensors = types_of(in.objectsensors());
  for (const auto& [name, type] : in.controlevents()) object.events[name] = static_cast<ValueType>(type);
  for (const auto& [name, sensors] : in.sensors()) object.sensors[name] = types_of(sensors.types());
  return object;
}

using Decoded = Expected<Message, std::string>;
const char* const kGarbled = "the frame cannot be read";

Decoded decode_control(std::string_view frame) {
  Room room;
  auto& in = *room.make<proto::ControlMessage>();
  if (!parse(frame, in)) return Reason(kGarbled);
  Control control;
  for (const auto& [name, object] : in.objects()) {
    auto taken = take(name, object);
    if (!taken) return Reason(taken.error());
    control.objects.insert_or_assign(name, std::move(*taken));
  }
  return Message(std::move(control));
}

Decoded decode_sensor(std::string_view frame) {
  Room room;
  auto& in = *room.make<proto::SensorMessage>();
  if (!parse(frame, in)) return Reason(kGarbled);
  Sensor sensor;
  sensor.time = in.simvars().simulatedtime();
  for (const auto& [name, object] : in.objects()) {
    auto taken = take(object);
    if (!taken) return Reason(fmt::format("object '{}': {}", name, taken.error()));
    sensor.objects.insert_or_assign(name, std::move(*taken));
  }
  return Message(std::move(sensor));
}

/// Where only the older, scene-wide type was sent, it is that of every joint.
Decoded decode_handshake(std::string_view frame) {
  proto::HandshakeMessage in;
  if (!parse(frame, in)) return Reason(kGarbled);
  Handshake handshake;
  handshake.version = in.version();
  handshake.time_step = in.simsettings().timestep();
  for (const auto& [name, object] : in.objects()) {
    ObjectDescription description = take(object);
    if (description.control_types.empty()) {
      description.control_types.assign(description.controls.size(), static_cast<ValueType>(in.controltype()));
    }
    handshake.objects[name] = std::move(description);
  }
  return Message(std::move(handshake));
}

}  // namespace

Expected<ObjectSensors, std::string> wire::decode_object(std::string_view bytes) {
  const google::protobuf::LogSilencer silencer;
  Room room;
  auto& in = *room.make<proto::SensorMessage_Object>();
  if (!parse(bytes, in)) return Reason(kGarbled);
  return take(in);
}

const char* name_of(ValueType type) {
  switch (type) {
    case ValueType::Angle:
      return "Angle";
    case ValueType::AngularVelocity1D:
      return "AngularVelocity1D";
    case ValueType::Torque1D:
      return "Torque1D";
    case ValueType::Position:
      return "Position";
    case ValueType::Rpy:
      return "RPY";
    case ValueType::Activated:
      return "Activated";
    case ValueType::Acceleration3D:
      return "Acceleration3D";
    case ValueType::Force3D:
      return "Force3D";
    case ValueType::Torque3D:
      return "Torque3D";
    case ValueType::AngularAcceleration3D:
      return "AngularAcceleration3D";
    case ValueType::Velocity3D:
      return "Velocity3D";
    case ValueType::AngularVelocity3D:
      return "AngularVelocity3D";
    case ValueType::Force1D:
      return "Force1D";
    case ValueType::Multiple:
      return "Multiple";
  }
  return "unknown";
}

const char* name_of(const Message& message) {
  static constexpr const char* kNames[] = {"HandshakeInit", "Handshake", "Control",      "Sensor",
                                           "Reset",         "Error",     "SensorRequest"};
  return kNames[message.index()];
}

std::string encode(const Message& message) {
  return std::visit([](const auto& alternative) { return encode_one(alternative); }, message);
}

Decoded decode(std::string_view frame) {
  const google::protobuf::LogSilencer silencer;  // strangers' frames are told by the reason, not on stderr
  proto::Message head;
  if (!parse(frame, head)) return Reason(kGarbled);
  switch (head.messagetype()) {
    case proto::MessageType::HandshakeInit: {
      proto::HandshakeInitMessage in;
      if (!parse(frame, in)) return Reason(kGarbled);
      return Message(HandshakeInit{in.version()});
    }
    case proto::MessageType::Handshake:
      return decode_handshake(frame);
    case proto::MessageType::Control:
      return decode_control(frame);
    case proto::MessageType::Sensor:
      return decode_sensor(frame);
    case proto::MessageType::Reset:
      return Message(Reset{});
    case proto::MessageType::SensorRequest:
      return Message(SensorRequest{});
    case proto::MessageType::Error: {
      proto::ErrorMessage in;
      if (!parse(frame, in)) return Reason(kGarbled);
      return Message(Error{in.errormessage()});
    }
    default:
      return Reason(fmt::format("message type {} is unknown", static_cast<int>(head.messagetype())));
  }
}

}  // namespace snug::click
