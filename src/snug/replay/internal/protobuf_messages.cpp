// ProtobufMessages: JSON written field by field as the descriptor of its message says. The library's own messages, set
// by reflection, took twice the time of all of an export.
#include "snug/replay/internal/protobuf_messages.hpp"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/descriptor.pb.h>
#include <mcap_descriptors.hpp>

#include <bit>
#include <map>
#include <set>

#include "snug/core/check.hpp"
#include "snug/core/text.hpp"

namespace snug::replay::internal {
namespace {

namespace pb = google::protobuf;

void add_with_imports(const pb::FileDescriptor& file, std::set<std::string>& seen, pb::FileDescriptorSet& files) {
  if (!seen.insert(std::string(file.name())).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) add_with_imports(*file.dependency(i), seen, files);
  file.CopyTo(files.add_file());
}

struct MessagePlan;

struct Field {
  pb::FieldDescriptor::Type type = pb::FieldDescriptor::TYPE_DOUBLE;
  std::uint32_t tag = 0;  ///< number and wire type, as written
  bool is_repeated = false;
  bool is_packed = false;               ///< of numbers: one length, then all of them
  bool has_presence = false;            ///< written though it is 0 or empty
  const MessagePlan* inside = nullptr;  ///< of a message
};

/// What a message is written by: its fields by the keys that they have in JSON.
struct MessagePlan {
  std::map<std::string, Field, std::less<>> fields;
};

/// The key of a field: times have the keys of ROS.
std::string key_of(const pb::FieldDescriptor& field) {
  if (field.name() == "seconds") return "sec";
  return field.name() == "nanos" ? "nsec" : std::string(field.name());
}

// The wire format: protobuf.dev/programming-guides/encoding.
enum WireType : std::uint32_t { kVarint = 0, kFixed64 = 1, kLengthDelimited = 2, kFixed32 = 5 };

WireType wire_type_of(const pb::FieldDescriptor& field) {
  switch (field.type()) {
    case pb::FieldDescriptor::TYPE_DOUBLE:
      return kFixed64;
    case pb::FieldDescriptor::TYPE_FIXED32:
      return field.is_packed() ? kLengthDelimited : kFixed32;
    case pb::FieldDescriptor::TYPE_BOOL:
    case pb::FieldDescriptor::TYPE_INT32:
    case pb::FieldDescriptor::TYPE_INT64:
    case pb::FieldDescriptor::TYPE_UINT32:
    case pb::FieldDescriptor::TYPE_ENUM:
      return kVarint;
    default:
      return kLengthDelimited;
  }
}

void put_varint(std::string& out, std::uint64_t value) {
  for (; value >= 0x80U; value >>= 7U) out += static_cast<char>((value & 0x7FU) | 0x80U);
  out += static_cast<char>(value);
}

template <class Value>
void put_fixed(std::string& out, Value value) {
  for (std::size_t i = 0; i < sizeof(Value); ++i) out += static_cast<char>((value >> (8U * i)) & 0xFFU);
}

/// Puts the length of what follows `begin` there.
void insert_length(std::string& out, std::size_t begin) {
  std::string length;
  put_varint(length, out.size() - begin);
  out.insert(begin, length);
}

void put_message(std::string& out, const MessagePlan& plan, const Json& json);

/// A value behind its tag; nothing where it is what a reader takes an absent field for.
void put_field(std::string& out, const Field& field, const Json& value, bool is_item) {
  const bool is_always = is_item || field.has_presence;
  const auto put_number = [&](std::uint64_t number) {
    if (number == 0 && !is_always) return;
    put_varint(out, field.tag);
    put_varint(out, number);
  };
  switch (field.type) {
    case pb::FieldDescriptor::TYPE_DOUBLE: {
      const auto bits = std::bit_cast<std::uint64_t>(value.get<double>());
      if (bits == 0 && !is_always) return;
      put_varint(out, field.tag);
      return put_fixed(out, bits);
    }
    case pb::FieldDescriptor::TYPE_FIXED32: {
      const auto number = value.get<std::uint32_t>();
      if (number == 0 && !is_always) return;
      put_varint(out, field.tag);
      return put_fixed(out, number);
    }
    case pb::FieldDescriptor::TYPE_BOOL:
      return put_number(value.get<bool>() ? 1 : 0);
    case pb::FieldDescriptor::TYPE_INT32:
    case pb::FieldDescriptor::TYPE_INT64:
    case pb::FieldDescriptor::TYPE_ENUM:
      return put_number(static_cast<std::uint64_t>(value.get<std::int64_t>()));
    case pb::FieldDescriptor::TYPE_UINT32:
      return put_number(value.get<std::uint32_t>());
    case pb::FieldDescriptor::TYPE_STRING: {
      const auto& text = value.get_ref<const std::string&>();
      if (text.empty() && !is_always) return;
      // Protocol buffers have texts in UTF-8: what is not is replaced as in JSON.
      const std::string valid = is_utf8(text) ? text : Json::parse(to_text(Json(text))).get<std::string>();
      put_varint(out, field.tag);
      put_varint(out, valid.size());
      out += valid;
      return;
    }
    case pb::FieldDescriptor::TYPE_MESSAGE: {
      put_varint(out, field.tag);
      const std::size_t begin = out.size();
      put_message(out, *field.inside, value);
      return insert_length(out, begin);
    }
    default:
      SNUG_CHECK(false, "a type that the schemas have");
  }
}

void put_packed(std::string& out, const Field& field, const Json& values) {
  SNUG_CHECK(field.type == pb::FieldDescriptor::TYPE_FIXED32, "a type that the schemas have many of");
  if (values.empty()) return;
  put_varint(out, field.tag);
  put_varint(out, sizeof(std::uint32_t) * values.size());
  for (const Json& value : values) put_fixed(out, value.get<std::uint32_t>());
}

void put_message(std::string& out, const MessagePlan& plan, const Json& json) {
  SNUG_CHECK(json.is_object(), "a message is an object");
  for (auto entry = json.begin(); entry != json.end(); ++entry) {
    const auto found = plan.fields.find(entry.key());
    SNUG_CHECK(found != plan.fields.end(), "a key that the schema has");
    const Field& field = found->second;
    if (!field.is_repeated) {
      put_field(out, field, *entry, false);
      continue;
    }
    SNUG_CHECK(entry->is_array(), "an array where the schema has many");
    if (field.is_packed) {
      put_packed(out, field, *entry);
    } else {
      for (const Json& item : *entry) put_field(out, field, item, true);
    }
  }
}

}  // namespace

struct ProtobufMessages::Impl {
  pb::DescriptorPool pool;
  std::map<std::string, MessagePlan, std::less<>> plans;  ///< of messages that were written, and of what is in them

  [[nodiscard]] const pb::Descriptor& type(std::string_view name) const {
    const pb::Descriptor* descriptor = pool.FindMessageTypeByName(std::string(name));
    SNUG_CHECK(descriptor != nullptr, "a message that proto/ has");
    return *descriptor;
  }

  const MessagePlan& plan(const pb::Descriptor& type) {
    const auto [at, is_new] = plans.try_emplace(std::string(type.full_name()));
    if (!is_new) return at->second;
    for (int i = 0; i < type.field_count(); ++i) {
      const pb::FieldDescriptor& field = *type.field(i);
      const MessagePlan* inside = field.message_type() != nullptr ? &plan(*field.message_type()) : nullptr;
      at->second.fields[key_of(field)] = {
          field.type(),         static_cast<std::uint32_t>(field.number()) << 3U | wire_type_of(field),
          field.is_repeated(),  field.is_packed(),
          field.has_presence(), inside};
    }
    return at->second;
  }
};

ProtobufMessages::ProtobufMessages() : impl_(std::make_unique<Impl>()) {
  pb::FileDescriptorSet files;
  const bool is_read = files.ParseFromArray(kMcapDescriptors.data(), static_cast<int>(kMcapDescriptors.size()));
  SNUG_CHECK(is_read, "descriptors that protoc wrote");
  for (const pb::FileDescriptorProto& file : files.file()) {
    const bool is_built = impl_->pool.BuildFile(file) != nullptr;
    SNUG_CHECK(is_built, "descriptors in the order of their imports");
  }
}

ProtobufMessages::~ProtobufMessages() = default;

std::string ProtobufMessages::descriptors_of(std::string_view type) const {
  pb::FileDescriptorSet files;
  std::set<std::string> seen;
  add_with_imports(*impl_->type(type).file(), seen, files);
  return files.SerializeAsString();
}

std::string ProtobufMessages::encode(std::string_view type, const Json& message) {
  const auto known = impl_->plans.find(type);
  std::string encoded;
  put_message(encoded, known != impl_->plans.end() ? known->second : impl_->plan(impl_->type(type)), message);
  return encoded;
}

}  // namespace snug::replay::internal
