// SteppedLink: a served controller without sockets and without a clock: a period for each command.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "snug/perception/perception.hpp"
#include "snug/remote_ur/robot_link.hpp"
#include "snug/served_ur/controller.hpp"

namespace snug::remote_ur::test {

inline void put(const RobotCommand& command, ur::RobotInputs& inputs) {
  inputs.standard_mask = static_cast<std::uint8_t>(command.output_mask & 255U);
  inputs.standard = static_cast<std::uint8_t>(command.outputs & 255U);
  inputs.configurable_mask = static_cast<std::uint8_t>((command.output_mask >> 8U) & 255U);
  inputs.configurable = static_cast<std::uint8_t>((command.outputs >> 8U) & 255U);
  inputs.tool_mask = static_cast<std::uint8_t>((command.output_mask >> 16U) & 3U);
  inputs.tool = static_cast<std::uint8_t>((command.outputs >> 16U) & 3U);
  const auto integers = command.integers();
  const auto numbers = command.numbers();
  std::ranges::copy(integers, inputs.registers.ints.begin() + kFirstRegister);
  std::ranges::copy(numbers, inputs.registers.doubles.begin() + kFirstRegister);
}

inline RobotSample sample_of(const ur::RobotData& data) {
  RobotSample sample;
  sample.timestamp = data.timestamp;
  sample.q = data.actual_q;
  sample.qd = data.actual_qd;
  sample.target_q = data.target_q;
  sample.torques = data.target_moment;
  sample.tcp_force = data.actual_tcp_force;
  sample.digital_inputs = data.digital_inputs;
  sample.digital_outputs = data.digital_outputs;
  sample.analog_inputs = {data.analog_inputs[0], data.analog_inputs[1], data.tool_analog_inputs[0],
                          data.tool_analog_inputs[1]};
  sample.speed = data.target_speed_fraction;
  sample.robot_mode = static_cast<int>(data.robot_mode);
  sample.safety_mode = static_cast<int>(data.safety_mode);
  sample.runtime_state = static_cast<int>(data.runtime_state);
  sample.payload = data.payload;
  sample.payload_cog = data.payload_cog;
  sample.script = data.outputs.ints[kFirstRegister];
  sample.late = data.outputs.ints[kFirstRegister + 1];
  return sample;
}

class SteppedLink final : public RobotLink {
 public:
  SteppedLink(const model::Scenario& cell, const std::string& sequence, ur::Model model = ur::Model::Ur10)
      : simulation_(cell, sequence, {motion::LaggedTracking{}, cup::CupMode::Phases, cell.robot->name}),
        controller_(simulation_, settings_of(model)) {}

  [[nodiscard]] std::string name() const override { return "stepped"; }
  [[nodiscard]] double period() const override { return served_ur::Controller::period_of(controller_.model().model); }
  [[nodiscard]] bool is_e_series() const override { return controller_.model().is_e_series; }
  [[nodiscard]] std::string exchange(const RobotCommand& command, RobotSample& sample) override {
    if (!trouble.empty()) return trouble;
    if (lost > 0) {
      --lost;  // the command comes too late: the next one is in its place
    } else {
      put(command, controller_.inputs());
    }
    controller_.step();
    sample = sample_of(controller_.data());
    if (watch) watch();
    return {};
  }
  [[nodiscard]] std::string start(const std::string& program) override {
    controller_.run_program(program);
    return {};
  }
  [[nodiscard]] std::string why_not() override { return controller_.program_error(); }
  [[nodiscard]] std::string unlock() override {
    (void)controller_.unlock_protective_stop();
    return {};
  }

  /// As RemoteUrOptions::boxes.
  [[nodiscard]] std::string look(std::vector<perception::SceneBox>& boxes) const {
    const cell::CellWorld& world = simulation_.world();
    const physics::WorldState& state = controller_.state().world;
    for (std::size_t i = 0; i < world.parcels.size(); ++i) {
      const physics::BodyId body = world.parcels[i];
      if (!state.bodies[static_cast<std::size_t>(body.index)].is_present) continue;
      const std::string& id = simulation_.sequence().items[i].parcel;
      const Vector3 size =
          model::collision_size(simulation_.scenario(), *model::find_parcel(simulation_.scenario(), id));
      boxes.push_back({id, physics::pose_of(world.model, state, body), size});
    }
    return {};
  }

  [[nodiscard]] served_ur::Controller& controller() { return controller_; }

  std::string trouble;          ///< the robot is gone
  int lost = 0;                 ///< commands that do not come in time
  std::function<void()> watch;  ///< after each period

 private:
  static served_ur::ControllerSettings settings_of(ur::Model model) {
    served_ur::ControllerSettings settings;
    settings.model = model;
    settings.feeds_on_request = true;
    return settings;
  }
  cell::Simulation simulation_;
  served_ur::Controller controller_;
};

/// The controller of another link, for who connects after that one has gone.
class SameLink final : public RobotLink {
 public:
  explicit SameLink(SteppedLink& link) : link_(link) {}
  [[nodiscard]] std::string name() const override { return link_.name(); }
  [[nodiscard]] double period() const override { return link_.period(); }
  [[nodiscard]] bool is_e_series() const override { return link_.is_e_series(); }
  [[nodiscard]] std::string exchange(const RobotCommand& command, RobotSample& sample) override {
    return link_.exchange(command, sample);
  }
  [[nodiscard]] std::string start(const std::string& program) override { return link_.start(program); }
  [[nodiscard]] std::string why_not() override { return link_.why_not(); }
  [[nodiscard]] std::string unlock() override { return link_.unlock(); }

 private:
  SteppedLink& link_;
};

}  // namespace snug::remote_ur::test
