// Programs: what the controller runs of URScript: one program that moves the arm, and secondary ones beside it.
#include "snug/served_ur/internal/programs.hpp"

#include <algorithm>
#include <utility>

namespace snug::served_ur::internal {

using urscript::MachineState;

Programs::Programs(const UrArm& arm, double period, bool lets_out, const ur::RobotInputs& inputs)
    : arm_(arm), inputs_(inputs), period_(period), sockets_(lets_out) {
  limits_.lower = arm.facts().joint_min;
  limits_.upper = arm.facts().joint_max;
  limits_.max_speed = arm.facts().joint_speed;
  limits_.max_acceleration = arm.facts().joint_acceleration;
  state_.X_FE = arm.tool();
  state_.payload.mass = arm.tool_load().mass;
  state_.payload.com_F = arm.tool_load().com;
}

std::optional<std::string> Programs::take_protective_stop() {
  if (!std::exchange(state_.wants_protective_stop, false)) return std::nullopt;
  std::string why = std::exchange(state_.stop_reason, {});
  return why.empty() ? "a program asked for a protective stop" : std::move(why);
}

void Programs::tell(ProgramNews news) {
  if (news_.size() < kMostNews) news_.push_back(std::move(news));
}

void Programs::show(const urscript::Message& message) {
  const bool is_popup = message.kind == urscript::MessageKind::Popup;
  const std::string head = is_popup && !message.title.empty() ? message.title + ": " : "";
  tell({ProgramNews::Kind::Text, head + message.text, 0, 0});
}

void Programs::start(std::string_view text, const ur::RobotData& data, bool may_move) {
  auto program = urscript::parse(text);
  if (!program) {
    const urscript::ScriptError& error = program.error();
    return tell({ProgramNews::Kind::Failed, error.text, error.line, error.column});
  }
  if (program->is_secondary()) {
    if (secondary_.size() >= kMostSecondary) {
      return tell({ProgramNews::Kind::Failed, "too many secondary programs run", 0, 0});
    }
    secondary_.emplace_back(std::move(*program));
    return;
  }
  if (!may_move) return tell({ProgramNews::Kind::Failed, "the robot is not running", 0, 0});
  abort();
  read(data);
  name_ = program->name();
  main_.emplace(std::move(*program));
  tell({ProgramNews::Kind::Started, name_, 0, 0});
}

void Programs::stop() {
  if (main_) main_->stop();
}

void Programs::abort() {
  if (!main_) return;
  main_.reset();
  sockets_.close_all();
  state_.has_popup = false;
  tell({ProgramNews::Kind::Stopped, name_, 0, 0});
}

bool Programs::pause() {
  if (!main_ || main_->is_paused()) return false;
  main_->pause();
  return true;
}

bool Programs::resume() {
  if (!is_paused()) return false;
  main_->resume();
  return true;
}

void Programs::read(const ur::RobotData& data) {
  state_.q = data.actual_q;
  state_.qd = data.actual_qd;
  state_.F_Eo_Base.force = Vector3(data.actual_tcp_force[0], data.actual_tcp_force[1], data.actual_tcp_force[2]);
  state_.F_Eo_Base.torque = Vector3(data.actual_tcp_force[3], data.actual_tcp_force[4], data.actual_tcp_force[5]);
  state_.digital_inputs = static_cast<std::uint32_t>(data.digital_inputs);
  state_.analog_inputs = {data.analog_inputs[0], data.analog_inputs[1], data.tool_analog_inputs[0],
                          data.tool_analog_inputs[1]};
  state_.inputs = {data.inputs.bits, data.inputs.ints, data.inputs.doubles};
  state_.speed_fraction = data.target_speed_fraction;
  state_.digital_outputs = static_cast<std::uint32_t>(data.digital_outputs);
  state_.analog_outputs = data.analog_outputs;
  state_.target = {data.target_q, data.target_qd, data.target_qdd};
}

void Programs::write(ur::RobotData& data) const {
  data.digital_outputs = state_.digital_outputs;
  data.analog_outputs = state_.analog_outputs;
  data.outputs.bits = state_.outputs.bits;
  data.outputs.ints = state_.outputs.integers;
  data.outputs.doubles = state_.outputs.floats;
  data.tcp_offset = to_values(state_.X_FE);
  data.payload = state_.payload.mass;
  data.payload_cog = {state_.payload.com_F.x(), state_.payload.com_F.y(), state_.payload.com_F.z()};
  data.target_q = state_.target.q;
  data.target_qd = state_.target.qd;
  data.target_qdd = state_.target.qdd;
}

void Programs::step(ur::RobotData& data) {
  read(data);
  for (urscript::Machine& machine : secondary_) {
    machine.step(*this);
    const urscript::Status& status = machine.status();
    if (status.state == MachineState::Failed) {
      tell({ProgramNews::Kind::Failed, status.error.text, status.error.line, status.error.column});
    }
  }
  std::erase_if(secondary_, [](const urscript::Machine& machine) { return !machine.status().is_active(); });
  if (main_) {
    main_->step(*this);
    const urscript::Status& status = main_->status();
    if (status.state == MachineState::Failed && !state_.wants_protective_stop) {
      tell({ProgramNews::Kind::Failed, status.error.text, status.error.line, status.error.column});
    }
    if (status.state == MachineState::Halted) tell({ProgramNews::Kind::Halted, "the program halted", status.line, 0});
    if (!status.is_active()) abort();
  }
  write(data);
}

}  // namespace snug::served_ur::internal
