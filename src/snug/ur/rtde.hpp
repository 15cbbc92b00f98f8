// RTDE: frames, recipes and fields of the real-time data exchange, versions 1 and 2.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/ur/bytes.hpp"
#include "snug/ur/robot_data.hpp"

namespace snug::ur {

namespace rtde {
/// Types of frames.
enum class Frame : std::uint8_t {
  Version = 'V',
  ControllerVersion = 'v',
  Text = 'M',
  Data = 'U',
  Outputs = 'O',
  Inputs = 'I',
  Start = 'S',
  Pause = 'P'
};
/// u16 size with these three bytes, u8 type, payload. The payload has at most 65532 bytes (checked).
[[nodiscard]] std::string encode(Frame type, std::string_view payload);

struct FrameView {
  std::uint8_t type = 0;
  std::string_view payload;
};
/// What the frame at the beginning of `bytes` is, none when it is not whole yet; `size`: bytes to go on behind. Broken:
/// a type that is unknown, or a size that the type cannot have; what follows cannot be read.
struct NextFrame {
  std::optional<FrameView> frame;
  std::size_t size = 0;
  bool is_broken = false;
};
enum class From { Client, Controller };
[[nodiscard]] NextFrame next_frame(std::string_view bytes, From sender = From::Client);

/// The type of an output or input field ("VECTOR6D"), nullptr for a name that is not known.
[[nodiscard]] const char* output_type(std::string_view name);
[[nodiscard]] const char* input_type(std::string_view name);
/// An output that no robot has, BOOL: who asks for it, and sets inputs, sets the pace of a served cell, a period for
/// each of its data packages.
inline constexpr const char* kLockstep = "snug_lockstep";
/// How often this input was set; none: it is not known.
[[nodiscard]] std::optional<std::uint64_t> input_count(const RobotInputs& inputs, std::string_view name);
/// All names, for documents and tests, registers with their numbers.
[[nodiscard]] std::vector<std::string> output_names();
[[nodiscard]] std::vector<std::string> input_names();
}  // namespace rtde

/// Which connection holds which input. An input is one connection's until that ends.
class InputOwners {
 public:
  /// True: it is `connection`'s from now on, or was.
  bool claim(std::string_view name, int connection);
  [[nodiscard]] bool is_taken(std::string_view name, int connection) const;
  void release(int connection);

 private:
  std::map<std::string, int, std::less<>> owners_;
};

/// One client of RTDE, without its socket.
class RtdeSession {
 public:
  RtdeSession(const ModelFacts& facts, int connection, InputOwners& owners);
  ~RtdeSession();
  RtdeSession(const RtdeSession&) = delete;
  RtdeSession& operator=(const RtdeSession&) = delete;

  struct Reply {
    std::string bytes;         ///< to be sent
    bool sets_inputs = false;  ///< `inputs` has changed
  };
  /// Answers one frame. What clients set goes to `inputs`.
  [[nodiscard]] Reply answer(const rtde::FrameView& frame, RobotInputs& inputs);
  /// The data package of this period; empty when there is none: not started, or slower than the controller.
  [[nodiscard]] std::string package(const RobotData& data, std::int64_t period);

  [[nodiscard]] bool is_started() const { return is_started_; }
  /// It is started with rtde::kLockstep among its outputs, and has inputs.
  [[nodiscard]] bool sets_pace() const { return is_started_ && wants_lockstep_ && !inputs_.empty(); }
  [[nodiscard]] double frequency() const { return frequency_; }

  static constexpr std::size_t kMostRecipes = 255;  ///< of inputs
  static constexpr std::size_t kMostFields = 1024;  ///< of a recipe

 private:
  struct InputRecipe {
    std::vector<std::size_t> fields;  ///< places in the list of fields
    std::size_t size = 0;             ///< bytes
  };
  [[nodiscard]] std::string set_up_outputs(std::string_view payload);
  [[nodiscard]] std::string set_up_inputs(std::string_view payload);
  [[nodiscard]] bool take_data(std::string_view payload, RobotInputs& inputs) const;
  [[nodiscard]] std::string message(std::string_view text) const;

  const ModelFacts& facts_;
  int connection_;
  InputOwners& owners_;
  int version_ = 1;
  double frequency_;                  ///< Hz
  std::vector<std::size_t> outputs_;  ///< places in the list of fields
  bool has_outputs_ = false, is_refused_ = false, is_started_ = false;
  bool wants_lockstep_ = false;
  std::vector<InputRecipe> inputs_;
};

}  // namespace snug::ur
