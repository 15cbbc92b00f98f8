// Host: what a URScript program can ask of the controller that it runs on, and what it leaves there.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "snug/spatial/pose.hpp"

namespace snug::urscript {

inline constexpr std::size_t kJoints = 6;
using Joints = std::array<double, kJoints>;  ///< rad, rad/s or rad/s^2

struct JointTarget {
  Joints q{};    ///< rad
  Joints qd{};   ///< rad/s
  Joints qdd{};  ///< rad/s^2
  bool operator==(const JointTarget&) const = default;
};

/// What programs and clients share: numbered as the registers of RTDE are.
struct Registers {
  std::array<bool, 128> bits{};
  std::array<std::int32_t, 48> integers{};
  std::array<double, 48> floats{};
  bool operator==(const Registers&) const = default;
};

/// Mass at the flange, as set_target_payload has it.
struct Payload {
  double mass = 0.0;                ///< kg
  Vector3 com_F = Vector3::Zero();  ///< m, from the flange
  /// kg m^2 about the centre of mass in the flange's axes: Ixx, Iyy, Izz, Ixy, Ixz, Iyz.
  std::array<double, 6> inertia_F{};
  bool operator==(const Payload&) const = default;
};

/// A controller as a program sees it: plain data that the host owns. F: the flange (tool0), E: the TCP, Base: the
/// robot's base in the controller's sense. Bits of inputs and outputs are those of RTDE's actual_digital_input_bits:
/// 0-7 standard, 8-15 configurable, 16-17 tool.
struct ControllerState {
  // Written by the host before each step.
  Joints q{};                             ///< actual
  Joints qd{};                            ///< actual
  Wrench F_Eo_Base;                       ///< on the TCP, in the base's axes, as actual_TCP_force
  std::uint32_t digital_inputs = 0;       ///< see above
  std::array<double, 4> analog_inputs{};  ///< V or A: standard 0 and 1, tool 0 and 1
  Registers inputs;
  double speed_fraction = 1.0;           ///< the slider, [0, 1]: time of motions passes so fast
  bool is_protectively_stopped = false;  ///< the arm stands; when false again it returns to its path, and goes on there
  bool has_popup = false;                ///< set by a blocking popup; the program goes on when the host has cleared it

  // Written by programs; the host may write it between steps, as clients do.
  std::uint32_t digital_outputs = 0;
  std::array<double, 2> analog_outputs{};  ///< V or A
  Registers outputs;
  Pose X_FE;  ///< tool centre point
  Payload payload;
  Vector3 gravity_Base{0.0, 0.0, 9.82};  ///< m/s^2, as set_gravity has it: upwards
  int tool_voltage = 0;                  ///< V: 0, 12 or 24
  /// Set by protective_stop, and by motions that would leave the arm's reach or limits; the host ends the program and
  /// clears it.
  bool wants_protective_stop = false;
  std::string stop_reason;  ///< of such a motion; empty: the program asked for the stop

  /// Where the arm is to be at the end of this period; equal to where it is told to stand when nothing moves it.
  JointTarget target;
};

struct ArmLimits {
  Joints lower{};             ///< rad
  Joints upper{};             ///< rad
  Joints max_speed{};         ///< rad/s
  Joints max_acceleration{};  ///< rad/s^2, of motions that a program gives no smaller one
};

enum class MessageKind { Text, Popup };
/// textmsg and popup.
struct Message {
  MessageKind kind = MessageKind::Text;
  std::string text;
  std::string title;  ///< of a popup
  bool is_warning = false;
  bool is_error = false;
  bool is_blocking = false;
};

enum class SocketState { Closed, Opening, Open };

/// A controller. Nothing here may block: a Machine asks again in the next period.
class Host {
 public:
  virtual ~Host() = default;

  [[nodiscard]] virtual ControllerState& state() = 0;
  [[nodiscard]] virtual const ControllerState& state() const = 0;
  /// s, of one step of the machine: 0.008 on a CB3, 0.002 on an e-Series.
  [[nodiscard]] virtual double period() const = 0;
  [[nodiscard]] virtual const ArmLimits& limits() const = 0;
  /// X_BaseF.
  [[nodiscard]] virtual Pose forward(const Joints& q) const = 0;
  /// The joints for X_BaseF that are nearest to `near`, within the limits of positions; none: out of reach.
  [[nodiscard]] virtual std::optional<Joints> inverse(const Pose& X_BaseF, const Joints& near) const = 0;
  virtual void show(const Message& message) = 0;
  /// How often clients have set this input of RTDE so far; none: there is no such input.
  [[nodiscard]] virtual std::optional<std::uint64_t> input_count(std::string_view name) const;

  /// Sockets have names. Opening, then Open or Closed when asked again; a host without sockets says Closed.
  [[nodiscard]] virtual SocketState open_socket(std::string_view name, std::string_view address, int port);
  [[nodiscard]] virtual SocketState socket_state(std::string_view name);
  /// False: not open, or its buffer is full.
  virtual bool send(std::string_view name, std::string_view bytes);
  /// What came since: appended to `buffer`, until that holds at most `most` bytes.
  virtual void receive(std::string_view name, std::string& buffer, std::size_t most);
  virtual void close_socket(std::string_view name);
};

}  // namespace snug::urscript
