// Numbers, lists, strings and poses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/urscript/internal/builtins.hpp"

namespace snug::urscript::internal {
namespace {

double arg(const CallContext& call, std::size_t index) { return number_of(call.arguments[index], "argument"); }
const std::string& text_arg(const CallContext& call, std::size_t index) {
  if (call.arguments[index].kind != Value::Kind::String)
    throw Fault{fmt::format("an argument is {}, not a string", name_of(call.arguments[index].kind))};
  return call.arguments[index].text;
}
Pose pose_arg(const CallContext& call, std::size_t index) { return pose_of(call.arguments[index], "an argument"); }

double finite(double x, const char* what) {
  if (!std::isfinite(x)) throw Fault{fmt::format("{} of a number that has none", what)};
  return x;
}

int length(const Value& value) {
  if (value.kind == Value::Kind::String) return static_cast<int>(value.text.size());
  if (value.is_list()) return static_cast<int>(value.items.size());
  throw Fault{fmt::format("the length of {}", name_of(value.kind))};
}

Value norm(CallContext& call) {
  if (!call.arguments[0].is_list()) return Value::of(std::abs(arg(call, 0)));
  double sum = 0.0;
  for (const Value& item : call.arguments[0].items) sum += std::pow(number_of(item, "an element"), 2);
  return Value::of(std::sqrt(sum));
}

/// Roll, pitch, yaw about fixed axes.
Value to_rotation_vector(CallContext& call) {
  const Value& rpy = call.arguments[0];
  if (!rpy.is_list() || rpy.items.size() != 3) throw Fault{"three angles are expected"};
  const auto turn = [&](int axis) {
    Vector3 w = Vector3::Zero();
    w[axis] = number_of(rpy.items[static_cast<std::size_t>(axis)], "an angle");
    return exp_rotation(w);
  };
  const Vector3 w = log_rotation(turn(2) * turn(1) * turn(0));
  return Value::list(std::array{w.x(), w.y(), w.z()});
}
Value to_rpy(CallContext& call) {
  const Value& w = call.arguments[0];
  if (!w.is_list() || w.items.size() != 3) throw Fault{"three numbers are expected"};
  const Matrix3 R =
      exp_rotation(Vector3(number_of(w.items[0], "x"), number_of(w.items[1], "y"), number_of(w.items[2], "z")));
  return Value::list(std::array{std::atan2(R(2, 1), R(2, 2)), std::asin(std::clamp(-R(2, 0), -1.0, 1.0)),
                                std::atan2(R(1, 0), R(0, 0))});
}

Value substring(CallContext& call) {
  const std::string& text = text_arg(call, 0);
  const double begin = arg(call, 1), count = call.number(2, 1e9);
  if (!(begin >= 0.0) || begin > static_cast<double>(text.size()) || !(count >= 0.0))
    throw Fault{"a place outside of the string"};
  return Value::of(text.substr(static_cast<std::size_t>(begin), static_cast<std::size_t>(std::min(count, 1e9))));
}

Value to_number(CallContext& call) {
  const std::string& text = text_arg(call, 0);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || end != text.c_str() + text.size())
    throw Fault{fmt::format("'{}' is no number", text.substr(0, 40))};
  Value result = Value::of(value);
  if (text.find_first_not_of("+-0123456789") == std::string::npos && std::abs(value) < 2147483647.0)
    result.kind = Value::Kind::Int;
  return result;
}

Value whole(double x) {
  if (!(std::abs(x) <= 2147483647.0)) throw Fault{"a number too large for an integer"};
  return Value::of(static_cast<int>(x));
}

Pose between(const Pose& a, const Pose& b, double share) {
  return {a.R * exp_rotation(share * log_rotation(a.R.transpose() * b.R)), a.p + share * (b.p - a.p)};
}

const Builtin kMath[] = {
    {"sin", "f", 1, [](CallContext& c) { return Value::of(std::sin(arg(c, 0))); }},
    {"cos", "f", 1, [](CallContext& c) { return Value::of(std::cos(arg(c, 0))); }},
    {"tan", "f", 1, [](CallContext& c) { return Value::of(std::tan(arg(c, 0))); }},
    {"asin", "f", 1, [](CallContext& c) { return Value::of(finite(std::asin(arg(c, 0)), "asin")); }},
    {"acos", "f", 1, [](CallContext& c) { return Value::of(finite(std::acos(arg(c, 0)), "acos")); }},
    {"atan", "f", 1, [](CallContext& c) { return Value::of(std::atan(arg(c, 0))); }},
    {"atan2", "x y", 2, [](CallContext& c) { return Value::of(std::atan2(arg(c, 0), arg(c, 1))); }},
    {"sqrt", "f", 1, [](CallContext& c) { return Value::of(finite(std::sqrt(arg(c, 0)), "sqrt")); }},
    {"log", "b f", 2,
     [](CallContext& c) { return Value::of(finite(std::log(arg(c, 1)) / std::log(arg(c, 0)), "log")); }},
    {"pow", "base exponent", 2,
     [](CallContext& c) { return Value::of(finite(std::pow(arg(c, 0), arg(c, 1)), "pow")); }},
    {"ceil", "f", 1, [](CallContext& c) { return whole(std::ceil(arg(c, 0))); }},
    {"floor", "f", 1, [](CallContext& c) { return whole(std::floor(arg(c, 0))); }},
    {"abs", "f", 1, [](CallContext& c) { return Value::of(std::abs(arg(c, 0))); }},
    {"d2r", "d", 1, [](CallContext& c) { return Value::of(arg(c, 0) * std::numbers::pi / 180.0); }},
    {"r2d", "r", 1, [](CallContext& c) { return Value::of(arg(c, 0) * 180.0 / std::numbers::pi); }},
    {"norm", "a", 1, norm},
    {"length", "v", 1, [](CallContext& c) { return Value::of(length(c.arguments[0])); }},
    {"size", "v", 1, [](CallContext& c) { return Value::of(length(c.arguments[0])); }},
    {"get_list_length", "v", 1, [](CallContext& c) { return Value::of(length(c.arguments[0])); }},
    {"str_len", "str", 1, [](CallContext& c) { return Value::of(static_cast<int>(text_arg(c, 0).size())); }},
    {"str_empty", "str", 1, [](CallContext& c) { return Value::of(text_arg(c, 0).empty()); }},
    {"str_cat", "op1 op2", 2,
     [](CallContext& c) { return Value::of(c.arguments[0].as_text() + c.arguments[1].as_text()); }},
    {"str_sub", "src index len", 2, substring},
    {"str_at", "src index", 2,
     [](CallContext& c) {
       c.arguments.push_back(Value::of(1));
       return substring(c);
     }},
    {"str_find", "src target start_from", 2,
     [](CallContext& c) {
       const std::size_t at =
           text_arg(c, 0).find(text_arg(c, 1), static_cast<std::size_t>(std::clamp(c.number(2, 0.0), 0.0, 1e9)));
       return Value::of(at == std::string::npos ? -1 : static_cast<int>(at));
     }},
    {"to_num", "str", 1, to_number},
    {"to_str", "val", 1, [](CallContext& c) { return Value::of(c.arguments[0].as_text()); }},
    {"pose_add", "p_1 p_2", 2,
     [](CallContext& c) {
       const Pose a = pose_arg(c, 0), b = pose_arg(c, 1);
       return Value::of(Pose{a.R * b.R, a.p + b.p});
     }},
    {"pose_sub", "p_to p_from", 2,
     [](CallContext& c) {
       const Pose a = pose_arg(c, 0), b = pose_arg(c, 1);
       return Value::of(Pose{a.R * b.R.transpose(), a.p - b.p});
     }},
    {"pose_trans", "p_from p_from_to", 2, [](CallContext& c) { return Value::of(pose_arg(c, 0) * pose_arg(c, 1)); }},
    {"pose_inv", "p_from", 1, [](CallContext& c) { return Value::of(pose_arg(c, 0).inverse()); }},
    {"pose_dist", "p_from p_to", 2,
     [](CallContext& c) { return Value::of((pose_arg(c, 0).p - pose_arg(c, 1).p).norm()); }},
    {"point_dist", "p_from p_to", 2,
     [](CallContext& c) { return Value::of((pose_arg(c, 0).p - pose_arg(c, 1).p).norm()); }},
    {"interpolate_pose", "p_from p_to alpha", 3,
     [](CallContext& c) { return Value::of(between(pose_arg(c, 0), pose_arg(c, 1), arg(c, 2))); }},
    {"rpy2rotvec", "rpy", 1, to_rotation_vector},
    {"rotvec2rpy", "rotation_vector", 1, to_rpy},
};

}  // namespace

std::span<const Builtin> math_builtins() { return kMath; }

}  // namespace snug::urscript::internal
