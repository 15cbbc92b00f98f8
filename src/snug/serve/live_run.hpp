// LiveRun: stands between a simulation and those who watch it: paces it, pauses it, and keeps what they are to be told.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "snug/replay/frame_coder.hpp"
#include "snug/runs/recorder.hpp"

namespace snug::serve {

/// Everything that a watcher may be sent takes at most this; a run that goes on is then stopped.
inline constexpr std::size_t kMaxLogBytes = std::size_t{256} << 20U;

/// The simulation calls begin, add and finish from one thread; all else may be called from any other.
///
/// Watchers read a log of server-sent events from its beginning, so it does not matter when they come. A begin() after
/// a finish() is another run: it takes the place of the one before.
class LiveRun : public runs::RunObserver {
 public:
  /// `speed`: simulated seconds per second, 0 for as fast as it goes. The result of the run does not depend on it.
  LiveRun(std::string name, double speed);

  void begin(const record::RecordingHeader& header) override;
  bool add(const record::Frame& frame) override;
  void add(const record::Event& event) override;
  /// The run is over. `result_json` as snug simulate --json prints it, or empty; `is_interrupted`: it ended early, as
  /// it was told to.
  void finish(const std::string& result_json, const std::string& failure, bool is_interrupted = false);

  void pause();
  void resume();
  /// One frame more, when paused.
  void step();
  /// The run ends at its next frame.
  void stop();

  /// Text of entry `index` of the log, waiting for it until `patience` has passed; nullptr when it is not there by
  /// then.
  [[nodiscard]] std::shared_ptr<const std::string> wait_for(std::size_t index, std::chrono::milliseconds patience);
  /// How far a watcher has read, and of which run.
  struct Place {
    int run = 0;  ///< from 1; 0: none yet
    std::size_t index = 0;
  };
  /// The entry at `place`, which moves on; nullptr when it is not there within the patience. The end of the run that
  /// was watched comes next when another one has begun meanwhile.
  [[nodiscard]] std::shared_ptr<const std::string> next(Place& place, std::chrono::milliseconds patience);
  [[nodiscard]] bool is_paused() const;
  [[nodiscard]] bool is_over() const;
  /// The whole run in the replay form, once it is over; empty before.
  [[nodiscard]] std::shared_ptr<const std::string> whole_form() const;

 private:
  using Clock = std::chrono::steady_clock;

  void log(const char* event, const std::string& data);
  void log_state();
  void flush();
  void forget();
  /// Sleeps until it is time for the next frame, and while paused. False: the run is to stop.
  bool wait_for_turn(std::unique_lock<std::mutex>& lock);

  const std::string name_;
  const double speed_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  record::RecordingHeader header_;
  std::optional<replay::FrameCoder> whole_, batch_;
  std::vector<record::Event> events_, batch_events_;
  std::vector<std::shared_ptr<const std::string>> log_;
  std::size_t log_bytes_ = 0;
  std::shared_ptr<const std::string> last_end_;  ///< entry that ended the run before
  int run_ = 1;
  std::shared_ptr<const std::string> whole_form_;
  Clock::time_point origin_{};      ///< when time 0 would have been shown
  Clock::time_point last_flush_{};  ///< of the batch
  double time_ = 0.0;               ///< s, of the newest frame
  int steps_ = 0;                   ///< frames that may pass although paused
  bool is_paused_ = false, is_stopped_ = false, is_over_ = false;
};

}  // namespace snug::serve
