// Machine: threads of a stack machine that run until they wait, then the motion of one period.
#include "snug/urscript/machine.hpp"

#include <algorithm>
#include <cmath>

#include "snug/urscript/internal/machine_impl.hpp"

namespace snug::urscript {
namespace {

constexpr double kPauseTime = 0.25;  // s, in which a paused program's motion slows down

void ask_for_stop(Host& host, const std::string& why) {
  host.state().wants_protective_stop = true;
  host.state().stop_reason = why;
}

}  // namespace

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
        if (threads[i].is_critical) critical = id;
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
        // Who waits lets the others run, also in a critical section.
        if (threads[i].wait && critical == threads[i].id) critical = -1;
        goes_on = goes_on || threads.size() > count;
      } catch (Fault& fault) {
        if (fault.stops_arm) ask_for_stop(host, fault.text);
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

/// The time of the program counts: it stands while the program is paused.
void Machine::Impl::check_watchdogs(const Host& host) {
  for (internal::Watchdog& dog : watchdogs) {
    const std::uint64_t count = host.input_count(dog.input).value_or(0);
    if (count != dog.count) {
      dog.count = count;
      dog.since = time;
    }
    if (dog.action == internal::Watchdog::Action::Ignore || time - dog.since <= dog.patience + 1e-9) continue;
    dog.since = time;  // a program that goes on has the whole time again
    if (dog.action == internal::Watchdog::Action::Stop)
      end(MachineState::Stopped);
    else
      is_paused = true;
  }
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
    if (status.state == MachineState::Running && !stands) check_watchdogs(host);
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
    if (fault.stops_arm) ask_for_stop(host, fault.text);
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
