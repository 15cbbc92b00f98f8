// McapSchema: the schemas of the messages that a recording becomes, under the names that common viewers know.
#pragma once

#include <string>

namespace snug::replay {

enum class McapSchema {
  FrameTransforms,
  PoseInFrame,
  SceneUpdate,
  Log,
  TwistStamped,
  WrenchStamped,
  JointState,
  String,
  CupState,
  SolverState,
  ProgramState,
  JointStates,  ///< of protocol buffers only, as the next
  Event,
};

/// Of messages as JSON: those of ROS where common viewers know no other.
[[nodiscard]] std::string schema_name(McapSchema schema);
/// Of messages as protocol buffers: the full name of a message in proto/. Of JointState and String, which are there as
/// JSON only, the name is empty.
[[nodiscard]] std::string protobuf_name(McapSchema schema);
/// JSON Schema (2020-12) of the messages of that name; empty where they are there as protocol buffers only.
[[nodiscard]] std::string schema_text(McapSchema schema);

}  // namespace snug::replay
