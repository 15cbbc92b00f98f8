// SensorReader: the Sensor of a frame after the Sensor before it: what stayed the same is not read again.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "snug/click/message.hpp"

namespace snug::click::internal {

/// Of each answer of a cell most objects are at rest: their bytes are those of the answer before.
class SensorReader {
 public:
  /// What decode() makes of the frame. Nullptr where that takes more than the last learned frame tells: another kind of
  /// message, other objects, other fields, an object that cannot be read. Valid until the next call.
  [[nodiscard]] const Sensor* read(std::string_view frame);
  /// `sensor` is what decode() made of the frame. Returns it, valid until the next call.
  const Sensor& learn(std::string_view frame, Sensor sensor);

 private:
  struct Object {
    std::string name, bytes;
    ObjectSensors* sensors = nullptr;  ///< in sensor_
  };
  Sensor sensor_;
  std::vector<Object> objects_;  ///< in the order of the frame; none where frames cannot be compared
};

}  // namespace snug::click::internal
