// LiveSimulation: a run in a thread of its own, for those who watch it; and runs one after the other, shown while
// somebody can.
#pragma once

#include <exception>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "snug/runs/run.hpp"
#include "snug/serve/live_run.hpp"

namespace snug::serve {

/// The result without how long it took: a run that is watched waits for its watchers.
[[nodiscard]] std::string describe_watched(const runs::RunResult& result);

/// What the run throws is thrown again by result().
class LiveSimulation {
 public:
  /// `options`: but for observer and describe, which are the live run's.
  LiveSimulation(model::Scenario scenario, runs::RunOptions options, LiveRun& live);
  ~LiveSimulation() { join(); }
  LiveSimulation(const LiveSimulation&) = delete;
  LiveSimulation& operator=(const LiveSimulation&) = delete;

  void start(std::function<void()> on_trouble);
  /// Stops the run, if it still goes on, and waits for its end.
  [[nodiscard]] const runs::RunResult& result();

 private:
  void join();

  LiveRun& live_;
  model::Scenario scenario_;
  runs::RunOptions options_;
  std::optional<runs::RunResult> result_;
  std::exception_ptr trouble_;
  std::thread thread_;
};

/// Shows one run after the other; lets them go on when there is nobody, or no room, to show them any more.
class ShownRun : public runs::RunObserver {
 public:
  explicit ShownRun(LiveRun& live) : live_(live) {}
  void begin(const record::RecordingHeader& header) override {
    is_shown_ = true;
    live_.begin(header);
  }
  bool add(const record::Frame& frame) override {
    is_shown_ = is_shown_ && live_.add(frame);
    return true;
  }
  void add(const record::Event& event) override {
    if (is_shown_) live_.add(event);
  }

 private:
  LiveRun& live_;
  bool is_shown_ = true;
};

/// In the browser of this desk; nothing without a screen.
void open_browser(const std::string& address);

}  // namespace snug::serve
