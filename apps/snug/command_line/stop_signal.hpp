// StopSignal: Ctrl-C as a call from a thread of its own, so that what goes on ends in order.
#pragma once

#include <functional>
#include <thread>

namespace snug::app {

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

}  // namespace snug::app
