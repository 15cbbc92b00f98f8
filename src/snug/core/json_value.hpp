// JsonValue: a JSON document as a value; numbers keep every bit, keys their order.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace snug {

struct JsonValue {
  using Array = std::vector<JsonValue>;
  struct Member;  // a type of its own: a pair of an incomplete type is none for every compiler
  using Object = std::vector<Member>;
  /// Whole numbers below 0 are the second, others the third.
  std::variant<std::monostate, std::int64_t, std::uint64_t, bool, double, std::string, Array, Object> value;

  /// nullptr where this is no object, or has no such key.
  [[nodiscard]] const JsonValue* find(std::string_view key) const;
  [[nodiscard]] bool is_null() const { return std::holds_alternative<std::monostate>(value); }
  /// For messages: "a number", "an object".
  [[nodiscard]] std::string_view kind() const;
  bool operator==(const JsonValue& other) const;
};

struct JsonValue::Member {
  std::string key;
  JsonValue value;
  bool operator==(const Member&) const = default;
};

/// Numbers in the shortest form that reads back exactly; those that are not finite as "inf", "-inf" and "nan".
[[nodiscard]] std::string format_json(const JsonValue& value);
/// Lists and objects in each other, at most this deep: who walks through deeper ones runs out of stack.
inline constexpr int kDeepestJson = 64;
[[nodiscard]] bool is_shallow_json(std::string_view text);
/// Throws InputError with `where:line` for text that is no JSON, or deeper than kDeepestJson. `line`: of its first
/// character.
[[nodiscard]] JsonValue parse_json(std::string_view text, const std::string& where, int line = 1);

}  // namespace snug
