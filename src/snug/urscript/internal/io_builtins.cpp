// Inputs, outputs, registers, messages, sockets.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <memory>

#include "snug/urscript/internal/builtins.hpp"

namespace snug::urscript::internal {
namespace {

constexpr std::size_t kLongestLine = 8192;  // bytes of socket_read_line
constexpr int kMostIntegers = 100;          // of socket_read_binary_integer
constexpr std::size_t kMostWatchdogs = 100;

std::size_t place(const Value& value, std::size_t count, const char* what) {
  const double number = number_of(value, what);
  if (!(number >= 0.0 && number < static_cast<double>(count)) || number != std::floor(number))
    throw Fault{fmt::format("{} {} is not one of 0 to {}", what, value.as_text(), count - 1)};
  return static_cast<std::size_t>(number);
}

template <std::size_t kFirst, std::size_t kCount>
Value set_output(CallContext& call) {
  const std::uint32_t bit = 1U << (kFirst + place(call.arguments[0], kCount, "the output"));
  std::uint32_t& outputs = call.host.state().digital_outputs;
  outputs = number_of(call.arguments[1], "the level") != 0.0 ? outputs | bit : outputs & ~bit;
  return {};
}
template <std::size_t kFirst, std::size_t kCount>
Value get_input(CallContext& call) {
  return Value::of(
      ((call.host.state().digital_inputs >> (kFirst + place(call.arguments[0], kCount, "the input"))) & 1U) != 0);
}
template <std::size_t kFirst, std::size_t kCount>
Value get_output(CallContext& call) {
  return Value::of(
      ((call.host.state().digital_outputs >> (kFirst + place(call.arguments[0], kCount, "the output"))) & 1U) != 0);
}
template <std::size_t kFirst>
Value get_analog(CallContext& call) {
  return Value::of(call.host.state().analog_inputs[kFirst + place(call.arguments[0], 2, "the input")]);
}
Value set_analog(CallContext& call) {
  call.host.state().analog_outputs[place(call.arguments[0], 2, "the output")] =
      number_of(call.arguments[1], "the level");
  return {};
}

std::int32_t integer_of(const Value& value) {
  const double number = number_of(value, "the value");
  if (!(std::abs(number) <= 2147483647.0)) throw Fault{"a number too large for an integer"};
  return static_cast<std::int32_t>(number);
}
Value read_integer(const Registers& registers, const Value& at) {
  return Value::of(static_cast<int>(registers.integers[place(at, registers.integers.size(), "the register")]));
}
Value read_float(const Registers& registers, const Value& at) {
  return Value::of(registers.floats[place(at, registers.floats.size(), "the register")]);
}
Value read_bit(const Registers& registers, const Value& at) {
  return Value::of(registers.bits[place(at, registers.bits.size(), "the register")]);
}

// --- sockets: names are "socket_0" where none is given
std::string socket_name(const CallContext& call, std::size_t index) {
  return call.has(index) ? call.arguments[index].as_text() : "socket_0";
}

Value open_socket(CallContext& call) {
  const std::string address = call.arguments[0].as_text(), name = socket_name(call, 2);
  const auto port = static_cast<int>(place(call.arguments[1], 65536, "the port"));
  call.wait = [address, name, port, end = call.time + 2.0](CallContext& later, Value& result) {
    const SocketState state = later.host.open_socket(name, address, port);
    if (state == SocketState::Opening && later.time < end) return false;
    result = Value::of(state == SocketState::Open);
    return true;
  };
  return {};
}

Value send_bytes(CallContext& call, const std::string& bytes, std::size_t name) {
  return Value::of(call.host.send(socket_name(call, name), bytes));
}
std::string as_bytes(std::int32_t value) {
  const auto bits = static_cast<std::uint32_t>(value);
  std::string bytes;
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>((bits >> shift) & 0xFFU);
  return bytes;
}

/// What `parse` finds in what came, at once where it is there; after the time, or when the socket closes, `otherwise`.
Value read_socket(CallContext& call, std::size_t name_index, std::size_t timeout_index, std::size_t most,
                  std::function<std::optional<Value>(const std::string&)> parse, Value otherwise) {
  const std::string name = socket_name(call, name_index);
  const double timeout = call.number(timeout_index, 2.0);
  const double end = timeout > 0.0 ? call.time + timeout : std::numeric_limits<double>::infinity();
  auto buffer = std::make_shared<std::string>();
  call.host.receive(name, *buffer, most);
  if (std::optional<Value> found = parse(*buffer)) return std::move(*found);
  call.wait = [name, end, most, buffer, parse = std::move(parse), otherwise = std::move(otherwise)](CallContext& later,
                                                                                                    Value& result) {
    later.host.receive(name, *buffer, most);
    if (std::optional<Value> found = parse(*buffer)) {
      result = std::move(*found);
      return true;
    }
    if (later.time < end - 1e-9 && later.host.socket_state(name) == SocketState::Open) return false;
    result = otherwise;
    return true;
  };
  return {};
}

Value read_integers(CallContext& call) {
  const auto count = static_cast<int>(place(call.arguments[0], kMostIntegers + 1, "the count"));
  const auto bytes = static_cast<std::size_t>(4 * count);
  std::vector<Value> none(1, Value::of(0));
  for (int i = 0; i < count; ++i) none.push_back(Value::of(0));
  return read_socket(
      call, 1, 2, bytes,
      [count, bytes](const std::string& buffer) -> std::optional<Value> {
        if (buffer.size() < bytes) return std::nullopt;
        std::vector<Value> values(1, Value::of(count));
        for (std::size_t i = 0; i < bytes; i += 4) {
          std::uint32_t bits = 0;
          for (std::size_t k = 0; k < 4; ++k) bits = bits << 8U | static_cast<unsigned char>(buffer[i + k]);
          values.push_back(Value::of(static_cast<int>(static_cast<std::int32_t>(bits))));
        }
        return Value::of(std::move(values));
      },
      Value::of(std::move(none)));
}

/// One byte after the other until the line ends, so that nothing behind it is taken.
Value read_line(CallContext& call) {
  const std::string name = socket_name(call, 0);
  const double timeout = call.number(1, 2.0);
  const double end = timeout > 0.0 ? call.time + timeout : std::numeric_limits<double>::infinity();
  auto line = std::make_shared<std::string>();
  call.wait = [name, end, line](CallContext& later, Value& result) {
    for (;;) {
      const std::size_t before = line->size();
      later.host.receive(name, *line, before + 1);
      if (line->size() == before) break;
      if (line->back() != '\n' && line->size() < kLongestLine) continue;
      if (line->back() == '\n') line->pop_back();
      result = Value::of(*line);
      return true;
    }
    if (later.time < end - 1e-9 && later.host.socket_state(name) == SocketState::Open) return false;
    result = Value::of(std::string());
    return true;
  };
  return {};
}

Value text_message(CallContext& call) {
  call.host.show(
      {MessageKind::Text, call.arguments[0].as_text() + (call.has(1) ? call.arguments[1].as_text() : ""), {}});
  return {};
}
Value popup(CallContext& call) {
  Message message{MessageKind::Popup, call.arguments[0].as_text(), call.has(1) ? call.arguments[1].as_text() : "Popup"};
  message.is_warning = call.number(2, 0.0) != 0.0;
  message.is_error = call.number(3, 0.0) != 0.0;
  message.is_blocking = call.number(4, 0.0) != 0.0;
  call.host.show(message);
  if (!message.is_blocking) return {};
  call.host.state().has_popup = true;
  call.wait = [](CallContext& later, Value&) { return !later.host.state().has_popup; };
  return {};
}
Value no_setting(CallContext&) { return {}; }

/// Clients have to set the input so often; else the program is paused, or stopped. 0 Hz: no more.
Value set_watchdog(CallContext& call) {
  Watchdog dog;
  dog.input = call.arguments[0].as_text();
  const double frequency = number_of(call.arguments[1], "the frequency");
  std::string action = call.has(2) ? call.arguments[2].as_text() : "pause";
  std::ranges::transform(action, action.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::optional<std::uint64_t> count = call.host.input_count(dog.input);
  if (!count) throw Fault{fmt::format("'{}' is no input of RTDE", dog.input)};
  if (!(frequency >= 0.0) || !std::isfinite(frequency)) throw Fault{"a frequency below 0"};
  if (action != "pause" && action != "stop" && action != "ignore")
    throw Fault{fmt::format("the action '{}' is not pause, stop or ignore", action)};
  std::erase_if(call.watchdogs, [&](const Watchdog& one) { return one.input == dog.input; });
  if (frequency == 0.0) return {};
  if (call.watchdogs.size() >= kMostWatchdogs) throw Fault{fmt::format("more than {} watchdogs", kMostWatchdogs)};
  dog.patience = 1.0 / frequency;
  dog.action = action == "stop"     ? Watchdog::Action::Stop
               : action == "ignore" ? Watchdog::Action::Ignore
                                    : Watchdog::Action::Pause;
  dog.count = *count;
  dog.since = call.time;
  call.watchdogs.push_back(std::move(dog));
  return {};
}

const Builtin kIo[] = {
    {"set_digital_out", "n b", 2, set_output<0, 8>},
    {"set_standard_digital_out", "n b", 2, set_output<0, 8>},
    {"set_configurable_digital_out", "n b", 2, set_output<8, 8>},
    {"set_tool_digital_out", "n b", 2, set_output<16, 2>},
    {"get_digital_in", "n", 1, get_input<0, 8>},
    {"get_standard_digital_in", "n", 1, get_input<0, 8>},
    {"get_configurable_digital_in", "n", 1, get_input<8, 8>},
    {"get_tool_digital_in", "n", 1, get_input<16, 2>},
    {"get_digital_out", "n", 1, get_output<0, 8>},
    {"get_standard_digital_out", "n", 1, get_output<0, 8>},
    {"get_configurable_digital_out", "n", 1, get_output<8, 8>},
    {"get_tool_digital_out", "n", 1, get_output<16, 2>},
    {"get_standard_analog_in", "n", 1, get_analog<0>},
    {"get_analog_in", "n", 1, get_analog<0>},
    {"get_tool_analog_in", "n", 1, get_analog<2>},
    {"set_standard_analog_out", "n f", 2, set_analog},
    {"set_analog_out", "n f", 2, set_analog},
    {"set_standard_analog_input_domain", "port domain", 2, no_setting},
    {"set_tool_analog_input_domain", "port domain", 2, no_setting},
    {"set_analog_outputdomain", "port domain", 2, no_setting},
    {"read_input_integer_register", "address", 1,
     [](CallContext& c) { return read_integer(c.host.state().inputs, c.arguments[0]); }},
    {"read_input_float_register", "address", 1,
     [](CallContext& c) { return read_float(c.host.state().inputs, c.arguments[0]); }},
    {"read_input_boolean_register", "address", 1,
     [](CallContext& c) { return read_bit(c.host.state().inputs, c.arguments[0]); }},
    {"read_output_integer_register", "address", 1,
     [](CallContext& c) { return read_integer(c.host.state().outputs, c.arguments[0]); }},
    {"read_output_float_register", "address", 1,
     [](CallContext& c) { return read_float(c.host.state().outputs, c.arguments[0]); }},
    {"read_output_boolean_register", "address", 1,
     [](CallContext& c) { return read_bit(c.host.state().outputs, c.arguments[0]); }},
    {"write_output_integer_register", "address value", 2,
     [](CallContext& c) {
       Registers& registers = c.host.state().outputs;
       registers.integers[place(c.arguments[0], registers.integers.size(), "the register")] =
           integer_of(c.arguments[1]);
       return Value{};
     }},
    {"write_output_float_register", "address value", 2,
     [](CallContext& c) {
       Registers& registers = c.host.state().outputs;
       registers.floats[place(c.arguments[0], registers.floats.size(), "the register")] =
           number_of(c.arguments[1], "the value");
       return Value{};
     }},
    {"write_output_boolean_register", "address value", 2,
     [](CallContext& c) {
       Registers& registers = c.host.state().outputs;
       registers.bits[place(c.arguments[0], registers.bits.size(), "the register")] =
           number_of(c.arguments[1], "the value") != 0.0;
       return Value{};
     }},
    {"textmsg", "s1 s2", 1, text_message},
    {"popup", "s title warning error blocking", 1, popup},
    {"socket_open", "address port socket_name", 2, open_socket},
    {"socket_close", "socket_name", 0,
     [](CallContext& c) {
       c.host.close_socket(socket_name(c, 0));
       return Value{};
     }},
    {"socket_send_int", "value socket_name", 1,
     [](CallContext& c) { return send_bytes(c, as_bytes(integer_of(c.arguments[0])), 1); }},
    {"socket_send_byte", "value socket_name", 1,
     [](CallContext& c) {
       return send_bytes(c, std::string(1, static_cast<char>(place(c.arguments[0], 256, "the byte"))), 1);
     }},
    {"socket_send_string", "str socket_name", 1,
     [](CallContext& c) { return send_bytes(c, c.arguments[0].as_text(), 1); }},
    {"socket_send_line", "str socket_name", 1,
     [](CallContext& c) { return send_bytes(c, c.arguments[0].as_text() + "\n", 1); }},
    {"socket_read_binary_integer", "number socket_name timeout", 1, read_integers},
    {"socket_read_line", "socket_name timeout", 0, read_line},
    {"socket_read_string", "socket_name prefix suffix interpret_escape timeout", 0,
     [](CallContext& c) {
       return read_socket(
           c, 0, 4, kLongestLine,
           [](const std::string& buffer) -> std::optional<Value> {
             if (buffer.empty()) return std::nullopt;
             return Value::of(buffer);
           },
           Value::of(std::string()));
     }},
    {"rtde_set_watchdog", "variable_name min_frequency action", 2, set_watchdog},
};

}  // namespace

std::span<const Builtin> io_builtins() { return kIo; }

}  // namespace snug::urscript::internal
