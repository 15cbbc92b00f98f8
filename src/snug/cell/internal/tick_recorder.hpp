// TickRecorder: the ticks of a cell under way as frames and events of a recording; what the cell came to, at the end.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "snug/cell/run.hpp"

namespace snug::cell::internal {

class TickRecorder {
 public:
  /// Period, sequence and joints of `setup` are filled in. Nothing is recorded where it names neither file nor
  /// observer. Throws as Recorder.
  TickRecorder(const Simulation& simulation, RecorderSetup setup);
  /// False: the observer wants the run to stop.
  [[nodiscard]] bool add(const CellTick& tick, const CellState& state, const CellWorkspace& work);
  void close(const CellState& state, const std::string& result_json, bool is_interrupted);

 private:
  const Simulation& simulation_;
  std::optional<Recorder> recorder_;
  std::int64_t ticks_a_frame_ = 1;
  std::int64_t ticks_ = 0;
};

/// Cup, controller, corrections and robot, for a recording.
[[nodiscard]] std::string settings_json(const SimulationOptions& options, const std::string& corrections);
/// All that the state tells: boxes, contacts, events, hash.
void fill_result(const Simulation& simulation, const CellState& state, const CellWorkspace& work, RunResult& result);

}  // namespace snug::cell::internal
