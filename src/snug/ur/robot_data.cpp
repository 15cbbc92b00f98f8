// RobotData, RobotInputs: what a UR controller tells its clients in one period, and what they set.
#include "snug/ur/robot_data.hpp"

namespace snug::ur {

const char* name_of(RobotMode mode) {
  switch (mode) {
    case RobotMode::PowerOff:
      return "POWER_OFF";
    case RobotMode::PowerOn:
      return "POWER_ON";
    case RobotMode::Idle:
      return "IDLE";
    case RobotMode::Running:
      return "RUNNING";
  }
  return "";
}

const char* name_of(SafetyMode mode) {
  switch (mode) {
    case SafetyMode::Normal:
      return "NORMAL";
    case SafetyMode::ProtectiveStop:
      return "PROTECTIVE_STOP";
    case SafetyMode::Fault:
      return "FAULT";
  }
  return "";
}

const ModelFacts& facts_of(Model model) {
  static constexpr ModelFacts kUr10{Model::Ur10, "ur10", "UR10", false, 125, {3, 15, 8, 106339}, 2};
  static constexpr ModelFacts kUr10e{Model::Ur10e, "ur10e", "UR10", true, 500, {5, 9, 4, 1031110}, 2};
  static constexpr ModelFacts kUr5e{Model::Ur5e, "ur5e", "UR5", true, 500, {5, 9, 4, 1031110}, 1};
  return model == Model::Ur10 ? kUr10 : model == Model::Ur10e ? kUr10e : kUr5e;
}

}  // namespace snug::ur
