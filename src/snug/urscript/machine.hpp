// Machine: runs one URScript program on a host, a step for each period of the controller.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "snug/urscript/host.hpp"
#include "snug/urscript/program.hpp"

namespace snug::urscript {

/// What a program may use. Beyond it the program ends with an error; the arm comes to rest.
struct MachineLimits {
  std::uint64_t instructions_per_step = 200'000;  ///< of all threads: a loop without sync() or sleep()
  std::size_t call_depth = 200;                   ///< of each thread
  std::size_t threads = 64;
  std::size_t value_size = 100'000;  ///< elements of a list with those of lists in it; bytes of a string
  std::size_t memory = 4'000'000;    ///< the same, of all variables together
};

enum class MachineState {
  Running,
  Braking,  ///< the program is over, the arm is not at rest yet
  Ended,    ///< came to its end
  Halted,   ///< by `halt`
  Stopped,  ///< by stop()
  Failed,   ///< see Status::error
};

struct Status {
  MachineState state = MachineState::Running;
  MachineState outcome = MachineState::Running;  ///< while braking: what comes then
  ScriptError error;                             ///< Failed
  int line = 0;                                  ///< that the program stands at
  [[nodiscard]] bool is_active() const { return state == MachineState::Running || state == MachineState::Braking; }
};

/// One run of a program. The same program, host and inputs give the same targets, bit by bit.
class Machine {
 public:
  /// The first target is where the host's target stands; its speed is taken for what the arm moves with.
  explicit Machine(Program program, const MachineLimits& limits = {});
  Machine(Machine&&) noexcept;
  Machine& operator=(Machine&&) noexcept;
  ~Machine();

  /// One period: every thread runs until it waits, then the motion goes on. Writes `host.state().target` (not by a
  /// secondary program) and all else that the program sets. To be called while `status().is_active()`; later it does
  /// nothing.
  void step(Host& host);
  [[nodiscard]] const Status& status() const;
  /// Ends the program; the arm brakes in the steps that follow.
  void stop();
  /// A paused program's arm brakes on its path, and its time stands, until resume().
  void pause();
  void resume();
  [[nodiscard]] bool is_paused() const;
  [[nodiscard]] const Program& program() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::urscript
