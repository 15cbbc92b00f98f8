// WatchedRun: a cell of another program, seen while somebody else drives it: as a run goes on, and as a camera's scene.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "snug/camera/scene.hpp"
#include "snug/remote_plant/watched_cell.hpp"
#include "snug/runs/recorder.hpp"

namespace snug::remote_runs {

/// Observes a cell until told to stop; each run, from time 0 to the next reset, is one of the observer.
class WatchedRun {
 public:
  /// `over`: called at the end of each run that the observer has seen, with why the cell is seen no more, or nothing.
  /// `version`: of this program. Cell and observer outlive this.
  WatchedRun(remote_plant::WatchedCell& cell, runs::RunObserver& observer, std::string version,
             std::function<void(const std::string& why)> over);

  /// From any thread.
  void stop() { is_stopped_ = true; }
  /// Until then. Empty, or why the cell cannot be seen any more.
  [[nodiscard]] std::string run();

 private:
  void begin();
  void show();
  void add();
  void finish(const std::string& why);

  remote_plant::WatchedCell& cell_;
  runs::RunObserver& observer_;
  std::string version_;
  std::function<void(const std::string&)> over_;
  cell::CellWorkspace work_;
  std::optional<runs::Recorder> recorder_;
  double last_ = 0.0;  ///< s, simulated
  std::atomic<bool> is_stopped_ = false;
};

/// What a camera has before it: everything, the robot where its joints say that it is, boxes where and as large as
/// their sensors say. `name`: of the scene, in messages.
[[nodiscard]] camera::Scene watched_scene(const remote_plant::WatchedCell& cell, const std::string& name);
/// The same with the robot out of the view.
[[nodiscard]] camera::Scene scene_without_robot(const remote_plant::WatchedCell& cell);

}  // namespace snug::remote_runs
