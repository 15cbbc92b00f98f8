// JsonValue: a JSON document as a value; numbers keep every bit, keys their order.
#include "snug/core/json_value.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "snug/core/input_error.hpp"

namespace snug {
namespace {

using Json = nlohmann::ordered_json;

Json to_library(const JsonValue& from) {
  if (const auto* array = std::get_if<JsonValue::Array>(&from.value)) {
    Json to = Json::array();
    for (const JsonValue& one : *array) to.push_back(to_library(one));
    return to;
  }
  if (const auto* object = std::get_if<JsonValue::Object>(&from.value)) {
    Json to = Json::object();
    for (const auto& [key, one] : *object) to[key] = to_library(one);
    return to;
  }
  if (const auto* number = std::get_if<double>(&from.value)) {
    if (std::isfinite(*number)) return *number;
    return std::isnan(*number) ? "nan" : *number > 0.0 ? "inf" : "-inf";
  }
  if (const auto* number = std::get_if<std::int64_t>(&from.value)) return *number;
  if (const auto* number = std::get_if<std::uint64_t>(&from.value)) return *number;
  if (const auto* flag = std::get_if<bool>(&from.value)) return *flag;
  if (const auto* text = std::get_if<std::string>(&from.value)) return *text;
  return nullptr;
}

JsonValue from_library(const Json& from) {
  if (from.is_array()) {
    JsonValue::Array to;
    for (const Json& one : from) to.push_back(from_library(one));
    return {std::move(to)};
  }
  if (from.is_object()) {
    JsonValue::Object to;
    for (const auto& [key, one] : from.items()) to.push_back({key, from_library(one)});
    return {std::move(to)};
  }
  if (from.is_number_unsigned()) return {from.get<std::uint64_t>()};
  if (from.is_number_integer()) return {from.get<std::int64_t>()};
  if (from.is_number()) return {from.get<double>()};
  if (from.is_boolean()) return {from.get<bool>()};
  if (from.is_string()) return {from.get<std::string>()};
  return {};
}

}  // namespace

const JsonValue* JsonValue::find(std::string_view key) const {
  const auto* object = std::get_if<Object>(&value);
  if (object == nullptr) return nullptr;
  const auto found = std::ranges::find(*object, key, &Member::key);
  return found == object->end() ? nullptr : &found->value;
}

std::string_view JsonValue::kind() const {
  static constexpr std::array<std::string_view, 8> kKinds{"null",     "a number", "a number", "true or false",
                                                          "a number", "text",     "a list",   "an object"};
  return kKinds[value.index()];
}

std::string format_json(const JsonValue& value) {
  return to_library(value).dump(-1, ' ', false, Json::error_handler_t::replace);
}

bool JsonValue::operator==(const JsonValue& other) const { return value == other.value; }

bool is_shallow_json(std::string_view text) {
  int depth = 0;
  bool is_text = false;
  for (std::size_t i = 0; i < text.size() && depth <= kDeepestJson; ++i) {
    const char c = text[i];
    if (is_text) {
      if (c == '\\') ++i;
      is_text = c != '"';
    } else if (c == '"') {
      is_text = true;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return depth <= kDeepestJson;
}

JsonValue parse_json(std::string_view text, const std::string& where, int line) {
  if (!is_shallow_json(text)) {
    throw InputError(where + ":" + std::to_string(line), "", "lists or objects more than 64 deep in each other",
                     "JSON text");
  }
  try {
    return from_library(Json::parse(text));
  } catch (const Json::parse_error& error) {
    // Bytes count from 1; that of a text which ends too early is one behind its end.
    const std::string_view before = text.substr(0, error.byte > 0 ? error.byte - 1 : 0);
    line += static_cast<int>(std::ranges::count(before, '\n'));
    throw InputError(where + ":" + std::to_string(line), "", "", "JSON text");
  } catch (const Json::exception&) {  // a number; the library does not say where
    const bool is_line = text.find('\n') == std::string_view::npos;
    throw InputError(is_line ? where + ":" + std::to_string(line) : where, "",
                     "a number beyond the range of double precision", "finite numbers");
  }
}

}  // namespace snug
