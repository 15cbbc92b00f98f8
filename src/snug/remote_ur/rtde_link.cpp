// RtdeLink: a controller at an address, as a plant drives it.
#include "snug/remote_ur/rtde_link.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::remote_ur {
namespace {

constexpr int kDashboardPort = 29999, kPrimaryPort = 30001;
constexpr int kLargestOffset = 65535 - 30004;
constexpr std::string_view kScheme = "ur://";

std::vector<std::string> output_names(bool is_in_lockstep) {
  std::vector<std::string> names = {"timestamp",
                                    "actual_q",
                                    "actual_qd",
                                    "target_q",
                                    "target_moment",
                                    "actual_TCP_force",
                                    "actual_digital_input_bits",
                                    "actual_digital_output_bits",
                                    "standard_analog_input0",
                                    "standard_analog_input1",
                                    "tool_analog_input0",
                                    "tool_analog_input1",
                                    "target_speed_fraction",
                                    "robot_mode",
                                    "safety_mode",
                                    "runtime_state",
                                    "payload",
                                    "payload_cog",
                                    fmt::format("output_int_register_{}", kFirstRegister),
                                    fmt::format("output_int_register_{}", kFirstRegister + 1)};
  if (is_in_lockstep) names.emplace_back(ur::rtde::kLockstep);
  return names;
}

/// What packing cannot do without; the rest older software may lack.
constexpr std::array kNeeded = {"timestamp",        "actual_q",   "actual_qd",   "target_q",
                                "actual_TCP_force", "robot_mode", "safety_mode", "runtime_state"};

std::vector<std::string> input_names() {
  std::vector<std::string> names = {"standard_digital_output_mask",     "standard_digital_output",
                                    "configurable_digital_output_mask", "configurable_digital_output",
                                    "tool_digital_output_mask",         "tool_digital_output"};
  for (std::size_t i = 0; i < RobotCommand().integers().size(); ++i)
    names.push_back(fmt::format("input_int_register_{}", kFirstRegister + static_cast<int>(i)));
  for (std::size_t i = 0; i < RobotCommand().numbers().size(); ++i)
    names.push_back(fmt::format("input_double_register_{}", kFirstRegister + static_cast<int>(i)));
  return names;
}

std::vector<double> input_values(const RobotCommand& command) {
  std::vector<double> values;
  for (const int shift : {0, 8, 16}) {
    const std::uint64_t bits = shift == 16 ? 3 : 255;
    values.push_back(static_cast<double>((command.output_mask >> shift) & bits));
    values.push_back(static_cast<double>((command.outputs >> shift) & bits));
  }
  for (const std::int32_t value : command.integers()) values.push_back(value);
  for (const double value : command.numbers()) values.push_back(value);
  return values;
}

template <std::size_t N>
void take(const RtdeValues& values, std::string_view name, std::array<double, N>& to) {
  const auto found = values.find(name);
  if (found != values.end() && found->second.size() == N) std::ranges::copy(found->second, to.begin());
}

double number(const RtdeValues& values, std::string_view name) {
  const auto found = values.find(name);
  return found != values.end() && !found->second.empty() ? found->second.front() : 0.0;
}

RobotSample sample_of(const RtdeValues& values) {
  RobotSample sample;
  sample.timestamp = number(values, "timestamp");
  take(values, "actual_q", sample.q);
  take(values, "actual_qd", sample.qd);
  take(values, "target_q", sample.target_q);
  take(values, "target_moment", sample.torques);
  take(values, "actual_TCP_force", sample.tcp_force);
  sample.digital_inputs = static_cast<std::uint64_t>(number(values, "actual_digital_input_bits"));
  sample.digital_outputs = static_cast<std::uint64_t>(number(values, "actual_digital_output_bits"));
  sample.analog_inputs = {number(values, "standard_analog_input0"), number(values, "standard_analog_input1"),
                          number(values, "tool_analog_input0"), number(values, "tool_analog_input1")};
  if (values.contains("target_speed_fraction")) sample.speed = number(values, "target_speed_fraction");
  sample.robot_mode = static_cast<int>(number(values, "robot_mode"));
  sample.safety_mode = static_cast<int>(number(values, "safety_mode"));
  sample.runtime_state = static_cast<int>(number(values, "runtime_state"));
  if (values.contains("payload") && values.contains("payload_cog")) sample.payload = number(values, "payload");
  take(values, "payload_cog", sample.payload_cog);
  sample.script = static_cast<std::int32_t>(number(values, fmt::format("output_int_register_{}", kFirstRegister)));
  sample.late = static_cast<int>(number(values, fmt::format("output_int_register_{}", kFirstRegister + 1)));
  return sample;
}

}  // namespace

std::optional<Endpoint> endpoint_of_ur(const std::string& address, const std::string& option) {
  if (!address.starts_with(kScheme)) return std::nullopt;
  Endpoint endpoint;
  endpoint.host = address.substr(kScheme.size());
  const std::size_t colon = endpoint.host.find(':');
  bool is_good = colon != 0 && !endpoint.host.empty();
  if (colon != std::string::npos) {
    const std::string offset = endpoint.host.substr(colon + 1);
    const auto [end, error] = std::from_chars(offset.data(), offset.data() + offset.size(), endpoint.port_offset);
    is_good = is_good && error == std::errc() && end == offset.data() + offset.size() && endpoint.port_offset >= 0 &&
              endpoint.port_offset <= kLargestOffset;
    endpoint.host.resize(colon);
  }
  if (!is_good) {
    throw InputError("command line", option, "'" + address + "'",
                     "ur://HOST, or ur://HOST:N where N is added to the controller's ports (--ur-port-offset)");
  }
  return endpoint;
}

bool is_loopback_host(const std::string& host) {
  in_addr address = {};
  if (host == "localhost") return true;
  return ::inet_pton(AF_INET, host.c_str(), &address) == 1 && (ntohl(address.s_addr) >> 24U) == 127;
}

void refuse_what_differs(const std::vector<Finding>& findings, const std::string& address) {
  std::string got, expected;
  for (const Finding& one : findings) {
    if (one.verdict != Verdict::Differs || one.what == "TCP" || one.what == "payload" || one.what == "speed slider")
      continue;
    got += fmt::format("{}{}: {}", got.empty() ? "" : "; ", one.what, one.robot);
    expected += fmt::format("{}{} ({})", expected.empty() ? "" : "; ", one.expected, one.remedy);
  }
  if (!got.empty()) throw InputError("command line", "--plant", "'" + address + "': " + got, expected);
}

RtdeLink::RtdeLink(const Endpoint& endpoint, bool is_in_lockstep)
    : endpoint_(endpoint), rtde_(endpoint, output_names(is_in_lockstep), 0.0, input_names()) {
  if (std::ranges::find(rtde_.unknown(), ur::rtde::kLockstep) != rtde_.unknown().end()) {
    throw InputError("command line", "--lockstep", endpoint.host + ", whose clock nobody can stop",
                     "a cell of `snug serve --ur`");
  }
  expect_needed();
}

RtdeLink::RtdeLink(std::function<Connection()> connect)
    : rtde_(std::move(connect), output_names(false), 0.0, input_names()) {
  expect_needed();
}

void RtdeLink::expect_needed() const {
  for (const char* name : kNeeded) {
    if (std::ranges::find(rtde_.unknown(), name) == rtde_.unknown().end()) continue;
    throw InputError("command line", "--plant", endpoint_.host + ", which does not tell " + name,
                     "a controller with software 3.9, 5.3 or later");
  }
}

std::string RtdeLink::name() const {
  return endpoint_.port_offset == 0 ? fmt::format("{}{}", kScheme, endpoint_.host)
                                    : fmt::format("{}{}:{}", kScheme, endpoint_.host, endpoint_.port_offset);
}

std::string RtdeLink::exchange(const RobotCommand& command, RobotSample& sample) {
  try {
    rtde_.send(input_values(command));
    const RtdeValues values = rtde_.receive();
    for (const auto& [name, numbers] : values) {
      if (!std::ranges::all_of(numbers, [](double one) { return std::isfinite(one); }))
        return fmt::format("{}: {} is no number", this->name(), name);
    }
    sample = sample_of(values);
  } catch (const InputError& error) {
    return fmt::format("{}: {}", error.key, error.got);
  }
  return {};
}

std::string RtdeLink::start(const std::string& program) {
  try {
    primary_.emplace(endpoint_, kPrimaryPort);
    primary_->send(program);
  } catch (const InputError& error) {
    return fmt::format("{}: {}", error.key, error.got);
  }
  return {};
}

std::string RtdeLink::why_not() {
  std::string text;
  if (!primary_) return text;
  try {
    primary_->take_waiting();
  } catch (const InputError& error) {
    text = error.got;
  }
  std::string_view bytes = primary_->received();
  for (ur::NextPacket next = ur::next_packet(bytes); next.packet; next = ur::next_packet(bytes)) {
    if (const auto exception = ur::read_runtime_exception(*next.packet))
      text = fmt::format("line {}: {}", exception->line, printable(exception->text, 200));
    bytes.remove_prefix(next.packet->size());
  }
  primary_.reset();
  return text;
}

std::string RtdeLink::unlock() {
  try {
    Connection dashboard(endpoint_, kDashboardPort);
    dashboard.send("unlock protective stop\n");
    dashboard.begin_wait();
    while (std::ranges::count(dashboard.received(), '\n') < 2) dashboard.wait();  // greeting, answer
  } catch (const InputError& error) {
    return fmt::format("{}: {}", error.key, error.got);
  }
  return {};
}

}  // namespace snug::remote_ur
