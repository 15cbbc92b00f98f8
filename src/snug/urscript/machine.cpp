// Machine: threads of a stack machine that run until they wait, then the motion of one period.
#include "snug/urscript/machine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "snug/urscript/internal/builtins.hpp"
#include "snug/urscript/internal/code.hpp"

namespace snug::urscript {

using internal::CallContext;
using internal::Fault;
using internal::Instruction;
using internal::Op;
using internal::Value;

namespace {

constexpr double kPauseTime = 0.25;   // s, in which a paused program's motion slows down
constexpr std::size_t kStack = 5000;  // values of a thread
constexpr std::size_t kCostly = 16;   // elements that cost as much as an instruction

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
  bool is_done = false;
};

}  // namespace

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

  [[nodiscard]] CallContext context(Host& host) { return {host, motion, time, period, !program.is_secondary()}; }

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
  void run_threads(Host& host);
  void end(MachineState outcome);
  void step(Host& host);

  Program program;
  MachineLimits limits;
  std::vector<Value> globals;
  std::vector<Thread> threads;
  internal::Motion motion;
  Status status;
  std::size_t memory = 0;
  std::int64_t left = 0;  ///< of what this period may cost
  std::int64_t period = 0;
  double time = 0.0;
  double pace = 1.0;  ///< of a motion, 0: paused
  int next_thread = 0;
  int critical = -1;  ///< the thread that runs alone
  bool is_paused = false;
  bool is_braking = false;
};

bool Machine::Impl::run_one(Thread& thread, Host& host) {
  const Instruction instruction = at(thread);
  Frame& frame = thread.frames.back();
  ++frame.next;
  spend(1);
  const auto a = static_cast<std::size_t>(instruction.a);
  switch (instruction.op) {
    case Op::Constant:
      push(thread, code().constants[a]);
      break;
    case Op::LoadGlobal:
      load(thread, globals[a], code().globals[a]);
      break;
    case Op::StoreGlobal:
      store(globals[a], pop(thread));
      break;
    case Op::LoadLocal:
      load(thread, frame.locals[a], "of this function");
      break;
    case Op::StoreLocal:
      store(frame.locals[a], pop(thread));
      break;
    case Op::StoreElement: {
      Value value = pop(thread);
      const Value index = pop(thread);
      Value& list = instruction.b == 1 ? frame.locals[a] : globals[a];
      Value& place = list.items[element(list, index)];
      store(place, std::move(value));
      check_size(list.size());
      break;
    }
    case Op::StoreOutput: {
      CallContext call = context(host);
      call.arguments.resize(2);
      call.arguments[1] = pop(thread);
      call.arguments[0] = pop(thread);
      (void)internal::builtin(internal::find_builtin("set_standard_digital_out")).call(call);
      break;
    }
    case Op::MakeList:
    case Op::MakePose: {
      Value list = Value::of(pop_many(thread, instruction.op == Op::MakePose ? 6 : a));
      check_size(list.size());
      if (instruction.op == Op::MakePose) {
        (void)internal::six_of(list, "a pose");
        list.kind = Value::Kind::Pose;
      }
      push(thread, std::move(list));
      break;
    }
    case Op::Index: {
      const Value index = pop(thread);
      const Value list = pop(thread);
      push(thread, list.items[element(list, index)]);
      break;
    }
    case Op::Binary: {
      const Value y = pop(thread), x = pop(thread);
      spend((x.size() + y.size()) / kCostly);
      push(thread, internal::apply(static_cast<internal::Operator>(a), x, y));
      break;
    }
    case Op::Unary:
      push(thread, internal::apply(static_cast<internal::Operator>(a), pop(thread)));
      break;
    case Op::Jump:
      frame.next = instruction.a;
      break;
    case Op::JumpIfFalse:
      if (internal::number_of(pop(thread), "a condition") == 0.0) frame.next = instruction.a;
      break;
    case Op::AndOrSkip: {
      const bool is_true = internal::number_of(thread.stack.back(), "a condition") != 0.0;
      if (is_true == (instruction.b == 1)) {
        thread.stack.back() = Value::of(is_true);
        frame.next = instruction.a;
      } else {
        thread.stack.pop_back();
      }
      break;
    }
    case Op::Call:
    case Op::Run: {
      const internal::CallNames& names = code().calls[static_cast<std::size_t>(instruction.b)];
      std::vector<Value> arguments = pop_many(thread, names.size());
      if (instruction.op == Op::Call) {
        enter(thread, instruction.a, std::move(arguments), names);
        break;
      }
      push(thread, Value::thread(next_thread));
      (void)start(instruction.a, std::move(arguments), names);  // moves the threads in memory
      return true;
    }
    case Op::CallBuiltin:
      call_builtin(thread, instruction, host);
      return !thread.wait;
    case Op::Return: {
      Value result = pop(thread);
      for (const Value& local : frame.locals) memory = memory - local.size() + 1;
      thread.frames.pop_back();
      if (thread.frames.empty()) {
        thread.is_done = true;
        return false;
      }
      push(thread, std::move(result));
      break;
    }
    case Op::Pop:
      thread.stack.pop_back();
      break;
    case Op::Join: {
      const Value handle = pop(thread);
      if (handle.kind != Value::Kind::Thread) break;  // as on a controller: 0 stands for no thread
      thread.wait = [this, id = static_cast<int>(handle.number)](CallContext&, Value&) {
        return std::none_of(threads.begin(), threads.end(),
                            [&](const Thread& one) { return one.id == id && !one.is_done; });
      };
      return false;
    }
    case Op::Kill: {
      const Value handle = pop(thread);
      if (handle.kind != Value::Kind::Thread) break;
      for (Thread& one : threads)
        if (one.id == static_cast<int>(handle.number)) one.is_done = true;
      return !thread.is_done;
    }
    case Op::EnterCritical:
      critical = thread.id;
      break;
    case Op::ExitCritical:
      critical = -1;
      break;
    case Op::SkipIfGiven:
      if (frame.given[a]) frame.next = instruction.b;
      break;
    case Op::Halt:
      end(MachineState::Halted);
      return false;
  }
  return true;
}

void Machine::Impl::run_threads(Host& host) {
  left = static_cast<std::int64_t>(limits.instructions_per_step);
  const auto may_run = [&](const Thread& thread) { return !thread.is_done && (critical < 0 || critical == thread.id); };
  // Threads that others begin, and those that have begun one, go on in the same period.
  std::vector<int> has_waited;
  for (bool goes_on = true; goes_on && left > 0 && status.state == MachineState::Running;) {
    goes_on = false;
    for (std::size_t i = 0; i < threads.size() && left > 0 && status.state == MachineState::Running; ++i) {
      if (!may_run(threads[i])) continue;
      const int id = threads[i].id;
      if (threads[i].wait) {
        if (std::find(has_waited.begin(), has_waited.end(), id) != has_waited.end()) continue;
        CallContext call = context(host);
        Value result;
        const auto wait = threads[i].wait;
        if (!wait(call, result)) {
          has_waited.push_back(id);
          continue;
        }
        const std::size_t before = static_cast<std::size_t>(threads[i].frames.back().next) - 1;
        threads[i].wait = nullptr;
        if (code().instructions[before].op == Op::CallBuiltin) push(threads[i], std::move(result));
      }
      status.line = at(threads[i]).line;
      const Instruction* where = nullptr;
      try {
        // A thread that is begun moves the others in memory: this one is found again.
        const std::size_t count = threads.size();
        for (bool runs = true; runs && left > 0;) {
          where = &at(threads[i]);
          runs = run_one(threads[i], host);
        }
        goes_on = goes_on || threads.size() > count;
      } catch (Fault& fault) {
        status.error = {where->line, where->column, std::move(fault.text)};
        status.line = where->line;
        end(MachineState::Failed);
      }
      if (status.state == MachineState::Running && !threads.empty() && threads.front().is_done) {
        end(MachineState::Ended);
      }
    }
  }
  if (critical >= 0 && std::none_of(threads.begin(), threads.end(),
                                    [&](const Thread& one) { return one.id == critical && !one.is_done; }))
    critical = -1;
  // The first is the program itself; it stays first.
  std::erase_if(threads, [](const Thread& thread) { return thread.is_done && thread.id != 0; });
}

void Machine::Impl::end(MachineState outcome) {
  if (status.state != MachineState::Running) return;
  status.outcome = outcome;
  status.state = MachineState::Braking;
}

void Machine::Impl::step(Host& host) {
  if (!status.is_active()) return;
  ControllerState& state = host.state();
  const bool stands = is_paused || state.is_protectively_stopped;
  const double dt = host.period();
  if (!stands) {
    ++period;
    time += dt;
  }
  if (state.is_protectively_stopped) {
    pace = 0.0;
    if (status.state == MachineState::Braking) {
      motion.stop(host);
      status.state = status.outcome;
    }
    return;
  }
  pace = std::clamp(pace + (is_paused ? -dt : dt) / kPauseTime, 0.0, 1.0);
  try {
    if (status.state == MachineState::Running && !stands) run_threads(host);
    if (program.is_secondary()) {
      if (status.state == MachineState::Braking) status.state = status.outcome;
      return;
    }
    if (status.state == MachineState::Braking && !is_braking) {
      is_braking = true;
      threads.clear();
      motion.end_force(host);
      motion.brake(host);
      pace = 1.0;
    }
    motion.step(host, is_braking ? 1.0 : pace * std::clamp(state.speed_fraction, 0.0, 1.0));
  } catch (Fault& fault) {
    if (status.error.text.empty()) status.error = {status.line, 0, std::move(fault.text)};
    status.outcome = MachineState::Failed;
    status.state = MachineState::Failed;
    motion.stop(host);
    return;
  }
  if (is_braking && motion.is_still()) status.state = status.outcome;
}

Machine::Machine(Program program, const MachineLimits& limits)
    : impl_(std::make_unique<Impl>(std::move(program), limits)) {}
Machine::Machine(Machine&&) noexcept = default;
Machine& Machine::operator=(Machine&&) noexcept = default;
Machine::~Machine() = default;

void Machine::step(Host& host) { impl_->step(host); }
const Status& Machine::status() const { return impl_->status; }
void Machine::stop() { impl_->end(MachineState::Stopped); }
void Machine::pause() { impl_->is_paused = true; }
void Machine::resume() { impl_->is_paused = false; }
bool Machine::is_paused() const { return impl_->is_paused; }
const Program& Machine::program() const { return impl_->program; }

}  // namespace snug::urscript
