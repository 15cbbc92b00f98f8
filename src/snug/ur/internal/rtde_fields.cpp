// The fields of RTDE: name, type, and how each is written or read.
#include "snug/ur/internal/rtde_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/ur/rtde.hpp"

namespace snug::ur::internal {
namespace {

std::uint32_t status_bits(const RobotData& data) {
  return (data.is_powered() ? 1U : 0U) | (data.is_program_running() ? 2U : 0U);
}
std::uint32_t safety_bits(const RobotData& data) {
  const std::uint32_t is_normal = data.safety_mode == SafetyMode::Normal ? 1U : 0U;
  const std::uint32_t is_stopped = data.safety_mode == SafetyMode::ProtectiveStop ? 4U : 0U;
  const std::uint32_t is_fault = data.safety_mode == SafetyMode::Fault ? 0x200U : 0U;
  return is_normal | is_stopped | is_fault | (is_normal == 0U ? 0x400U : 0U);
}

class Outputs {
 public:
  using Write = std::function<void(const RobotData&, ByteWriter&)>;

  void add(std::string name, const char* type, Write write) {
    fields_.push_back({std::move(name), type, std::move(write)});
  }
  template <class Get>
  void number(std::string name, Get get) {
    add(std::move(name), "DOUBLE", [get](const RobotData& d, ByteWriter& w) { w.f64(get(d)); });
  }
  template <class Get>
  void six(std::string name, Get get) {
    add(std::move(name), "VECTOR6D", [get](const RobotData& d, ByteWriter& w) { w.f64s(get(d)); });
  }
  template <class Get>
  void three(std::string name, Get get) {
    add(std::move(name), "VECTOR3D", [get](const RobotData& d, ByteWriter& w) { w.f64s(get(d)); });
  }
  template <class Get>
  void signed_number(std::string name, Get get) {
    add(std::move(name), "INT32", [get](const RobotData& d, ByteWriter& w) { w.i32(get(d)); });
  }
  template <class Get>
  void word(std::string name, Get get) {
    add(std::move(name), "UINT32", [get](const RobotData& d, ByteWriter& w) { w.u32(get(d)); });
  }
  template <class Get>
  void registers(const std::string& prefix, Get get) {
    for (const std::size_t half : {std::size_t{0}, std::size_t{32}}) {
      word(fmt::format("{}_bit_registers{}_to_{}", prefix, half, half + 31), [get, half](const RobotData& d) {
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < 32; ++i) bits |= (get(d).bits[half + i] ? 1U : 0U) << i;
        return bits;
      });
    }
    for (std::size_t i = 64; i < 128; ++i) {
      add(fmt::format("{}_bit_register_{}", prefix, i), "BOOL",
          [get, i](const RobotData& d, ByteWriter& w) { w.boolean(get(d).bits[i]); });
    }
    for (std::size_t i = 0; i < 48; ++i) {
      signed_number(fmt::format("{}_int_register_{}", prefix, i),
                    [get, i](const RobotData& d) { return get(d).ints[i]; });
      number(fmt::format("{}_double_register_{}", prefix, i),
             [get, i](const RobotData& d) { return get(d).doubles[i]; });
    }
  }
  [[nodiscard]] std::vector<OutputField> take() { return std::move(fields_); }

 private:
  std::vector<OutputField> fields_;
};

using D = const RobotData&;

void add_motion(Outputs& out) {
  out.number("timestamp", [](D d) { return d.timestamp; });
  out.six("target_q", [](D d) { return d.target_q; });
  out.six("target_qd", [](D d) { return d.target_qd; });
  out.six("target_qdd", [](D d) { return d.target_qdd; });
  out.six("target_current", [](D d) { return d.target_current; });
  out.six("target_moment", [](D d) { return d.target_moment; });
  out.six("actual_q", [](D d) { return d.actual_q; });
  out.six("actual_qd", [](D d) { return d.actual_qd; });
  out.six("actual_current", [](D d) { return d.actual_current; });
  out.six("joint_control_output", [](D d) { return d.joint_control_output; });
  out.six("actual_TCP_pose", [](D d) { return d.actual_tcp_pose; });
  out.six("actual_TCP_speed", [](D d) { return d.actual_tcp_speed; });
  out.six("actual_TCP_force", [](D d) { return d.actual_tcp_force; });
  out.six("target_TCP_pose", [](D d) { return d.target_tcp_pose; });
  out.six("target_TCP_speed", [](D d) { return d.target_tcp_speed; });
  out.six("ft_raw_wrench", [](D d) { return d.ft_raw_wrench; });
  out.six("tcp_offset", [](D d) { return d.tcp_offset; });
  out.number("tcp_force_scalar",
             [](D d) { return std::hypot(d.actual_tcp_force[0], d.actual_tcp_force[1], d.actual_tcp_force[2]); });
  out.three("actual_tool_accelerometer", [](D d) { return d.tool_acceleration; });
  out.three("elbow_position", [](D d) { return d.elbow_position; });
  out.number("payload", [](D d) { return d.payload; });
  out.three("payload_cog", [](D d) { return d.payload_cog; });
  out.number("actual_momentum", [](D d) { return d.momentum; });
  out.number("actual_execution_time", [](D d) { return d.execution_time; });
  out.number("joint_position_deviation_ratio", [](D) { return 0.0; });
  out.number("collision_detection_ratio", [](D) { return 0.0; });
}

void add_states(Outputs& out) {
  out.signed_number("robot_mode", [](D d) { return static_cast<std::int32_t>(d.robot_mode); });
  out.signed_number("safety_mode", [](D d) { return static_cast<std::int32_t>(d.safety_mode); });
  out.signed_number("safety_status", [](D d) { return static_cast<std::int32_t>(d.safety_mode); });
  out.add(rtde::kLockstep, "BOOL", [](D, ByteWriter& w) { w.boolean(true); });
  out.word("runtime_state", [](D d) { return static_cast<std::uint32_t>(d.runtime_state); });
  out.word("robot_status_bits", status_bits);
  out.word("safety_status_bits", safety_bits);
  out.add("joint_mode", "VECTOR6INT32", [](D d, ByteWriter& w) {
    for (int j = 0; j < 6; ++j) w.i32(d.joint_mode());
  });
  out.number("speed_scaling", [](D d) { return d.speed_scaling; });
  out.number("target_speed_fraction", [](D d) { return d.target_speed_fraction; });
}

void add_electric(Outputs& out) {
  out.add("actual_digital_input_bits", "UINT64", [](D d, ByteWriter& w) { w.u64(d.digital_inputs); });
  out.add("actual_digital_output_bits", "UINT64", [](D d, ByteWriter& w) { w.u64(d.digital_outputs); });
  for (std::size_t i = 0; i < 2; ++i) {
    out.number(fmt::format("standard_analog_input{}", i), [i](D d) { return d.analog_inputs[i]; });
    out.number(fmt::format("standard_analog_output{}", i), [i](D d) { return d.analog_outputs[i]; });
  }
  out.word("analog_io_types", [](D) { return 0xfU; });  // all volts
  out.word("tool_analog_input_types", [](D) { return 3U; });
  out.number("tool_analog_input0", [](D d) { return d.tool_analog_inputs[0]; });
  out.number("tool_analog_input1", [](D d) { return d.tool_analog_inputs[1]; });
  out.word("tool_mode", [](D d) { return static_cast<std::uint32_t>(d.joint_mode()); });
  out.signed_number("tool_output_voltage", [](D) { return 0; });
  out.number("tool_output_current", [](D) { return 0.0; });
  out.number("tool_temperature", [](D) { return kTemperature; });
  out.six("joint_temperatures", [](D) {
    Values6 all{};
    all.fill(kTemperature);
    return all;
  });
  out.six("actual_joint_voltage", [](D d) {
    Values6 all{};
    all.fill(d.is_powered() ? kSupplyVoltage : 0.0);
    return all;
  });
  out.number("actual_main_voltage", [](D) { return kSupplyVoltage; });
  out.number("actual_robot_voltage", [](D d) { return d.is_powered() ? kSupplyVoltage : 0.0; });
  out.number("actual_robot_current", [](D d) {
    double sum = 0.0;
    for (const double current : d.actual_current) sum += std::abs(current);
    return sum;
  });
  out.number("io_current", [](D) { return 0.0; });
}

class Inputs {
 public:
  void add(std::string name, const char* type, std::size_t size, std::function<void(ByteReader&, RobotInputs&)> read) {
    fields_.push_back({std::move(name), type, size, std::move(read)});
  }
  void byte(std::string name, std::uint8_t RobotInputs::*to) {
    add(std::move(name), "UINT8", 1, [to](ByteReader& r, RobotInputs& in) { in.*to = r.u8(); });
  }
  [[nodiscard]] std::vector<InputField> take() { return std::move(fields_); }

 private:
  std::vector<InputField> fields_;
};

void keep_finite(double value, double& to) {
  if (std::isfinite(value)) to = value;
}

void add_input_registers(Inputs& in) {
  for (const std::size_t half : {std::size_t{0}, std::size_t{32}}) {
    in.add(fmt::format("input_bit_registers{}_to_{}", half, half + 31), "UINT32", 4,
           [half](ByteReader& r, RobotInputs& inputs) {
             const std::uint32_t bits = r.u32();
             for (std::size_t i = 0; i < 32; ++i) inputs.registers.bits[half + i] = ((bits >> i) & 1U) != 0;
           });
  }
  for (std::size_t i = 64; i < 128; ++i) {
    in.add(fmt::format("input_bit_register_{}", i), "BOOL", 1,
           [i](ByteReader& r, RobotInputs& inputs) { inputs.registers.bits[i] = r.u8() != 0; });
  }
  for (std::size_t i = 0; i < 48; ++i) {
    in.add(fmt::format("input_int_register_{}", i), "INT32", 4,
           [i](ByteReader& r, RobotInputs& inputs) { inputs.registers.ints[i] = r.i32(); });
    in.add(fmt::format("input_double_register_{}", i), "DOUBLE", 8,
           [i](ByteReader& r, RobotInputs& inputs) { keep_finite(r.f64(), inputs.registers.doubles[i]); });
  }
}

std::vector<OutputField> make_outputs() {
  Outputs out;
  add_motion(out);
  add_states(out);
  add_electric(out);
  out.registers("output", [](D d) -> const Registers& { return d.outputs; });
  out.registers("input", [](D d) -> const Registers& { return d.inputs; });
  std::vector<OutputField> fields = out.take();
  std::ranges::sort(fields, {}, &OutputField::name);
  return fields;
}

std::vector<InputField> make_inputs() {
  Inputs in;
  in.add("speed_slider_mask", "UINT32", 4, [](ByteReader& r, RobotInputs& i) { i.speed_slider_mask = r.u32(); });
  in.add("speed_slider_fraction", "DOUBLE", 8,
         [](ByteReader& r, RobotInputs& i) { keep_finite(r.f64(), i.speed_slider_fraction); });
  in.byte("standard_digital_output_mask", &RobotInputs::standard_mask);
  in.byte("standard_digital_output", &RobotInputs::standard);
  in.byte("configurable_digital_output_mask", &RobotInputs::configurable_mask);
  in.byte("configurable_digital_output", &RobotInputs::configurable);
  in.byte("tool_digital_output_mask", &RobotInputs::tool_mask);
  in.byte("tool_digital_output", &RobotInputs::tool);
  in.byte("standard_analog_output_mask", &RobotInputs::analog_mask);
  in.byte("standard_analog_output_type", &RobotInputs::analog_type);
  for (std::size_t n = 0; n < 2; ++n) {
    in.add(fmt::format("standard_analog_output_{}", n), "DOUBLE", 8,
           [n](ByteReader& r, RobotInputs& i) { keep_finite(r.f64(), i.analog[n]); });
  }
  in.add("external_force_torque", "VECTOR6D", 48, [](ByteReader& r, RobotInputs& i) {
    for (double& value : i.external_force_torque) keep_finite(r.f64(), value);
  });
  add_input_registers(in);
  std::vector<InputField> fields = in.take();
  std::ranges::sort(fields, {}, &InputField::name);
  return fields;
}

}  // namespace

const std::vector<OutputField>& output_fields() {
  static const std::vector<OutputField> kFields = make_outputs();
  return kFields;
}

const std::vector<InputField>& input_fields() {
  static const std::vector<InputField> kFields = make_inputs();
  return kFields;
}

}  // namespace snug::ur::internal
