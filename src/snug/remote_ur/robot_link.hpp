// RobotLink: what a plant and the program of ours on the robot tell each other, a package each way in every period.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "snug/ur/robot_data.hpp"

namespace snug::remote_ur {

/// What the robot says at the end of a period. SI, rad; frames as in ur::RobotData.
struct RobotSample {
  double timestamp = 0.0;  ///< s, of the controller
  ur::Values6 q{}, qd{}, target_q{}, torques{};
  ur::Values6 tcp_force{};  ///< on the tool without the payload, about the TCP, in the axes of Base
  std::uint64_t digital_inputs = 0, digital_outputs = 0;
  std::array<double, 4> analog_inputs{};  ///< V or A: standard 0 and 1, tool 0 and 1
  double speed = 1.0;                     ///< of the slider, 0 .. 1
  int robot_mode = 0, safety_mode = 0;    ///< as the controller numbers them: 7 and 1 are what motion needs
  int runtime_state = 0;                  ///< of programs: ur::RuntimeState
  /// Of the load that `tcp_force` is without; none: the software does not tell.
  std::optional<double> payload;
  ur::Values3 payload_cog{};
  std::int32_t script = 0;  ///< script_word() of the program that ran last
  int late = 0;             ///< periods in which the program had no new target
};

/// What the program on the robot is about.
enum class ScriptState : std::int32_t {
  None = 0,
  Follows = 1,
  Ended = 2,   ///< as it was told
  Silent = 3,  ///< the targets stopped coming, or came back too far away: the arm stands, outputs are as they were
};

/// What a program that was told this number writes.
[[nodiscard]] constexpr std::int32_t script_word(std::int32_t number, ScriptState state) {
  return 10 * number + static_cast<std::int32_t>(state);
}

/// Upper half: fieldbuses have the lower one.
inline constexpr int kFirstRegister = 24;

/// What the client says for the coming period.
struct RobotCommand {
  enum class Mode : std::int32_t {
    Stands = 0,
    Moves = 1,
    Ends = 2,  ///< the program is to end
  };
  std::int32_t count = 0;  ///< of commands
  Mode mode = Mode::Stands;
  std::array<ur::Values6, 3> q{};              ///< rad: the target of this period and of the two before
  double payload = 0.0;                        ///< kg
  ur::Values3 payload_cog{};                   ///< m, in the flange
  std::int32_t payload_count = 0;              ///< of changes of the payload
  std::uint64_t outputs = 0, output_mask = 0;  ///< digital, bits as in ur::RobotData

  /// Registers of integers and of numbers, from kFirstRegister on.
  [[nodiscard]] std::array<std::int32_t, 3> integers() const;
  [[nodiscard]] std::array<double, 22> numbers() const;
};

/// A controller: behind sockets, or stepped in a test. Failures are texts; empty: none.
class RobotLink {
 public:
  virtual ~RobotLink() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual double period() const = 0;  ///< s
  /// Software 5 and later.
  [[nodiscard]] virtual bool is_e_series() const = 0;
  /// The command acts in the next period; `sample`: at its end.
  [[nodiscard]] virtual std::string exchange(const RobotCommand& command, RobotSample& sample) = 0;
  /// Starts a program, in the place of the one that runs. Whether it runs, samples tell.
  [[nodiscard]] virtual std::string start(const std::string& program) = 0;
  /// What is known of why the last program does not run; may be empty.
  [[nodiscard]] virtual std::string why_not() = 0;
  /// Asks to release a protective stop. Whether it is, samples tell.
  [[nodiscard]] virtual std::string unlock() = 0;
};

}  // namespace snug::remote_ur
