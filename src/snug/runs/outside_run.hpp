// OutsideRun: the cell driven by a controller outside of it, tick by tick, recorded as any other run.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "snug/runs/run.hpp"

namespace snug::runs {

struct OutsideRunOptions {
  OutputFile* record_file = nullptr;  ///< from record::reserve_recording(), or none; taken; not owned
  RunObserver* observer = nullptr;    ///< sees each frame and event; not owned
  std::string version;                ///< for the recording
  std::function<std::string(const RunResult&)> describe;  ///< JSON to keep in the recording, or none
};

class OutsideRun {
 public:
  /// At time 0. The simulation has a robot (checked) and outlives the run. Throws as Recorder.
  OutsideRun(const cell::Simulation& simulation, const OutsideRunOptions& options);
  ~OutsideRun();
  OutsideRun(const OutsideRun&) = delete;
  OutsideRun& operator=(const OutsideRun&) = delete;

  /// As Simulation::advance. After a failure only finish() may follow (checked).
  const cell::CellTick& advance(const cell::OutsideCommand& command);
  /// As Simulation::feed.
  bool feed(int item, int quarter);
  /// As Simulation::bring, turned by this many quarter turns where the sequence leaves that open.
  void bring(int item, int quarter);
  /// As Simulation::stand.
  void stand();
  /// Whether the last tick was the last because the arm stopped for protection.
  [[nodiscard]] bool is_stopped_for_protection() const;
  /// Releases that stop: the run may go on, the arm standing.
  void acknowledge();

  [[nodiscard]] double time() const;
  [[nodiscard]] const cell::CellState& state() const;
  /// Of the last tick; nothing before the first.
  [[nodiscard]] const cell::ArmReading& reading() const;
  /// As Simulation::tool_load.
  [[nodiscard]] Wrench tool_load() const;
  /// Why the last tick was the last; none while the run may go on.
  [[nodiscard]] const cell::Failure& failure() const;
  /// The observer wants the run to stop.
  [[nodiscard]] bool is_stopped() const;

  /// Ends the run and closes the recording. To be called once. Throws OutputError.
  [[nodiscard]] RunResult finish(const std::string& ended_by);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::runs
