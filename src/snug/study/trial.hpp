// Trial: a session and the plant it packs, put together, and scored by what is true of the plant.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "snug/session/session.hpp"
#include "snug/simulated_plant/live_recording.hpp"
#include "snug/simulated_plant/simulated_plant.hpp"

namespace snug::study {

/// One item by the plant's truth, when its motions had ended.
struct TrueItem {
  std::string id;
  bool was_sent = false;
  bool is_as_planned = false;   ///< within the session's limits of its last plan, in the container, nothing else lost
  double position_error = 0.0;  ///< m, level
  double angle_error = 0.0;     ///< rad
  simulated_plant::MotionTruth motion;  ///< means nothing of a plant elsewhere
  double displacement = 0.0;            ///< m, the farthest that another box was moved
  std::vector<bool> succeeded;          ///< of each motion that was sent: ended as planned and needed no remedy
};

struct Trial {
  session::SessionResult session;
  std::uint64_t seed = 0;  ///< of the session
  std::uint64_t plant_seed = 0;
  bool is_elsewhere = false;  ///< the plant is another program's: its seed and state are not known here
  int executed_boxes = 0;     ///< counted_boxes(), by the plant's truth
  double executed_percent = 0.0;
  int items_sent = 0;
  int items_as_planned = 0;
  int boxes_lost = 0;  ///< that were picked and are not in the container in the end
  int recoveries = 0;
  double boxes_per_hour = 0.0;  ///< packed, by the plant's clock: robot and vacuum, neither planning nor looks
  /// The same with the time in which the robot stood and waited for a plan, as long as that took on this machine.
  double boxes_per_hour_with_planning = 0.0;
  double unturned_cycle = 0.0;  ///< s, mean of the items that were placed at once without turning them; 0: none
  std::vector<TrueItem> items;
  std::vector<cell::BoxResult> boxes;
  std::vector<simulated_plant::ForeignObject> objects;  ///< that faults put into the plant
  std::uint64_t state_hash = 0;
  simulated_plant::SimulatedPlantOptions plant;
};

/// Names of the boxes that are packed and that the check of the finished load did not reject.
[[nodiscard]] std::vector<std::string> counted_boxes(const std::vector<cell::BoxResult>& boxes,
                                                     const session::SessionResult& session);

/// Called after every item; the session and plant so far.
using TrialProgress = std::function<void(const Trial& so_far, int item, int items)>;

/// What is written while the plant is packed; where nothing was sent no file is made.
struct TrialFiles {
  std::optional<simulated_plant::LiveRecordingOptions> recording;
  std::function<std::string(const runs::RunResult&)> describe;  ///< RecordingEnd::describe
  OutputFile* program = nullptr;                                ///< plant::SentProgram; not owned
};

/// Throws InputError as session::pack and SimulatedPlant do.
[[nodiscard]] Trial run_trial(const model::Scenario& scenario, const std::string& sequence,
                              const session::SessionOptions& session,
                              const simulated_plant::SimulatedPlantOptions& plant, const TrialProgress& progress = {},
                              const TrialFiles& files = {});

/// What the recording of a plant says of how it was made. `address`: of a plant that is elsewhere; `version`: of the
/// program; `file` is taken.
[[nodiscard]] simulated_plant::LiveRecordingOptions recording_of(const simulated_plant::SimulatedPlantOptions& plant,
                                                                 const std::string& agent, const std::string& version,
                                                                 OutputFile& file, const std::string& address = {});
/// The plant as the session before left it.
[[nodiscard]] simulated_plant::TakenUp take_up(const session::ResumePoint& point);

/// What the session did, as events of a recording: what it predicted, troubles and remedies, obstacles.
[[nodiscard]] std::vector<record::Event> events_of(const session::SessionResult& result);
/// What went wrong in the end, for whoever looks at its recording: boxes that were sent and are not packed, each with
/// its reason, and why the robot did not come home.
[[nodiscard]] std::vector<std::string> warnings_of(const session::SessionResult& result);

}  // namespace snug::study
