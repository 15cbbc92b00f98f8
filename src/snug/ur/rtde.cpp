// RTDE: frames, recipes and fields of the real-time data exchange, versions 1 and 2.
#include "snug/ur/rtde.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "snug/core/check.hpp"
#include "snug/ur/internal/rtde_fields.hpp"

namespace snug::ur {
namespace {

using internal::InputField;
using internal::OutputField;

constexpr const char* kNotFound = "NOT_FOUND";
constexpr const char* kInUse = "IN_USE";
constexpr std::uint8_t kOutputRecipe = 1;
constexpr std::uint8_t kWarning = 2;  // levels: 0 exception, 1 error, 2 warning, 3 information

template <class Field>
const Field* find_field(const std::vector<Field>& fields, std::string_view name) {
  const auto found =
      std::ranges::lower_bound(fields, name, {}, [](const Field& f) { return std::string_view(f.name); });
  return found != fields.end() && found->name == name ? &*found : nullptr;
}

/// Names with commas between. Spaces around them do not count, nor does an empty last name: clients end lists with a
/// comma.
std::vector<std::string_view> names_of(std::string_view text) {
  std::vector<std::string_view> names;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(','), text.size());
    std::string_view name = text.substr(0, end);
    while (!name.empty() && name.front() == ' ') name.remove_prefix(1);
    while (!name.empty() && (name.back() == ' ' || name.back() == '\0')) name.remove_suffix(1);
    const bool is_last = end >= text.size();
    text.remove_prefix(is_last ? end : end + 1);
    if (!name.empty() || !text.empty()) names.push_back(name);
  }
  return names;
}

void append(std::string& list, std::string_view word) {
  if (!list.empty()) list += ',';
  list += word;
}

}  // namespace

namespace rtde {

std::string encode(Frame type, std::string_view payload) {
  SNUG_CHECK(payload.size() <= 65532, "a frame has at most 65535 bytes");
  ByteWriter out;
  out.u16(static_cast<std::uint16_t>(payload.size() + 3));
  out.u8(static_cast<std::uint8_t>(type));
  out.text(payload);
  return out.take();
}

namespace {

/// The first bytes of a request of HTTP are none of these: "POS" would be a long Start.
bool is_possible(std::uint8_t type, std::size_t size, From sender) {
  const bool is_answer = sender == From::Controller;
  switch (static_cast<Frame>(type)) {
    case Frame::Version:
      return size == (is_answer ? 4 : 5);
    case Frame::ControllerVersion:
      return size == (is_answer ? 19 : 3);
    case Frame::Start:
    case Frame::Pause:
      return size == (is_answer ? 4 : 3);
    case Frame::Text:
    case Frame::Data:
    case Frame::Outputs:
    case Frame::Inputs:
      return size >= 3;
  }
  return false;
}

}  // namespace

NextFrame next_frame(std::string_view bytes, From sender) {
  if (bytes.size() < 3) return {};
  ByteReader in(bytes);
  const std::size_t size = in.u16();
  const std::uint8_t type = in.u8();
  if (!is_possible(type, size, sender)) return {std::nullopt, 0, true};
  if (bytes.size() < size) return {};
  return {FrameView{type, bytes.substr(3, size - 3)}, size, false};
}

const char* output_type(std::string_view name) {
  const OutputField* field = find_field(internal::output_fields(), name);
  return field != nullptr ? field->type : nullptr;
}

const char* input_type(std::string_view name) {
  const InputField* field = find_field(internal::input_fields(), name);
  return field != nullptr ? field->type : nullptr;
}

std::optional<std::uint64_t> input_count(const RobotInputs& inputs, std::string_view name) {
  const InputField* field = find_field(internal::input_fields(), name);
  if (field == nullptr) return std::nullopt;
  const auto index = static_cast<std::size_t>(field - internal::input_fields().data());
  return index < inputs.counts.size() ? inputs.counts[index] : 0;
}

std::vector<std::string> output_names() {
  std::vector<std::string> names;
  for (const OutputField& field : internal::output_fields()) names.push_back(field.name);
  return names;
}

std::vector<std::string> input_names() {
  std::vector<std::string> names;
  for (const InputField& field : internal::input_fields()) names.push_back(field.name);
  return names;
}

}  // namespace rtde

bool InputOwners::is_taken(std::string_view name, int connection) const {
  const auto found = owners_.find(name);
  return found != owners_.end() && found->second != connection;
}

bool InputOwners::claim(std::string_view name, int connection) {
  if (is_taken(name, connection)) return false;
  owners_.insert_or_assign(std::string(name), connection);
  return true;
}

void InputOwners::release(int connection) {
  std::erase_if(owners_, [&](const auto& owner) { return owner.second == connection; });
}

RtdeSession::RtdeSession(const ModelFacts& facts, int connection, InputOwners& owners)
    : facts_(facts), connection_(connection), owners_(owners), frequency_(facts.rate) {}

RtdeSession::~RtdeSession() { owners_.release(connection_); }

std::string RtdeSession::message(std::string_view text) const {
  ByteWriter out;
  if (version_ >= 2) {
    out.short_text(text);
    out.short_text("snug");
    out.u8(kWarning);
  } else {
    out.u8(kWarning);
    out.text(text);
  }
  return rtde::encode(rtde::Frame::Text, out.bytes());
}

RtdeSession::Reply RtdeSession::answer(const rtde::FrameView& frame, RobotInputs& inputs) {
  const auto type = static_cast<rtde::Frame>(frame.type);
  ByteReader in(frame.payload);
  ByteWriter out;
  switch (type) {
    case rtde::Frame::Version: {
      const int wanted = in.u16();
      const bool is_known = in.is_good() && (wanted == 1 || wanted == 2);
      if (is_known) version_ = wanted;
      out.boolean(is_known);
      break;
    }
    case rtde::Frame::ControllerVersion:
      for (const std::uint32_t part : facts_.version) out.u32(part);
      break;
    case rtde::Frame::Outputs:
      return {rtde::encode(type, set_up_outputs(frame.payload)), false};
    case rtde::Frame::Inputs:
      return {rtde::encode(type, set_up_inputs(frame.payload)), false};
    case rtde::Frame::Start:
      is_started_ = !is_refused_;
      out.boolean(is_started_);
      break;
    case rtde::Frame::Pause:
      is_started_ = false;
      out.boolean(true);
      break;
    case rtde::Frame::Data:
      if (take_data(frame.payload, inputs)) return {{}, true};
      return {message("a data package that fits no input recipe"), false};
    case rtde::Frame::Text:
      return {};
    default:
      break;  // next_frame() gives no other
  }
  return {rtde::encode(type, out.bytes()), false};
}

std::string RtdeSession::set_up_outputs(std::string_view payload) {
  is_started_ = false;
  is_refused_ = wants_lockstep_ = false;
  frequency_ = facts_.rate;
  outputs_.clear();
  if (version_ >= 2) {
    ByteReader in(payload);
    const double wanted = in.f64();
    payload = in.rest();
    // 0 asks for the most; faster than that is not possible
    if (in.is_good() && wanted >= 1.0 && wanted < frequency_) frequency_ = wanted;
  }
  std::string types;
  const std::vector<std::string_view> names = names_of(payload);
  for (const std::string_view name : names) {
    const OutputField* field = find_field(internal::output_fields(), name);
    append(types, field != nullptr ? field->type : kNotFound);
    is_refused_ = is_refused_ || field == nullptr;
    wants_lockstep_ = wants_lockstep_ || name == rtde::kLockstep;
    if (field != nullptr) outputs_.push_back(static_cast<std::size_t>(field - internal::output_fields().data()));
  }
  is_refused_ = is_refused_ || names.empty() || names.size() > kMostFields || types.size() > 60000;
  has_outputs_ = !is_refused_;
  ByteWriter out;
  if (version_ >= 2) out.u8(has_outputs_ ? kOutputRecipe : 0);
  out.text(types.size() > 60000 ? std::string(kNotFound) : types);
  return out.take();
}

std::string RtdeSession::set_up_inputs(std::string_view payload) {
  InputRecipe recipe;
  std::string types;
  const std::vector<std::string_view> names = names_of(payload);
  bool is_refused = names.empty() || names.size() > kMostFields || inputs_.size() >= kMostRecipes;
  for (const std::string_view name : names) {
    const InputField* field = find_field(internal::input_fields(), name);
    const bool is_taken = field != nullptr && owners_.is_taken(name, connection_);
    if (types.size() < 60000) append(types, field == nullptr ? kNotFound : is_taken ? kInUse : field->type);
    is_refused = is_refused || field == nullptr || is_taken;
    if (is_refused) continue;
    recipe.fields.push_back(static_cast<std::size_t>(field - internal::input_fields().data()));
    recipe.size += field->size;
  }
  ByteWriter out;
  if (is_refused) {
    out.u8(0);
  } else {
    for (const std::string_view name : names) (void)owners_.claim(name, connection_);
    inputs_.push_back(std::move(recipe));
    out.u8(static_cast<std::uint8_t>(inputs_.size()));
  }
  out.text(types);
  return out.take();
}

namespace {

/// Numbers that are none set nothing.
bool is_finite(const InputField& field, ByteReader in) {
  const std::string_view type = field.type;
  if (type != "DOUBLE" && type != "VECTOR6D") return true;
  for (std::size_t i = 0; i < field.size; i += sizeof(double))
    if (!std::isfinite(in.f64())) return false;
  return true;
}

}  // namespace

bool RtdeSession::take_data(std::string_view payload, RobotInputs& inputs) const {
  ByteReader in(payload);
  const std::size_t id = in.u8();
  if (id < 1 || id > inputs_.size() || in.rest().size() != inputs_[id - 1].size) return false;
  for (const std::size_t index : inputs_[id - 1].fields) {
    const InputField& field = internal::input_fields()[index];
    const bool sets = is_finite(field, in);
    field.read(in, inputs);
    if (!sets) continue;
    inputs.counts.resize(internal::input_fields().size());
    ++inputs.counts[index];
  }
  return true;
}

std::string RtdeSession::package(const RobotData& data, std::int64_t period) {
  if (!is_started_ || !has_outputs_) return {};
  const double each = frequency_ / facts_.rate;  // packages a period
  if (std::floor(static_cast<double>(period) * each) == std::floor(static_cast<double>(period - 1) * each)) return {};
  ByteWriter out;
  if (version_ >= 2) out.u8(kOutputRecipe);
  for (const std::size_t field : outputs_) internal::output_fields()[field].write(data, out);
  return rtde::encode(rtde::Frame::Data, out.bytes());
}

}  // namespace snug::ur
