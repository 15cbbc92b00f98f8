// McapSchema: the JSON schemas of the messages that a recording becomes, under the names that common viewers know.
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
};

[[nodiscard]] std::string schema_name(McapSchema schema);
/// JSON Schema (2020-12) of the messages of that name.
[[nodiscard]] std::string schema_text(McapSchema schema);

}  // namespace snug::replay
