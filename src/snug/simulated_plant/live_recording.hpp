// LiveRecording: the recording of a simulated plant, written while it is packed: the file grows tick by tick.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "snug/motion/waypoint.hpp"
#include "snug/runs/recorder.hpp"
#include "snug/runs/result.hpp"

namespace snug::simulated_plant {

class SimulatedPlant;

struct LiveRecordingOptions {
  OutputFile* file = nullptr;             ///< taken; not owned
  std::string version;                    ///< for the recording
  runs::RunObserver* observer = nullptr;  ///< sees the same frames and events; not owned; the run does not end for it
  std::string settings_json = "{}";
};

/// How whoever packed came to an end, for the recording.
struct RecordingEnd {
  std::vector<std::string> warnings;
  std::string ended_by;                                         ///< why, for people
  bool is_interrupted = false;                                  ///< early, by who watched
  std::function<std::string(const runs::RunResult&)> describe;  ///< JSON to keep in the recording, or none
};

/// Everything up to a second before is in the file at any time (record::RecordingWriter): a process that is killed
/// leaves a recording that opens, and says that it is not complete.
class LiveRecording {
 public:
  /// Begins the file; the plant hands on each tick from now on. `scenario`: by whose boxes the filling degree counts,
  /// as whoever packs knows them; like the plant it must outlive the recording. Throws InputError for a file that
  /// cannot be written; every call OutputError when writing fails.
  LiveRecording(SimulatedPlant& plant, const model::Scenario& scenario, const LiveRecordingOptions& options);
  ~LiveRecording();
  LiveRecording(const LiveRecording&) = delete;
  LiveRecording& operator=(const LiveRecording&) = delete;

  /// What who packs has to say, when it happens.
  void note(record::Event event);
  /// The rest, and the result.
  runs::RunResult close(const RecordingEnd& end);

  /// By the plant: a motion begins; after each tick.
  void begin_motion(const std::vector<motion::Waypoint>& waypoints);
  void add_tick();

 private:
  void add_events();

  SimulatedPlant& plant_;
  const model::Scenario& scenario_;
  runs::Recorder recorder_;
  std::vector<record::Event> events_;
  std::size_t own_ = 0;      ///< events of the plant that are among them
  int waypoint_count_ = 0;   ///< of all motions before
  int next_count_ = 0;       ///< with that under way
  bool is_written_ = false;  ///< the motion under way is in the program
};

}  // namespace snug::simulated_plant
