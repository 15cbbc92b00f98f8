// Interrupt: SIGINT, SIGTERM and SIGHUP end long work in order, with what is done so far; a second one ends it at once.
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
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before = {};
    const bool is_ignored = sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
    if (signal != SIGHUP || !is_ignored) sigaction(signal, &action, nullptr);  // nohup stays what it is
  }
}

bool is_interrupted() { return interrupted != 0; }

}  // namespace snug::app
