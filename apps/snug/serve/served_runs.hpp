// ServedRuns: the cell that is served, and what becomes of each run of it: recording, page, printed result.
#pragma once

#include <atomic>
#include <optional>
#include <thread>

#include "apps/snug/serve/serve.hpp"
#include "snug/runs/outside_run.hpp"

namespace snug::app {

class ServedRuns {
 public:
  /// `tick`: s, of the controller, instead of the scenario's; a multiple of the time step.
  explicit ServedRuns(const ServeOptions& options, std::optional<double> tick = {});
  ~ServedRuns();
  ServedRuns(const ServedRuns&) = delete;
  ServedRuns& operator=(const ServedRuns&) = delete;

  [[nodiscard]] const cell::Simulation& simulation() const { return simulation_; }
  /// Serves the page, if there is one, until end_page().
  void begin_page();
  void end_page();
  /// The run may be paused: it goes on, to its end.
  void release();

  [[nodiscard]] runs::OutsideRunOptions begin(int run);
  /// Prints it.
  void end(int run, const runs::RunResult& result);
  [[nodiscard]] bool has_failed() const { return has_failed_; }

 private:
  const ServeOptions& options_;
  model::Scenario scenario_;
  cell::Simulation simulation_;
  std::optional<OutputFile> record_;
  std::optional<serve::LiveRun> live_;
  std::unique_ptr<runs::RunObserver> shown_;
  std::optional<serve::Server> page_;
  std::thread page_thread_;
  bool has_failed_ = false;
};

/// How late the steps of a cell in real time were, on stderr; nothing where there were none.
void print_lateness(const served_cell::Pacer& pacer);

}  // namespace snug::app
