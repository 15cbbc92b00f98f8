// RobotData, RobotInputs: what a UR controller tells its clients in one period, and what they set.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace snug::ur {

using Values3 = std::array<double, 3>;
using Values6 = std::array<double, 6>;

/// Numbers as the controller sends them.
enum class RobotMode : std::int32_t { PowerOff = 3, PowerOn = 4, Idle = 5, Running = 7 };
enum class SafetyMode : std::int32_t { Normal = 1, ProtectiveStop = 3, Fault = 9 };
enum class RuntimeState : std::uint32_t {
  Stopping = 0,
  Stopped = 1,
  Playing = 2,
  Pausing = 3,
  Paused = 4,
  Resuming = 5
};

[[nodiscard]] const char* name_of(RobotMode mode);
[[nodiscard]] const char* name_of(SafetyMode mode);

/// What the simulation has no model of is told as a robot at rest tells it.
inline constexpr double kSupplyVoltage = 48.0;  ///< V, of the robot while it has power
inline constexpr double kTemperature = 25.0;    ///< degrees Celsius, of everything

enum class Model { Ur10, Ur10e, Ur5e, Ur3e, Ur16e, Ur20, Ur30 };

/// What a model of the robot is to its clients.
struct ModelFacts {
  Model model = Model::Ur10;
  const char* name = "";       ///< of the option
  const char* dashboard = "";  ///< as the dashboard and URCL call it
  bool is_e_series = false;
  int rate = 125;                          ///< Hz
  std::array<std::uint32_t, 4> version{};  ///< major, minor, bugfix, build
  std::int32_t robot_type = 2;
};
[[nodiscard]] const ModelFacts& facts_of(Model model);
/// In the order of Model.
[[nodiscard]] std::span<const ModelFacts> all_models();

struct Registers {
  std::array<bool, 128> bits{};
  std::array<std::int32_t, 48> ints{};
  std::array<double, 48> doubles{};
  bool operator==(const Registers&) const = default;
};

/// SI, rad; poses are position and rotation vector in the robot's base. At the end of a period.
struct RobotData {
  double timestamp = 0.0;  ///< s, since the controller started
  Values6 target_q{}, target_qd{}, target_qdd{}, target_current{}, target_moment{};
  Values6 actual_q{}, actual_qd{}, actual_current{}, joint_control_output{};
  Values6 actual_tcp_pose{}, actual_tcp_speed{}, actual_tcp_force{}, target_tcp_pose{}, target_tcp_speed{};
  Values6 ft_raw_wrench{};  ///< as actual_tcp_force, without what was zeroed
  Values6 tcp_offset{};
  double payload = 0.0;  ///< kg
  Values3 payload_cog{};
  Values3 tool_acceleration{};  ///< m/s^2, of the tool with gravity
  Values3 elbow_position{};
  std::uint64_t digital_inputs = 0, digital_outputs = 0;  ///< bits 0-7 standard, 8-15 configurable, 16-17 tool
  std::array<double, 2> analog_inputs{};                  ///< V
  std::array<double, 2> analog_outputs{};                 ///< V
  std::array<double, 2> tool_analog_inputs{};             ///< V
  RobotMode robot_mode = RobotMode::PowerOff;
  SafetyMode safety_mode = SafetyMode::Normal;
  RuntimeState runtime_state = RuntimeState::Stopped;
  double speed_scaling = 1.0;          ///< of the programs' motions, now
  double target_speed_fraction = 1.0;  ///< of the slider
  double momentum = 0.0;               ///< kg m/s
  double execution_time = 0.0;         ///< s, that the last period took
  Registers outputs, inputs;

  [[nodiscard]] bool is_program_running() const {
    return runtime_state != RuntimeState::Stopped && runtime_state != RuntimeState::Paused;
  }
  [[nodiscard]] bool is_powered() const { return robot_mode != RobotMode::PowerOff; }
  /// Of all joints: 253 running, 255 idle, 239 without power.
  [[nodiscard]] std::int32_t joint_mode() const {
    return robot_mode == RobotMode::Running ? 253 : robot_mode == RobotMode::Idle ? 255 : 239;
  }
};

/// What never changes: how the arm is built and what it may do. SI, rad.
struct RobotFacts {
  Values6 dh_a{}, dh_d{}, dh_alpha{}, dh_theta{};
  Values6 joint_min{}, joint_max{}, joint_speed{}, joint_acceleration{};
};

/// What clients set through RTDE; masks say which of the bits are meant, and are used up when they are applied.
struct RobotInputs {
  std::uint32_t speed_slider_mask = 0;
  double speed_slider_fraction = 1.0;
  std::uint8_t standard_mask = 0, standard = 0, configurable_mask = 0, configurable = 0, tool_mask = 0, tool = 0;
  std::uint8_t analog_mask = 0, analog_type = 0;
  std::array<double, 2> analog{};  ///< 0 .. 1
  Values6 external_force_torque{};
  Registers registers;
  /// How often each was set: by rtde::input_count().
  std::vector<std::uint64_t> counts;
  bool operator==(const RobotInputs&) const = default;
};

}  // namespace snug::ur
