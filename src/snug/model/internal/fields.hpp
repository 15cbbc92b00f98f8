// read_fields: fills a settings struct from a mapping by the list of keys the struct itself gives.
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "snug/model/internal/value.hpp"

namespace snug::model::internal {

class KeyCollector {
 public:
  template <class... Any>
  void operator()(const char* key, Any&&...) {
    keys.emplace_back(key);
  }
  std::vector<std::string> keys;
};

template <class Settings>
void read_fields(const Value& value, const std::string& kind, Settings& settings);

/// Sets what the mapping has and leaves the defaults of the rest.
class FieldReader {
 public:
  explicit FieldReader(const MapReader& map) : map_(map) {}

  void operator()(const char* key, double& field, Range range) {
    if (const auto value = map_.find(key)) field = value->number(range);
  }
  void operator()(const char* key, std::optional<double>& field, Range range) {
    if (const auto value = map_.find(key)) field = value->number(range);
  }
  void operator()(const char* key, int& field, Range range) {
    if (const auto value = map_.find(key))
      field = static_cast<int>(value->integer(range == Range::Positive ? 1 : 0, 1'000'000'000));
  }
  void operator()(const char* key, double& field, Within range) {
    if (const auto value = map_.find(key)) field = value->number_within(range.low, range.high, "a number");
  }
  void operator()(const char* key, int& field, Within range) {
    if (const auto value = map_.find(key))
      field =
          static_cast<int>(value->integer(static_cast<std::int64_t>(range.low), static_cast<std::int64_t>(range.high)));
  }
  void operator()(const char* key, Degrees field, Within range) {
    if (const auto value = map_.find(key))
      field.radians = value->number_within(range.low, range.high, "degrees") * (std::numbers::pi / 180.0);
  }
  void operator()(const char* key, bool& field) {
    if (const auto value = map_.find(key)) field = value->boolean();
  }
  void operator()(const char* key, Degrees field, Range range) {
    if (const auto value = map_.find(key)) field.radians = value->radians_from_degrees(range);
  }
  template <class Settings>
  requires std::is_class_v<Settings>
  void operator()(const char* key, Settings& field) {
    if (const auto value = map_.find(key)) read_fields(*value, key, field);
  }

 private:
  const MapReader& map_;
};

template <class Settings>
[[nodiscard]] std::vector<std::string> field_keys() {
  Settings settings;
  KeyCollector collector;
  settings.fields(collector);
  return collector.keys;
}

template <class Settings>
void read_fields(const MapReader& map, Settings& settings) {
  FieldReader reader(map);
  settings.fields(reader);
}

template <class Settings>
void read_fields(const Value& value, const std::string& kind, Settings& settings) {
  read_fields(value.map(kind, field_keys<Settings>()), settings);
}

/// Keys of the settings and some more.
template <class Settings>
[[nodiscard]] std::vector<std::string> keys_with(const std::vector<std::string>& more) {
  std::vector<std::string> keys = field_keys<Settings>();
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

}  // namespace snug::model::internal
