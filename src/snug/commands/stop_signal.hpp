// Ctrl-C ends long work in order: as a flag that is asked, or as a call from a thread of its own.
#pragma once

#include <functional>
#include <thread>

namespace snug::commands {

/// From now on the first SIGINT, SIGTERM or SIGHUP only sets a flag: work ends in order, with what is done so far. The
/// second one ends the program at once.
void catch_interrupts();
[[nodiscard]] bool is_interrupted();

/// Waits for SIGINT, SIGTERM or SIGHUP in a thread of its own, so that stopping may lock and wait like any other code.
/// A handler, as libraries have threads of their own that a blocked signal would be given to. The second Ctrl-C ends
/// the program at once. One at a time.
class StopSignal {
 public:
  explicit StopSignal(std::function<void()> stop);
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

 private:
  std::thread thread_;
};

}  // namespace snug::commands
