// Machine::Impl: variables and threads of a program that runs, and what its instructions do to them.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "snug/urscript/internal/builtins.hpp"
#include "snug/urscript/internal/code.hpp"
#include "snug/urscript/machine.hpp"

namespace snug::urscript {
using internal::CallContext;
using internal::Fault;
using internal::Instruction;
using internal::Op;
using internal::Value;

inline constexpr std::size_t kStack = 5000;  // values of a thread
inline constexpr std::size_t kCostly = 16;   // elements that cost as much as an instruction

struct Frame {
  int function = 0;
  int next = 0;  ///< instruction
  std::vector<Value> locals;
  std::vector<bool> given;
};

struct Thread {
  int id = 0;
  std::vector<Frame> frames;
  std::vector<Value> stack;
  std::function<bool(CallContext&, Value&)> wait;
  bool is_critical = false;  ///< between enter_critical and exit_critical
  bool is_done = false;
};

struct Machine::Impl {
  Impl(Program to_run, const MachineLimits& most) : program(std::move(to_run)), limits(most) {
    globals.resize(code().globals.size());
    start(0, {}, {});
  }

  [[nodiscard]] const internal::Code& code() const { return program.code(); }
  [[nodiscard]] const internal::Function& function(int index) const {
    return code().functions[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] const Instruction& at(const Thread& thread) const {
    return code().instructions[static_cast<std::size_t>(thread.frames.back().next)];
  }

  int start(int index, std::vector<Value> arguments, const internal::CallNames& names) {
    if (threads.size() >= limits.threads) throw Fault{fmt::format("more than {} threads", limits.threads)};
    Thread thread;
    thread.id = next_thread++;
    enter(thread, index, std::move(arguments), names);
    threads.push_back(std::move(thread));
    return threads.back().id;
  }

  void enter(Thread& thread, int index, std::vector<Value> arguments, const internal::CallNames& names) {
    if (thread.frames.size() >= limits.call_depth)
      throw Fault{fmt::format("functions called more than {} deep", limits.call_depth)};
    const internal::Function& callee = function(index);
    Frame frame;
    frame.function = index;
    frame.next = callee.begin;
    frame.locals.resize(static_cast<std::size_t>(callee.locals));
    frame.given.assign(callee.parameters.size(), false);
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      const std::size_t slot = slot_of(callee.parameters, names, i, callee.name, frame.given);
      store(frame.locals[slot], std::move(arguments[i]));
    }
    for (std::size_t i = 0; i < callee.parameters.size(); ++i)
      if (!frame.given[i] && !callee.has_default[i])
        throw Fault{fmt::format("{} needs '{}'", callee.name, callee.parameters[i])};
    thread.frames.push_back(std::move(frame));
  }

  template <class Names>
  static std::size_t slot_of(const Names& parameters, const internal::CallNames& names, std::size_t argument,
                             std::string_view callee, std::vector<bool>& given) {
    std::size_t slot = argument;
    if (argument < names.size() && !names[argument].empty()) {
      const auto found = std::find(parameters.begin(), parameters.end(), names[argument]);
      if (found == parameters.end()) throw Fault{fmt::format("{} has no parameter '{}'", callee, names[argument])};
      slot = static_cast<std::size_t>(found - parameters.begin());
    }
    if (slot >= parameters.size())
      throw Fault{fmt::format("{} takes {} arguments, not {}", callee, parameters.size(), argument + 1)};
    if (given[slot]) throw Fault{fmt::format("'{}' of {} is given twice", parameters[slot], callee)};
    given[slot] = true;
    return slot;
  }

  void store(Value& variable, Value value) {
    const std::size_t size = value.size();
    spend(1 + size / kCostly);
    check_size(size);
    memory = memory + size - variable.size();
    if (memory > limits.memory) throw Fault{"the program's variables take too much memory"};
    variable = std::move(value);
  }
  void check_size(std::size_t size) const {
    if (size > limits.value_size) throw Fault{fmt::format("a value of more than {} elements", limits.value_size)};
  }
  void spend(std::size_t cost) { left -= static_cast<std::int64_t>(cost); }

  void push(Thread& thread, Value value) {
    if (thread.stack.size() >= kStack) throw Fault{"an expression too large"};
    thread.stack.push_back(std::move(value));
  }
  static Value pop(Thread& thread) {
    Value value = std::move(thread.stack.back());
    thread.stack.pop_back();
    return value;
  }
  std::vector<Value> pop_many(Thread& thread, std::size_t count) {
    std::vector<Value> values(std::make_move_iterator(thread.stack.end() - static_cast<std::ptrdiff_t>(count)),
                              std::make_move_iterator(thread.stack.end()));
    thread.stack.resize(thread.stack.size() - count);
    return values;
  }
  void load(Thread& thread, const Value& variable, std::string_view name) {
    if (variable.kind == Value::Kind::None) throw Fault{fmt::format("variable '{}' has no value yet", name)};
    spend(variable.size() / kCostly);
    push(thread, variable);
  }

  static std::size_t element(const Value& list, const Value& index) {
    const double at = internal::number_of(index, "the index");
    if (!list.is_list()) throw Fault{fmt::format("an element of {}", internal::name_of(list.kind))};
    if (!(at >= 0.0 && at < static_cast<double>(list.items.size())) || at != std::floor(at))
      throw Fault{fmt::format("element {} of a list of {}", index.as_text(), list.items.size())};
    return static_cast<std::size_t>(at);
  }

  [[nodiscard]] CallContext context(Host& host) {
    return {host, motion, watchdogs, time, period, !program.is_secondary()};
  }

  void call_builtin(Thread& thread, const Instruction& instruction, Host& host) {
    const internal::CallNames& names = code().calls[static_cast<std::size_t>(instruction.b)];
    const internal::Builtin& callee = internal::builtin(instruction.a);
    const auto parameters = internal::parameters_of(instruction.a);
    CallContext call = context(host);
    std::vector<Value> given_values = pop_many(thread, names.size());
    call.arguments.resize(parameters.size());
    std::vector<bool> given(parameters.size(), false);
    for (std::size_t i = 0; i < given_values.size(); ++i)
      call.arguments[slot_of(parameters, names, i, callee.name, given)] = std::move(given_values[i]);
    for (std::size_t i = 0; i < static_cast<std::size_t>(callee.required); ++i)
      if (!given[i]) throw Fault{fmt::format("{} needs '{}'", callee.name, parameters[i])};
    Value result = callee.call(call);
    if (call.wait) {
      thread.wait = std::move(call.wait);
      return;
    }
    const std::size_t size = result.size();
    check_size(size);
    spend(size / kCostly);
    push(thread, std::move(result));
  }

  /// One instruction. False: the thread waits or is over.
  bool run_one(Thread& thread, Host& host);
  void run_on_values(Thread& thread, const internal::Instruction& instruction, Host& host);
  bool run_flow(Thread& thread, const internal::Instruction& instruction, Host& host);
  void run_threads(Host& host);
  void check_watchdogs(const Host& host);
  void end(MachineState outcome);
  void step(Host& host);

  Program program;
  MachineLimits limits;
  std::vector<Value> globals;
  std::vector<Thread> threads;
  internal::Motion motion;
  std::vector<internal::Watchdog> watchdogs;
  Status status;
  std::size_t memory = 0;
  std::int64_t left = 0;  ///< of what this period may cost
  std::int64_t period = 0;
  double time = 0.0;
  double pace = 1.0;  ///< of a motion, 0: paused
  int next_thread = 0;
  int critical = -1;  ///< the thread that runs alone, until it waits
  bool is_paused = false;
  bool is_braking = false;
};

}  // namespace snug::urscript
