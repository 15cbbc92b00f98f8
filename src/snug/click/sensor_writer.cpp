// write_sensor: from the last byte to the first, so that the length of a part is known when it has to be written.
#include "snug/click/sensor_writer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "snug/core/check.hpp"

namespace snug::click::wire {
namespace {

/// Field numbers, as in click.proto; all fit into tags of one byte.
enum Field : unsigned { kNumbers = 1, kSensorOfList = 1 };
enum ObjectField : unsigned { kAngles = 1, kVelocities = 2, kTorques = 3, kObjectSensors = 4, kForces = 5, kNamed = 6 };

unsigned field_of(ValueType type) {
  switch (type) {
    case ValueType::Angle:
      return 1;
    case ValueType::AngularVelocity1D:
      return 2;
    case ValueType::Torque1D:
      return 3;
    case ValueType::Position:
      return 4;
    case ValueType::Rpy:
      return 5;
    case ValueType::Activated:
      return 6;
    case ValueType::Acceleration3D:
      return 7;
    case ValueType::Force3D:
      return 8;
    case ValueType::Torque3D:
      return 9;
    case ValueType::AngularAcceleration3D:
      return 10;
    case ValueType::Velocity3D:
      return 12;
    case ValueType::AngularVelocity3D:
      return 13;
    case ValueType::Force1D:
      return 14;
    case ValueType::Multiple:
      break;
  }
  SNUG_CHECK(false, "a sensor has one type");
}

/// Everything is put in front of what is there.
class FrontWriter {
 public:
  explicit FrontWriter(std::size_t room) { bytes_.reserve(room); }

  void tag(unsigned field, WireType type) { bytes_.push_back(static_cast<char>(field << 3U | type)); }
  void number(double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    std::array<char, 8> bytes{};
    for (unsigned i = 0; i < 8; ++i) bytes[i] = static_cast<char>(bits >> (56 - 8 * i) & 0xFFU);
    bytes_.append(bytes.data(), bytes.size());
  }
  void varint(std::size_t value) {
    if (value >= 0x80) {
      varint(value >> 7U);
      bytes_.push_back(static_cast<char>((value & 0x7FU) | 0x80U));
    } else {
      bytes_.push_back(static_cast<char>(value));
    }
  }
  void text(const std::string& text) { bytes_.append(text.rbegin(), text.rend()); }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  /// The field around all that was put since `size` was `end`.
  void enclose(unsigned field, std::size_t end) {
    varint(size() - end);
    tag(field, kBytes);
  }
  [[nodiscard]] std::string take() {
    std::reverse(bytes_.begin(), bytes_.end());
    return std::move(bytes_);
  }

 private:
  std::string bytes_;  ///< the last one first
};

void put(std::span<const double> numbers, unsigned field, FrontWriter& out) {
  if (numbers.empty()) return;
  const std::size_t end = out.size();
  for (std::size_t i = numbers.size(); i-- > 0;) out.number(numbers[i]);
  out.enclose(field, end);
}

void put(const Vector3& vector, unsigned field, FrontWriter& out) {
  const std::size_t end = out.size();
  put(std::span(vector.data(), 3), kNumbers, out);
  out.enclose(field, end);
}

void put(const SensorValue& value, unsigned field, FrontWriter& out) {
  const std::size_t end = out.size();
  const unsigned kind = field_of(value.type);
  switch (value.type) {
    case ValueType::Angle:
    case ValueType::AngularVelocity1D:
    case ValueType::Torque1D:
    case ValueType::Force1D:
      out.number(value.scalar);
      out.tag(kind, kDouble);
      break;
    case ValueType::Activated:
      out.varint(value.is_active ? 1 : 0);
      out.tag(kind, kVarint);
      break;
    default:
      put(value.vector, kind, out);
  }
  out.enclose(field, end);
}

void put(const std::vector<SensorValue>& values, unsigned field, FrontWriter& out) {
  for (auto value = values.rbegin(); value != values.rend(); ++value) put(*value, field, out);
}

/// An entry of a map: its key in front of the value, which was put since `end`.
void put_entry(const std::string& name, unsigned field, std::size_t end, FrontWriter& out) {
  out.enclose(kEntryValue, end);
  const std::size_t value = out.size();
  out.text(name);
  out.enclose(kEntryKey, value);
  out.enclose(field, end);
}

void put(const ObjectSensors& object, FrontWriter& out) {
  for (auto named = object.sensors.rbegin(); named != object.sensors.rend(); ++named) {
    const std::size_t end = out.size();
    put(named->second, kSensorOfList, out);
    put_entry(named->first, kNamed, end, out);
  }
  for (auto force = object.forces.rbegin(); force != object.forces.rend(); ++force) put(*force, kForces, out);
  put(object.object, kObjectSensors, out);
  put(object.torques, kTorques, out);
  put(object.velocities, kVelocities, out);
  put(object.angles, kAngles, out);
}

}  // namespace

std::string begin_sensor() {
  FrontWriter out(2);
  out.varint(kSensorType);
  out.tag(kType, kVarint);
  return out.take();
}

std::string write_object(const std::string& name, const ObjectSensors& object) {
  FrontWriter out(1024);
  const std::size_t end = out.size();
  put(object, out);
  put_entry(name, kObjects, end, out);
  return out.take();
}

std::string end_sensor(double time) {
  FrontWriter out(16);
  const std::size_t end = out.size();
  if (std::bit_cast<std::uint64_t>(time) != 0) {
    out.number(time);
    out.tag(kSimulatedTime, kDouble);
  }
  out.enclose(kSimVars, end);
  return out.take();
}

std::string write_sensor(const Sensor& sensor) {
  std::string frame = begin_sensor();
  for (const auto& [name, object] : sensor.objects) frame += write_object(name, object);
  return frame += end_sensor(sensor.time);
}

}  // namespace snug::click::wire
