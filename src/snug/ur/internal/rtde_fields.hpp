// The fields of RTDE: name, type, and how each is written or read.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "snug/ur/bytes.hpp"
#include "snug/ur/robot_data.hpp"

namespace snug::ur::internal {

struct OutputField {
  std::string name;
  const char* type = "";
  std::function<void(const RobotData&, ByteWriter&)> write;
};
struct InputField {
  std::string name;
  const char* type = "";
  std::size_t size = 0;  ///< bytes
  /// `read` takes the value of the field; a number that is not finite is read and left out.
  std::function<void(ByteReader&, RobotInputs&)> read;
};

/// In the order of names.
[[nodiscard]] const std::vector<OutputField>& output_fields();
[[nodiscard]] const std::vector<InputField>& input_fields();

}  // namespace snug::ur::internal
