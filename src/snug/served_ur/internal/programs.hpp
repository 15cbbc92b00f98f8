// Programs: what the controller runs of URScript: one program that moves the arm, and secondary ones beside it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "snug/served_ur/internal/script_sockets.hpp"
#include "snug/served_ur/ur_arm.hpp"
#include "snug/ur/rtde.hpp"
#include "snug/urscript/host.hpp"
#include "snug/urscript/machine.hpp"

namespace snug::served_ur::internal {

/// What became of programs, for the clients.
struct ProgramNews {
  enum class Kind { Started, Stopped, Failed, Halted, Text } kind = Kind::Started;
  std::string text;  ///< the program's name; what is wrong; the message
  int line = 0;      ///< Failed, Halted, from 1; 0: of no line
  int column = 0;
};

class Programs final : private urscript::Host {
 public:
  /// Arm and inputs outlive the programs. `period`: s. `lets_out`: programs may open sockets to other machines.
  /// `inputs`: what clients have set, of the controller.
  Programs(const UrArm& arm, double period, bool lets_out, const ur::RobotInputs& inputs);

  /// Starts the program and stops the one that ran; a secondary one runs beside it. What is no program is news.
  /// `data`: where the arm stands; `may_move`: else only a secondary one starts.
  void start(std::string_view text, const ur::RobotData& data, bool may_move);
  /// The arm brakes; the program ends once it is at rest.
  void stop();
  /// It ends now: the arm stands.
  void abort();
  bool pause();
  bool resume();
  /// Why the arm is to stop for protection: a program asked for it, or a motion would leave the arm's reach or limits.
  /// None: no stop since this was asked last.
  [[nodiscard]] std::optional<std::string> take_protective_stop();
  /// The program goes on behind its popup.
  void close_popup() { state_.has_popup = false; }

  [[nodiscard]] bool is_active() const { return main_.has_value(); }
  [[nodiscard]] bool is_paused() const { return main_ && main_->is_paused(); }
  /// Of the program that runs or ran last; empty before the first.
  [[nodiscard]] const std::string& name() const { return name_; }

  /// One period: programs read `data` and write its targets, outputs and output registers, TCP and payload.
  void step(ur::RobotData& data);
  [[nodiscard]] std::vector<ProgramNews> take_news() { return std::exchange(news_, {}); }

  static constexpr std::size_t kMostSecondary = 16;  ///< at once
  static constexpr std::size_t kMostNews = 1000;     ///< in a period

 private:
  [[nodiscard]] urscript::ControllerState& state() override { return state_; }
  [[nodiscard]] const urscript::ControllerState& state() const override { return state_; }
  [[nodiscard]] double period() const override { return period_; }
  [[nodiscard]] const urscript::ArmLimits& limits() const override { return limits_; }
  [[nodiscard]] Pose forward(const urscript::Joints& q) const override { return arm_.forward(q); }
  [[nodiscard]] std::optional<urscript::Joints> inverse(const Pose& X_BaseF,
                                                        const urscript::Joints& near) const override {
    return arm_.inverse(X_BaseF, near);
  }
  void show(const urscript::Message& message) override;
  [[nodiscard]] std::optional<std::uint64_t> input_count(std::string_view name) const override {
    return ur::rtde::input_count(inputs_, name);
  }
  [[nodiscard]] urscript::SocketState open_socket(std::string_view name, std::string_view address, int port) override {
    return sockets_.open(name, address, port);
  }
  [[nodiscard]] urscript::SocketState socket_state(std::string_view name) override { return sockets_.state(name); }
  bool send(std::string_view name, std::string_view bytes) override { return sockets_.send(name, bytes); }
  void receive(std::string_view name, std::string& buffer, std::size_t most) override {
    sockets_.receive(name, buffer, most);
  }
  void close_socket(std::string_view name) override { sockets_.close(name); }

  void read(const ur::RobotData& data);
  void write(ur::RobotData& data) const;
  void tell(ProgramNews news);

  const UrArm& arm_;
  const ur::RobotInputs& inputs_;
  double period_;
  urscript::ArmLimits limits_;
  urscript::ControllerState state_;
  ScriptSockets sockets_;
  std::optional<urscript::Machine> main_;
  std::vector<urscript::Machine> secondary_;
  std::string name_;
  std::vector<ProgramNews> news_;
};

}  // namespace snug::served_ur::internal
