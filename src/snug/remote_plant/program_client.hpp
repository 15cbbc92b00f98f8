// ProgramClient: snug's own joint controller as a client of CLICK: a program through the joints of any simulator.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "snug/cell/simulation.hpp"
#include "snug/click/client.hpp"

namespace snug::remote_plant {

struct ProgramClientSettings {
  std::string object = {};  ///< of the simulator; empty: the one that has all joints of the arm
  std::string vacuum_event = "vacuum";
  std::string blow_off_event = "blow_off";  ///< used if there is one
  /// Brings the boxes of this sequence, where the simulator lets it; none: they come by themselves.
  const model::Sequence* sequence = nullptr;
  /// s of the clock that the simulator's time may stand still while Controls are answered; then it is a failure.
  double patience = 10.0;
};

struct ProgramClientResult {
  std::string failure;     ///< empty: the program was done
  bool has_begun = false;  ///< there was a simulator of such joints and steps
  double duration = 0.0;   ///< s, simulated, until the last waypoint was reached
  double simulated = 0.0;  ///< s, with the second in which boxes come to rest
  double wall = 0.0;       ///< s
  std::int64_t ticks = 0;
  int row = -1;        ///< of the program, aimed at last
  click::Sensor last;  ///< what the simulator sensed last
};

/// Connects, does the program from where the joints are, waits until boxes have come to rest, resets. `arm`: with its
/// limits and gains, as the scenario has it. What the simulator says or lacks is a failure, never an exception.
[[nodiscard]] ProgramClientResult run_program(click::Client& client, const model::Scenario& scenario,
                                              const cell::CellArm& arm, const motion::PreparedProgram& plan,
                                              const ProgramClientSettings& settings);

}  // namespace snug::remote_plant
