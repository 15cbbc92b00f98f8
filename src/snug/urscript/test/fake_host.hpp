// FakeHost: an arm of three sliding axes and a ball joint, whose kinematics can be checked by hand; target is reached.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "snug/urscript/machine.hpp"

namespace snug::urscript::test {

class FakeHost : public Host {
 public:
  FakeHost() {
    limits_.lower.fill(-6.3);
    limits_.upper.fill(6.3);
    limits_.max_speed.fill(3.0);
    limits_.max_acceleration.fill(10.0);
  }
  ControllerState& state() override { return state_; }
  const ControllerState& state() const override { return state_; }
  double period() const override { return period_; }
  const ArmLimits& limits() const override { return limits_; }
  Pose forward(const Joints& q) const override {
    return {exp_rotation(Vector3(q[3], q[4], q[5])), Vector3(q[0], q[1], q[2])};
  }
  std::optional<Joints> inverse(const Pose& X, const Joints&) const override {
    if (X.p.norm() > 5.0) return std::nullopt;
    const Vector3 w = log_rotation(X.R);
    return Joints{X.p.x(), X.p.y(), X.p.z(), w.x(), w.y(), w.z()};
  }
  void show(const Message& message) override { messages.push_back(message.text); }
  std::optional<std::uint64_t> input_count(std::string_view name) const override {
    return name == "input_int_register_0" ? std::optional(input_sets) : std::nullopt;
  }
  SocketState open_socket(std::string_view, std::string_view, int) override {
    return is_open = true, SocketState::Open;
  }
  SocketState socket_state(std::string_view) override { return is_open ? SocketState::Open : SocketState::Closed; }
  bool send(std::string_view, std::string_view bytes) override { return sent += bytes, true; }
  void receive(std::string_view, std::string& buffer, std::size_t most) override {
    while (buffer.size() < most && !incoming.empty()) {
      buffer += incoming.front();
      incoming.erase(0, 1);
    }
  }
  void close_socket(std::string_view) override { is_open = false; }

  /// Until it is over; the arm follows its target. At most this many periods.
  Status run(Machine& machine, int most = 100000) {
    for (int i = 0; i < most && machine.status().is_active(); ++i) {
      const JointTarget before = state_.target;
      machine.step(*this);
      for (std::size_t j = 0; j < kJoints; ++j) {
        fastest = std::max(fastest, std::abs(state_.target.qd[j]));
        jump = std::max(jump, std::abs(state_.target.qd[j] - before.qd[j]) / period_);
      }
      state_.q = state_.target.q;
      state_.qd = state_.target.qd;
      way.push_back(state_.q);
    }
    return machine.status();
  }

  ControllerState state_;
  ArmLimits limits_;
  double period_ = 0.008;
  std::vector<std::string> messages;
  std::string sent, incoming;
  std::uint64_t input_sets = 0;  // of input_int_register_0
  bool is_open = false;
  double fastest = 0.0, jump = 0.0;  // rad/s, rad/s^2
  std::vector<Joints> way;
};

}  // namespace snug::urscript::test
