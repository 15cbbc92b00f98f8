// RecordedMotion: where bodies were, as a recording of an experiment tells it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "snug/identification/recorded_drive.hpp"
#include "snug/model/scene_task.hpp"
#include "snug/record/archive.hpp"
#include "snug/record/recording.hpp"

namespace snug::identification {

/// One body of a recording. All in W.
struct RecordedBody {
  std::string body;
  std::vector<record::PoseSample> poses;     ///< X_WB at each time; not a number where it was not seen
  std::vector<Twist> twists;                 ///< as long, or empty: not recorded
  std::optional<record::PoseSample> result;  ///< where it came to rest, when the recording says so
  std::vector<int> averaged = {};            ///< samples that each pose is the mean of; empty: one each
  int rejected = 0;                          ///< samples that jumped away from their neighbours, and count as lost
  bool operator==(const RecordedBody&) const = default;
};

struct RecordedMotion {
  std::string name;                     ///< "train.csv, toss 12"
  std::vector<double> times;            ///< s, growing
  double period = 0.0;                  ///< s, between the samples that poses are means of
  double world_position_error = 0.0;    ///< m, standard error of each axis of where the recorded world is
  double world_rotation_error = 0.0;    ///< rad, the same
  std::vector<RecordedBody> tracked;    ///< in the order of the task
  std::vector<RecordedBody> kinematic;  ///< in the order of the task
  /// Of a program's run: what leads the tool instead of the program; none: the program does.
  std::optional<RecordedDrive> drive = {};
  bool operator==(const RecordedMotion&) const = default;
};

/// Samples that the pose at a time of the motion is the mean of.
[[nodiscard]] inline int averaged_at(const RecordedBody& body, std::size_t k) {
  return body.averaged.empty() ? 1 : body.averaged[k];
}

/// Reads the recordings of a task: tables (CSV) with its columns, one recording for each number in its recording
/// column; of a program's run also archives (HDF5), whose clocks are found by simulating the scenario. Throws
/// InputError with file, line and column for what is missing, no rotation, or out of order in time.
[[nodiscard]] std::vector<RecordedMotion> load_motions(const model::SceneTask& task,
                                                       const std::vector<std::filesystem::path>& files);
[[nodiscard]] std::vector<RecordedMotion> parse_motions(const model::SceneTask& task, const std::string& text,
                                                        const std::string& name);

inline constexpr double kSameTool =
    1e-3;  ///< m: a controller, or only its lag, that is not the recorded one's is cm off

/// What an archive recorded of the task's bodies, on the clock of the simulation of the task's scenario: one motion for
/// each recording of a sequence, as means over about a sixtieth of a second, or half a second where the body rests.
/// With TaskMotion::Recorded, and with Auto where the tool of `simulated` is further than kSameTool from the recorded
/// one (root mean square), the recording leads the tool, and its robot's clock is that of the simulation. A program
/// that says when its rows begin (Waypoint::not_before) leads, too, where that distance is kept within a tenth of a
/// second; the robot's clock is then found on the way to the first pick.
/// Throws InputError for a tracked body that was not recorded, and where no clock is found.
[[nodiscard]] std::vector<RecordedMotion> motions_of_archive(const model::SceneTask& task,
                                                             const record::Recording& simulated,
                                                             const std::vector<record::ArchiveRecording>& recordings,
                                                             const std::string& where);

}  // namespace snug::identification
