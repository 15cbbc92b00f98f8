// Instructions: those that compute with values, and those that say what comes next.
#include "snug/urscript/internal/machine_impl.hpp"

namespace snug::urscript {

bool Machine::Impl::run_one(Thread& thread, Host& host) {
  const Instruction instruction = at(thread);
  ++thread.frames.back().next;
  spend(1);
  if (instruction.op >= Op::Jump) return run_flow(thread, instruction, host);
  run_on_values(thread, instruction, host);
  return true;
}

void Machine::Impl::run_on_values(Thread& thread, const Instruction& instruction, Host& host) {
  Frame& frame = thread.frames.back();
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
    default:
      break;
  }
}

bool Machine::Impl::run_flow(Thread& thread, const Instruction& instruction, Host& host) {
  Frame& frame = thread.frames.back();
  const auto a = static_cast<std::size_t>(instruction.a);
  switch (instruction.op) {
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
      thread.is_critical = true;
      critical = thread.id;
      break;
    case Op::ExitCritical:
      thread.is_critical = false;
      if (critical == thread.id) critical = -1;
      break;
    case Op::SkipIfGiven:
      if (frame.given[a]) frame.next = instruction.b;
      break;
    case Op::Halt:
      end(MachineState::Halted);
      return false;
    default:
      break;
  }
  return true;
}

}  // namespace snug::urscript
