// JsonWriter, JsonReader: structs that list their fields once, to JSON and back; each complaint has its path.
#pragma once

#include <concepts>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/json_value.hpp"

namespace snug {

class JsonWriter;
class JsonReader;

/// Enums say their names: specialize with `static constexpr std::array<T, n> all` beside a function name_of(T).
template <class T>
struct JsonEnum;

/// For types that are not ours to give fields(): specialize with `static JsonValue write(const T&)` and
/// `static T read(const JsonValue&, const JsonReader&)`.
template <class T>
struct JsonForm;

template <class T>
concept HasJsonForm = requires(const T& t) {
  JsonForm<T>::write(t);
};

template <class T>
[[nodiscard]] JsonValue write_json(const T& value);

/// Makes an object of what fields() lists.
class JsonWriter {
 public:
  static constexpr bool kReads = false;
  template <class T>
  void operator()(const char* key, const T& value) {
    object_.push_back({key, write_json(value)});
  }
  [[nodiscard]] JsonValue take() { return {std::move(object_)}; }

 private:
  JsonValue::Object object_;
};

/// Reads what JsonWriter made. Throws InputError for a key that is missing or not known, and for what it does not hold.
class JsonReader {
 public:
  static constexpr bool kReads = true;
  JsonReader(const JsonValue& value, std::string where, std::string path = {})
      : value_(value), where_(std::move(where)), path_(std::move(path)) {}

  [[nodiscard]] const JsonValue& value() const { return value_; }
  [[nodiscard]] const std::string& where() const { return where_; }
  [[noreturn]] void fail(const std::string& expected) const {
    throw InputError(where_, path_, std::string(value_.kind()), expected);
  }
  [[nodiscard]] JsonReader at(const JsonValue& part, const std::string& step) const {
    return {part, where_, path_.empty() ? step : path_ + "." + step};
  }

  template <class T>
  void operator()(const char* key, T& value) {
    known_.emplace_back(key);
    const JsonValue* part = value_.find(key);
    if (part == nullptr) throw InputError(where_, path_.empty() ? key : path_ + "." + key, "nothing", "this key");
    at(*part, key).read(value);
  }
  /// Every key of the object was asked for.
  void expect_no_more() const {
    const auto* object = std::get_if<JsonValue::Object>(&value_.value);
    if (object == nullptr) fail("an object");
    for (const auto& [key, part] : *object) {
      bool is_known = false;
      for (const std::string& one : known_) is_known = is_known || one == key;
      if (is_known) continue;
      const std::string nearest(find_nearest(key, known_));
      throw InputError(where_, path_.empty() ? key : path_ + "." + key, "an unknown key",
                       nearest.empty() ? "one that is known" : nearest);
    }
  }

  template <class T>
  void read(T& value) const;
  template <class T>
  [[nodiscard]] T as() const {
    T value{};
    read(value);
    return value;
  }

 private:
  const JsonValue& value_;
  std::string where_, path_;
  std::vector<std::string> known_;
};

namespace json_detail {

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

[[nodiscard]] double number_of(const JsonReader& reader);
[[nodiscard]] std::int64_t whole_of(const JsonReader& reader);
[[nodiscard]] std::uint64_t unsigned_of(const JsonReader& reader);

}  // namespace json_detail

template <class T>
JsonValue write_json(const T& value) {
  if constexpr (HasJsonForm<T>) {
    return JsonForm<T>::write(value);
  } else if constexpr (std::same_as<T, bool>) {
    return {value};
  } else if constexpr (std::floating_point<T>) {
    return {static_cast<double>(value)};
  } else if constexpr (std::unsigned_integral<T>) {
    return {static_cast<std::uint64_t>(value)};
  } else if constexpr (std::signed_integral<T>) {
    if (value >= 0) return {static_cast<std::uint64_t>(value)};
    return {static_cast<std::int64_t>(value)};
  } else if constexpr (std::convertible_to<const T&, std::string>) {
    return {std::string(value)};
  } else if constexpr (std::is_enum_v<T>) {
    return {std::string(name_of(value))};
  } else if constexpr (json_detail::IsOptional<T>::value) {
    return value ? write_json(*value) : JsonValue{};
  } else if constexpr (json_detail::IsVector<T>::value) {
    JsonValue::Array array;
    for (const auto& one : value) array.push_back(write_json(one));
    return {std::move(array)};
  } else {
    JsonWriter writer;
    const_cast<T&>(value).fields(writer);  // NOLINT(cppcoreguidelines-pro-type-const-cast): a writer changes nothing
    return writer.take();
  }
}

template <class T>
void JsonReader::read(T& value) const {
  if constexpr (HasJsonForm<T>) {
    value = JsonForm<T>::read(value_, *this);
  } else if constexpr (std::same_as<T, bool>) {
    const bool* flag = std::get_if<bool>(&value_.value);
    if (flag == nullptr) fail("true or false");
    value = *flag;
  } else if constexpr (std::floating_point<T>) {
    value = static_cast<T>(json_detail::number_of(*this));
  } else if constexpr (std::unsigned_integral<T>) {
    value = static_cast<T>(json_detail::unsigned_of(*this));
  } else if constexpr (std::signed_integral<T>) {
    value = static_cast<T>(json_detail::whole_of(*this));
  } else if constexpr (std::same_as<T, std::string>) {
    const std::string* text = std::get_if<std::string>(&value_.value);
    if (text == nullptr) fail("text");
    value = *text;
  } else if constexpr (std::is_enum_v<T>) {
    const std::string* text = std::get_if<std::string>(&value_.value);
    std::vector<std::string> names;
    for (const T one : JsonEnum<T>::all) {
      if (text != nullptr && *text == name_of(one)) {
        value = one;
        return;
      }
      names.emplace_back(name_of(one));
    }
    std::string expected = "one of";
    for (const std::string& name : names) expected += " '" + name + "'";
    throw InputError(where_, path_, text == nullptr ? std::string(value_.kind()) : "'" + *text + "'", expected);
  } else if constexpr (json_detail::IsOptional<T>::value) {
    value.reset();
    if (!value_.is_null()) read(value.emplace());
  } else if constexpr (json_detail::IsVector<T>::value) {
    const auto* array = std::get_if<JsonValue::Array>(&value_.value);
    if (array == nullptr) fail("a list");
    value.clear();
    for (std::size_t i = 0; i < array->size(); ++i) {
      value.push_back(at((*array)[i], "[" + std::to_string(i) + "]").as<typename T::value_type>());
    }
  } else {
    JsonReader reader(value_, where_, path_);
    value.fields(reader);
    reader.expect_no_more();
  }
}

}  // namespace snug
