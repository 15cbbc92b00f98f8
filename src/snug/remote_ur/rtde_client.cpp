// RtdeClient: a client of a controller's real-time data exchange (port 30004), version 2.
#include "snug/remote_ur/rtde_client.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/text.hpp"

namespace snug::remote_ur {
namespace {

using ur::rtde::Frame;

constexpr int kPort = 30004;
constexpr std::uint64_t kExact = (std::uint64_t{1} << 53U) - 1;  // of words of 64 bits, what a double holds

/// A type is that of all controllers; `known` is none for a name that is not known here.
bool is_as_known(const char* known, std::string_view type) { return known == nullptr || known == type; }

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> words;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    words.emplace_back(trim(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return words;
}

/// Of the numbers of a type; '?' for one that is not known.
char kind_of(std::string_view type) {
  if (type == "BOOL" || type == "UINT8") return 'b';
  if (type == "UINT64") return 'q';
  if (type == "UINT32" || type == "VECTOR6UINT32") return 'u';
  if (type == "INT32" || type == "VECTOR6INT32") return 'i';
  return type == "DOUBLE" || type == "VECTOR3D" || type == "VECTOR6D" ? 'd' : '?';
}

double read_number(ur::ByteReader& in, char kind) {
  switch (kind) {
    case 'i':
      return in.i32();
    case 'u':
      return in.u32();
    case 'q':
      return static_cast<double>(in.u64() & kExact);
    case 'b':
      return in.u8();
    default:
      return in.f64();
  }
}

void write_number(ur::ByteWriter& out, char kind, double value) {
  switch (kind) {
    case 'i':
      return out.i32(static_cast<std::int32_t>(value));
    case 'u':
      return out.u32(static_cast<std::uint32_t>(value));
    case 'b':
      return out.u8(static_cast<std::uint8_t>(value));
    default:
      return out.f64(value);
  }
}

}  // namespace

RtdeClient::RtdeClient(const Endpoint& endpoint, const std::vector<std::string>& outputs, double frequency,
                       const std::vector<std::string>& inputs)
    : RtdeClient([endpoint] { return Connection(endpoint, kPort); }, outputs, frequency, inputs) {}

RtdeClient::RtdeClient(std::function<Connection()> connect_to, const std::vector<std::string>& outputs,
                       double frequency, const std::vector<std::string>& inputs)
    : connect_(std::move(connect_to)) {
  connect();
  std::vector<std::string> types = set_up(outputs, frequency);
  std::vector<std::string> known;
  for (std::size_t i = 0; i < outputs.size(); ++i) (types[i] == "NOT_FOUND" ? unknown_ : known).push_back(outputs[i]);
  if (known.empty()) connection_->fail("the controller knows none of the outputs");
  if (!unknown_.empty()) {  // a recipe that was refused is not mended: clients begin anew
    connect();
    types = set_up(known, frequency);
  }
  for (std::size_t i = 0; i < known.size(); ++i) {
    const std::string& type = types[i];
    const char kind = kind_of(type);
    if (kind == '?' || !is_as_known(ur::rtde::output_type(known[i]), type))
      connection_->fail(fmt::format("output '{}' has the type '{}'", known[i], printable(type, 50)));
    const std::size_t count = type.starts_with("VECTOR6") ? 6 : type.starts_with("VECTOR3") ? 3 : 1;
    outputs_.push_back({known[i], kind, count});
  }
  if (!inputs.empty()) set_up_inputs(inputs);
  if (ask(Frame::Start, "") != "\x01") connection_->fail("the controller does not start to send");
}

void RtdeClient::connect() {
  connection_.emplace(connect_());
  ur::ByteWriter wanted;
  wanted.u16(2);
  if (ask(Frame::Version, wanted.bytes()) != "\x01") connection_->fail("no version 2 of RTDE");
  const std::string version = ask(Frame::ControllerVersion, "");
  ur::ByteReader in(version);
  for (std::uint32_t& part : version_) part = in.u32();
  if (!in.is_good()) connection_->fail("an answer of RTDE that cannot be read");
}

/// The types of the outputs.
std::vector<std::string> RtdeClient::set_up(const std::vector<std::string>& names, double frequency) {
  ur::ByteWriter out;
  out.f64(frequency > 0.0 ? frequency : version_[0] < 5 ? 125.0 : 500.0);
  out.text(fmt::format("{}", fmt::join(names, ",")));
  const std::string answer = ask(Frame::Outputs, out.bytes());
  ur::ByteReader in(answer);
  recipe_ = in.u8();
  std::vector<std::string> types = split(in.rest());
  if (types.size() != names.size()) connection_->fail("an answer of RTDE that cannot be read");
  return types;
}

void RtdeClient::set_up_inputs(const std::vector<std::string>& names) {
  const std::string answer = ask(Frame::Inputs, fmt::format("{}", fmt::join(names, ",")));
  ur::ByteReader in(answer);
  input_recipe_ = in.u8();
  const std::vector<std::string> types = split(in.rest());
  if (types.size() != names.size()) connection_->fail("an answer of RTDE that cannot be read");
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (types[i] == "IN_USE") connection_->fail(fmt::format("another client holds the input '{}'", names[i]));
    const char kind = kind_of(types[i]);
    if (kind == '?' || kind == 'q' || types[i].starts_with("VECTOR") ||
        !is_as_known(ur::rtde::input_type(names[i]), types[i]))
      connection_->fail(fmt::format("input '{}' has the type '{}'", names[i], printable(types[i], 50)));
    input_kinds_.push_back(kind);
  }
}

void RtdeClient::send(std::span<const double> values) {
  SNUG_CHECK(values.size() == input_kinds_.size(), "a number for each input");
  ur::ByteWriter out;
  out.u8(input_recipe_);
  for (std::size_t i = 0; i < values.size(); ++i) write_number(out, input_kinds_[i], values[i]);
  connection_->send(ur::rtde::encode(Frame::Data, out.bytes()));
}

std::string RtdeClient::ask(Frame type, std::string_view payload) {
  connection_->send(ur::rtde::encode(type, payload));
  return await(type);
}

/// The payload of the next frame of this type; others (texts, data) are passed over.
std::string RtdeClient::await(Frame type) {
  connection_->begin_wait();
  while (true) {
    const ur::rtde::NextFrame next = ur::rtde::next_frame(connection_->received(), ur::rtde::From::Controller);
    if (next.is_broken) connection_->fail("bytes that are not RTDE");
    if (!next.frame) {
      connection_->wait();
      continue;
    }
    const bool is_it = next.frame->type == static_cast<std::uint8_t>(type);
    std::string payload(next.frame->payload);
    connection_->received().erase(0, next.size);
    if (is_it) return payload;
  }
}

RtdeValues RtdeClient::receive() {
  const std::string package = await(Frame::Data);
  ur::ByteReader in(package);
  if (in.u8() != recipe_) connection_->fail("a data package of another recipe");
  RtdeValues values;
  for (const Output& output : outputs_) {
    std::vector<double>& numbers = values[output.name];
    for (std::size_t i = 0; i < output.count; ++i) numbers.push_back(read_number(in, output.kind));
  }
  if (!in.is_good() || !in.rest().empty()) connection_->fail("a data package of another length");
  return values;
}

}  // namespace snug::remote_ur
