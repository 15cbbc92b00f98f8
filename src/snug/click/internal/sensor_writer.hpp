// write_sensor: the bytes of a Sensor without building protobuf's message first: that took most of an answer.
#pragma once

#include <string>

#include "snug/click/message.hpp"

namespace snug::click::internal {

/// The bytes that protobuf makes of it (SensorMessage of click.proto), deterministic.
[[nodiscard]] std::string write_sensor(const Sensor& sensor);

}  // namespace snug::click::internal
