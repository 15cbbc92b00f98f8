// write_sensor: the bytes of a Sensor without building protobuf's message first: that took most of an answer.
#pragma once

#include <string>

#include "snug/click/message.hpp"

namespace snug::click::wire {

/// Field numbers of click.proto, for which SensorReader looks too.
enum EntryField : unsigned { kEntryKey = 1, kEntryValue = 2 };
enum MessageField : unsigned { kType = 1, kObjects = 3, kSimVars = 4 };
enum SimVarsField : unsigned { kSimulatedTime = 1 };
enum WireType : unsigned { kVarint = 0, kDouble = 1, kBytes = 2 };
inline constexpr std::size_t kSensorType = 3;  ///< of a message

/// The bytes that protobuf makes of it (SensorMessage of click.proto), deterministic.
[[nodiscard]] std::string write_sensor(const Sensor& sensor);

/// The same in parts, which follow each other: the beginning, each object in the order of names, the end.
[[nodiscard]] std::string begin_sensor();
[[nodiscard]] std::string write_object(const std::string& name, const ObjectSensors& object);
[[nodiscard]] std::string end_sensor(double time);

/// What one object's part of a Sensor says (in message.cpp, as the rest of decoding); the reason why it cannot be read.
[[nodiscard]] Expected<ObjectSensors, std::string> decode_object(std::string_view bytes);

}  // namespace snug::click::wire
