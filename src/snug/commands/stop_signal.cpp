// Ctrl-C ends long work in order: as a flag that is asked, or as a call from a thread of its own.
#include "snug/commands/stop_signal.hpp"

#include <semaphore.h>
#include <signal.h>

#include <csignal>
#include <utility>

namespace snug::commands {
namespace {

sem_t g_stop;  ///< posted by the handler: one of the few things that a handler may do

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP};

bool is_ignored(int signal) {
  struct sigaction before {};
  return ::sigaction(signal, nullptr, &before) == 0 && before.sa_handler == SIG_IGN;
}

volatile std::sig_atomic_t g_is_interrupted = 0;  // the one thing that a handler may write

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_is_interrupted = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second signal does what it always does
  for (const int signal : kSignals) {
    if (signal == SIGHUP && is_ignored(signal)) continue;  // nohup stays what it is
    ::sigaction(signal, &action, nullptr);
  }
}

bool is_interrupted() { return g_is_interrupted != 0; }

StopSignal::StopSignal(std::function<void()> stop) {
  ::sem_init(&g_stop, 0, 0);
  struct sigaction action {};
  action.sa_handler = [](int) { ::sem_post(&g_stop); };
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  for (const int signal : kSignals) {
    if (signal == SIGHUP && is_ignored(signal)) continue;  // nohup stays what it is
    ::sigaction(signal, &action, nullptr);
  }
  thread_ = std::thread([stop = std::move(stop)] {
    while (::sem_wait(&g_stop) != 0) continue;  // another signal woke it up
    stop();
  });
}

StopSignal::~StopSignal() {
  for (const int signal : kSignals) {
    if (!is_ignored(signal)) ::signal(signal, SIG_DFL);
  }
  ::sem_post(&g_stop);  // harmless when the thread has ended
  thread_.join();
  ::sem_destroy(&g_stop);
}

}  // namespace snug::commands
