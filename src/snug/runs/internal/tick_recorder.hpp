// TickRecorder: the ticks of a cell under way as frames and events of a recording; what the cell came to, at the end.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "snug/runs/run.hpp"

namespace snug::runs::internal {

class TickRecorder {
 public:
  /// Period, sequence and joints of `setup` are filled in. Nothing is recorded where it names neither file nor
  /// observer. Throws as Recorder.
  TickRecorder(const cell::Simulation& simulation, RecorderSetup setup);
  /// False: the observer wants the run to stop.
  [[nodiscard]] bool add(const cell::CellTick& tick, const cell::CellState& state, const cell::CellWorkspace& work);
  void close(const cell::CellState& state, const std::string& result_json, bool is_interrupted);

 private:
  const cell::Simulation& simulation_;
  std::optional<Recorder> recorder_;
  std::int64_t ticks_a_frame_ = 1;
  std::int64_t ticks_ = 0;
};

/// Cup, controller, corrections and robot, for a recording.
[[nodiscard]] std::string settings_json(const cell::SimulationOptions& options, const std::string& corrections);
/// All that the state tells: boxes, contacts, events, hash.
void fill_result(const cell::Simulation& simulation, const cell::CellState& state, const cell::CellWorkspace& work,
                 RunResult& result);

}  // namespace snug::runs::internal
