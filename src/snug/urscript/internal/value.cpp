// Value: conversions and operators of URScript.
#include "snug/urscript/internal/value.hpp"

#include <fmt/format.h>

#include <cmath>

namespace snug::urscript::internal {
namespace {

constexpr std::size_t kLongestText = 1000;  // of a value in a message

Value elementwise(Operator operation, const Value& a, const Value& b) {
  const Value& list = a.is_list() ? a : b;
  Value result = Value::of(std::vector<Value>{});
  if (a.is_list() && b.is_list() && a.items.size() != b.items.size())
    throw Fault{fmt::format("lists of {} and {} elements", a.items.size(), b.items.size())};
  for (std::size_t i = 0; i < list.items.size(); ++i)
    result.items.push_back(apply(operation, a.is_list() ? a.items[i] : a, b.is_list() ? b.items[i] : b));
  return result;
}

Value compare(Operator operation, double a, double b) {
  switch (operation) {
    case Operator::Less:
      return Value::of(a < b);
    case Operator::LessEqual:
      return Value::of(a <= b);
    case Operator::Greater:
      return Value::of(a > b);
    default:
      return Value::of(a >= b);
  }
}

Value compute(Operator operation, const Value& a, const Value& b) {
  const double x = number_of(a, "operand"), y = number_of(b, "operand");
  const bool is_whole = a.kind == Value::Kind::Int && b.kind == Value::Kind::Int;
  double result = 0.0;
  switch (operation) {
    case Operator::Add:
      result = x + y;
      break;
    case Operator::Subtract:
      result = x - y;
      break;
    case Operator::Multiply:
      result = x * y;
      break;
    case Operator::Divide:
      if (y == 0.0) throw Fault{"division by zero"};
      return Value::of(x / y);
    default:
      if (y == 0.0) throw Fault{"remainder of a division by zero"};
      result = std::fmod(x, y);
  }
  Value value = Value::of(result);
  if (is_whole && std::abs(result) <= 2147483647.0) value.kind = Value::Kind::Int;
  return value;
}

}  // namespace

Value Value::of(const snug::Pose& pose) {
  const Vector3 turn = log_rotation(pose.R);
  Value value = list(std::array{pose.p.x(), pose.p.y(), pose.p.z(), turn.x(), turn.y(), turn.z()});
  value.kind = Kind::Pose;
  return value;
}

std::size_t Value::size() const {
  std::size_t sum = 1 + text.size();
  for (const Value& item : items) sum += item.size();
  return sum;
}

std::string Value::as_text() const {
  switch (kind) {
    case Kind::None:
      return "None";
    case Kind::Bool:
      return number != 0.0 ? "True" : "False";
    case Kind::Int:
      return fmt::format("{:.0f}", number);
    case Kind::Float:
      return fmt::format("{:.6g}", number);
    case Kind::String:
      return text;
    case Kind::Thread:
      return fmt::format("thread {:.0f}", number);
    default:
      break;
  }
  std::string result = kind == Kind::Pose ? "p[" : "[";
  for (std::size_t i = 0; i < items.size() && result.size() < kLongestText; ++i)
    result += (i == 0 ? "" : ", ") + items[i].as_text();
  return result + "]";
}

const char* name_of(Value::Kind kind) {
  switch (kind) {
    case Value::Kind::None:
      return "nothing";
    case Value::Kind::Bool:
      return "a boolean";
    case Value::Kind::Int:
      return "an integer";
    case Value::Kind::Float:
      return "a number";
    case Value::Kind::String:
      return "a string";
    case Value::Kind::List:
      return "a list";
    case Value::Kind::Pose:
      return "a pose";
    case Value::Kind::Thread:
      return "a thread";
  }
  return "?";
}

bool is_equal(const Value& a, const Value& b) {
  if (a.is_number() && b.is_number()) return a.number == b.number;
  if (a.is_list() && b.is_list()) {
    if (a.items.size() != b.items.size()) return false;
    for (std::size_t i = 0; i < a.items.size(); ++i)
      if (!is_equal(a.items[i], b.items[i])) return false;
    return true;
  }
  return a.kind == b.kind && a.number == b.number && a.text == b.text;
}

double number_of(const Value& value, const char* what) {
  if (value.is_number()) return value.number;
  throw Fault{fmt::format("{} is {}, not a number", what, name_of(value.kind))};
}

std::array<double, 6> six_of(const Value& value, const char* what) {
  if (!value.is_list() || value.items.size() != 6)
    throw Fault{fmt::format("{} is {}, not six numbers", what,
                            value.is_list() ? fmt::format("a list of {}", value.items.size()) : name_of(value.kind))};
  std::array<double, 6> six{};
  for (std::size_t i = 0; i < 6; ++i) {
    six[i] = number_of(value.items[i], what);
    if (!std::isfinite(six[i])) throw Fault{fmt::format("{} has a number that is not finite", what)};
  }
  return six;
}

Pose pose_of(const Value& value, const char* what) {
  const std::array<double, 6> six = six_of(value, what);
  return {exp_rotation(Vector3(six[3], six[4], six[5])), Vector3(six[0], six[1], six[2])};
}

Value apply(Operator operation, const Value& a, const Value& b) {
  switch (operation) {
    case Operator::Equal:
      return Value::of(is_equal(a, b));
    case Operator::Unequal:
      return Value::of(!is_equal(a, b));
    case Operator::Xor:
      return Value::of((number_of(a, "operand") != 0.0) != (number_of(b, "operand") != 0.0));
    case Operator::Less:
    case Operator::LessEqual:
    case Operator::Greater:
    case Operator::GreaterEqual:
      return compare(operation, number_of(a, "operand"), number_of(b, "operand"));
    default:
      break;
  }
  if (a.is_list() || b.is_list()) {
    const bool is_product = operation == Operator::Multiply || operation == Operator::Divide;
    if (a.kind == Value::Kind::Pose && b.kind == Value::Kind::Pose) throw Fault{"poses are added by pose_add"};
    if (is_product && a.is_list() && b.is_list()) throw Fault{"a product of two lists"};
    return elementwise(operation, a, b);
  }
  return compute(operation, a, b);
}

Value apply(Operator operation, const Value& a) {
  if (operation == Operator::Not) return Value::of(number_of(a, "operand of not") == 0.0);
  if (!a.is_list()) {
    Value result = a;
    result.number = -number_of(a, "operand of -");
    if (result.kind == Value::Kind::Bool) result.kind = Value::Kind::Int;
    return result;
  }
  Value result = a;
  for (Value& item : result.items) item = apply(operation, item);
  return result;
}

}  // namespace snug::urscript::internal
