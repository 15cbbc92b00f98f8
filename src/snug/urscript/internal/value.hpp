// Value: what a variable of a URScript program holds.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::urscript::internal {

struct Value {
  enum class Kind : std::uint8_t { None, Bool, Int, Float, String, List, Pose, Thread };
  Kind kind = Kind::None;
  double number = 0.0;  ///< Bool, Int, Float, Thread
  std::string text;
  std::vector<Value> items;  ///< List; of a Pose six numbers: m and rotation vector, rad

  static Value of(bool value) { return {Kind::Bool, value ? 1.0 : 0.0, {}, {}}; }
  static Value of(double value) { return {Kind::Float, value, {}, {}}; }
  static Value of(int value) { return {Kind::Int, static_cast<double>(value), {}, {}}; }
  static Value of(std::string value) { return {Kind::String, 0.0, std::move(value), {}}; }
  static Value of(std::vector<Value> values) { return {Kind::List, 0.0, {}, std::move(values)}; }
  static Value thread(int id) { return {Kind::Thread, static_cast<double>(id), {}, {}}; }
  static Value of(const Pose& pose);
  template <class Numbers>
  static Value list(const Numbers& numbers) {
    std::vector<Value> values;
    for (const double x : numbers) values.push_back(of(x));
    return of(std::move(values));
  }

  [[nodiscard]] bool is_number() const { return kind == Kind::Int || kind == Kind::Float || kind == Kind::Bool; }
  [[nodiscard]] bool is_list() const { return kind == Kind::List || kind == Kind::Pose; }
  /// Elements of lists with those in them, bytes of strings; at least 1.
  [[nodiscard]] std::size_t size() const;
  /// As textmsg and to_str write it.
  [[nodiscard]] std::string as_text() const;
};

[[nodiscard]] const char* name_of(Value::Kind kind);
[[nodiscard]] bool is_equal(const Value& a, const Value& b);

/// Why an operation or a function cannot be; becomes the error of the program.
struct Fault {
  std::string text;
  bool stops_arm = false;  ///< a controller stops for protection: nothing in the program could have caught it
};

/// Throw Fault.
[[nodiscard]] double number_of(const Value& value, const char* what);
[[nodiscard]] Pose pose_of(const Value& value, const char* what);
/// Six numbers.
[[nodiscard]] std::array<double, 6> six_of(const Value& value, const char* what);

enum class Operator : std::uint8_t {
  Or,
  Xor,
  And,
  Equal,
  Unequal,
  Less,
  LessEqual,
  Greater,
  GreaterEqual,
  Add,
  Subtract,
  Multiply,
  Divide,
  Modulo,
  Not,
  Negate
};
[[nodiscard]] Value apply(Operator operation, const Value& a, const Value& b);
[[nodiscard]] Value apply(Operator operation, const Value& a);

}  // namespace snug::urscript::internal
