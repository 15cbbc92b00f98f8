// Interrupt: SIGINT and SIGTERM end long work in order, with what is done so far; a second one ends it at once.
#include "apps/snug/command_line/interrupt.hpp"

#include <csignal>

namespace snug::app {
namespace {

volatile std::sig_atomic_t interrupted = 0;  // the one thing a signal handler may write

void note_signal(int) { interrupted = 1; }

}  // namespace

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = note_signal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second signal does what it always does
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool is_interrupted() { return interrupted != 0; }

}  // namespace snug::app
