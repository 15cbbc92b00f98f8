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

namespace {

using SoftwareVersion = std::array<std::uint32_t, 4>;
constexpr SoftwareVersion kCb3{3, 15, 8, 106339}, kESeries{5, 9, 4, 1031110}, kLarge{5, 15, 0, 126450};

constexpr std::array kModels = {
    ModelFacts{Model::Ur10, "ur10", "UR10", false, 125, kCb3, 2},
    ModelFacts{Model::Ur10e, "ur10e", "UR10", true, 500, kESeries, 2},
    ModelFacts{Model::Ur5e, "ur5e", "UR5", true, 500, kESeries, 1},
    ModelFacts{Model::Ur3e, "ur3e", "UR3", true, 500, kESeries, 3},
    ModelFacts{Model::Ur16e, "ur16e", "UR16", true, 500, kESeries, 4},
    ModelFacts{Model::Ur20, "ur20", "UR20", true, 500, kLarge, 7},
    ModelFacts{Model::Ur30, "ur30", "UR30", true, 500, kLarge, 8},
};

}  // namespace

const ModelFacts& facts_of(Model model) { return kModels[static_cast<std::size_t>(model)]; }
std::span<const ModelFacts> all_models() { return kModels; }

}  // namespace snug::ur
