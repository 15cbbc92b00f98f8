// SensorReader: the Sensor of a frame after the Sensor before it: what stayed the same is not read again.
#include "snug/click/internal/sensor_reader.hpp"

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <utility>

#include "snug/click/sensor_writer.hpp"

namespace snug::click::internal {
namespace {

using wire::decode_object;
using wire::kBytes;
using wire::kDouble;
using wire::kEntryKey;
using wire::kEntryValue;
using wire::kObjects;
using wire::kSensorType;
using wire::kSimulatedTime;
using wire::kSimVars;
using wire::kType;
using wire::kVarint;
using wire::WireType;

/// A field of protobuf's wire form.
struct WireField {
  std::uint64_t tag = 0;    ///< its number and its kind
  std::uint64_t value = 0;  ///< of a number
  std::string_view bytes;   ///< of a text or a part
};

/// Reads fields one after the other; nothing at the end and where they cannot be read.
class FieldReader {
 public:
  explicit FieldReader(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] std::optional<WireField> next() {
    WireField field;
    if (bytes_.empty() || !varint(field.tag)) return std::nullopt;
    switch (field.tag & 7U) {
      case kVarint:
        return varint(field.value) ? std::optional(field) : std::nullopt;
      case kDouble:
        if (bytes_.size() < sizeof field.value) return std::nullopt;
        for (std::size_t i = 0; i < sizeof field.value; ++i) {
          field.value |= std::uint64_t{static_cast<unsigned char>(bytes_[i])} << (8 * i);
        }
        bytes_.remove_prefix(sizeof field.value);
        return field;
      case kBytes: {
        std::uint64_t size = 0;
        if (!varint(size) || size > bytes_.size()) return std::nullopt;
        field.bytes = bytes_.substr(0, size);
        bytes_.remove_prefix(size);
        return field;
      }
      default:
        return std::nullopt;
    }
  }
  [[nodiscard]] bool is_at_end() const { return bytes_.empty(); }

 private:
  bool varint(std::uint64_t& value) {
    value = 0;
    for (unsigned shift = 0; shift < 64 && !bytes_.empty(); shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes_.front());
      bytes_.remove_prefix(1);
      value |= std::uint64_t{byte & 0x7FU} << shift;
      if (byte < 0x80) return true;
    }
    return false;
  }

  std::string_view bytes_;
};

constexpr std::uint64_t tag(unsigned field, WireType type) { return field << 3U | type; }

/// Calls part(name, bytes) for each object, in the order of the frame. Nothing where the frame is no Sensor, or one
/// with anything else in it; else its time.
template <class Part>
std::optional<double> split(std::string_view frame, const Part& part) {
  double time = 0.0;
  bool is_sensor = false;
  FieldReader fields(frame);
  while (const std::optional<WireField> field = fields.next()) {
    if (field->tag == tag(kType, kVarint)) {
      is_sensor = field->value == kSensorType;
    } else if (field->tag == tag(kObjects, kBytes)) {
      FieldReader entry(field->bytes);
      const std::optional<WireField> key = entry.next(), value = entry.next();
      if (!key || !value || !entry.is_at_end()) return std::nullopt;
      if (key->tag != tag(kEntryKey, kBytes) || value->tag != tag(kEntryValue, kBytes)) return std::nullopt;
      if (!part(key->bytes, value->bytes)) return std::nullopt;
    } else if (field->tag == tag(kSimVars, kBytes)) {
      FieldReader vars(field->bytes);
      while (const std::optional<WireField> var = vars.next()) {
        if (var->tag != tag(kSimulatedTime, kDouble)) return std::nullopt;
        time = std::bit_cast<double>(var->value);
      }
      if (!vars.is_at_end()) return std::nullopt;
    } else {
      return std::nullopt;
    }
  }
  return is_sensor && fields.is_at_end() ? std::optional(time) : std::nullopt;
}

}  // namespace

const Sensor* SensorReader::read(std::string_view frame) {
  std::size_t count = 0;
  const std::optional<double> time = split(frame, [&](std::string_view name, std::string_view bytes) {
    if (count == objects_.size() || objects_[count].name != name) return false;
    Object& object = objects_[count++];
    if (object.bytes == bytes) return true;
    Expected<ObjectSensors, std::string> sensors = decode_object(bytes);
    if (!sensors) return false;
    *object.sensors = std::move(*sensors);
    object.bytes = bytes;
    return true;
  });
  if (!time || count != objects_.size()) return nullptr;
  sensor_.time = *time;
  return &sensor_;
}

const Sensor& SensorReader::learn(std::string_view frame, Sensor sensor) {
  sensor_ = std::move(sensor);
  objects_.clear();
  const bool is_split = split(frame, [&](std::string_view name, std::string_view bytes) {
                          const auto found = sensor_.objects.find(name);
                          if (found == sensor_.objects.end()) return false;
                          objects_.push_back({std::string(name), std::string(bytes), &found->second});
                          return true;
                        }).has_value();
  if (!is_split || objects_.size() != sensor_.objects.size()) objects_.clear();
  return sensor_;
}

}  // namespace snug::click::internal
