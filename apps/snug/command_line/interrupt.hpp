// Interrupt: SIGINT, SIGTERM and SIGHUP end long work in order, with what is done so far; a second one ends it at once.
#pragma once

namespace snug::app {

/// From now on the first signal only sets a flag.
void catch_interrupts();
[[nodiscard]] bool is_interrupted();

}  // namespace snug::app
