// Built-in functions of URScript: their names and parameters, and what they do.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "snug/urscript/internal/motion.hpp"
#include "snug/urscript/internal/value.hpp"

namespace snug::urscript::internal {

/// An input of RTDE that clients have to set again and again, as rtde_set_watchdog says.
struct Watchdog {
  enum class Action { Ignore, Pause, Stop };
  std::string input;
  double patience = 1.0;  ///< s
  Action action = Action::Pause;
  std::uint64_t count = 0;  ///< of times that it was set, when it was last looked at
  double since = 0.0;       ///< s, of the program: then it was set
};

/// What a call sees. `arguments`: as many as the function has parameters; those that were not given are nothing.
struct CallContext {
  Host& host;
  Motion& motion;
  std::vector<Watchdog>& watchdogs;
  double time = 0.0;        ///< s, of the program
  std::int64_t period = 0;  ///< periods so far
  bool may_move = true;     ///< false: a secondary program
  std::vector<Value> arguments = {};
  /// Set: the thread waits, until this is true; then it has set the result. Asked once a period.
  std::function<bool(CallContext&, Value&)> wait = {};
  [[nodiscard]] bool has(std::size_t index) const { return arguments[index].kind != Value::Kind::None; }
  [[nodiscard]] double number(std::size_t index, double otherwise) const {
    return has(index) ? number_of(arguments[index], "argument") : otherwise;
  }
};

struct Builtin {
  std::string_view name;
  std::string_view parameters;  ///< "pose a v": in order
  int required = 0;
  Value (*call)(CallContext&) = nullptr;
};

/// -1: none.
[[nodiscard]] int find_builtin(std::string_view name);
[[nodiscard]] std::string nearest_builtin(std::string_view name);
[[nodiscard]] const Builtin& builtin(int index);
[[nodiscard]] std::span<const std::string> parameters_of(int index);

// By topic; each a list that find_builtin knows.
[[nodiscard]] std::span<const Builtin> math_builtins();
[[nodiscard]] std::span<const Builtin> motion_builtins();
[[nodiscard]] std::span<const Builtin> robot_builtins();
[[nodiscard]] std::span<const Builtin> io_builtins();

}  // namespace snug::urscript::internal
