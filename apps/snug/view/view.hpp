// view: the page of the report, served on this machine: for recordings, or for a simulation that goes on.
#pragma once

#include <string>
#include <vector>

#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "apps/snug/simulate/simulate.hpp"
#include "snug/replay/replay.hpp"
#include "snug/serve/server.hpp"

namespace snug::app {

struct ViewOptions {
  std::vector<std::string> recordings;  ///< one, or one and a second to lay over it; none with a run
  SimulateOptions run;                  ///< shown while it goes on, if it has a scenario
  std::optional<std::string> click;     ///< address at which the live run is served: it is looked at, not simulated
  ClientWords client;
  double speed = 1.0;      ///< of the run, simulated seconds a second; 0: as fast as it goes
  bool is_paused = false;  ///< before its first step
  bool is_quiet = false;   ///< opens no browser
  serve::ServerSettings server;
  replay::Selection selection;
  std::optional<std::string> urdf;  ///< of the robot in a recording; absent: looked for
};

/// Says on stderr where the page is, and opens it.
void announce(const std::string& address, bool opens_browser);

}  // namespace snug::app
