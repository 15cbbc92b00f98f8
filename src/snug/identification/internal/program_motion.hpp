// capture_program: the run of a program, in memory.
#pragma once

#include <optional>
#include <string>

#include "snug/identification/recorded_motion.hpp"
#include "snug/model/scenario.hpp"
#include "snug/model/scene_task.hpp"
#include "snug/record/archive.hpp"
#include "snug/record/recording.hpp"

namespace snug::identification::internal {

struct CapturedRun {
  record::Recording recording;
  std::string failure;  ///< empty, or why it stopped early
};
[[nodiscard]] CapturedRun capture_program(const model::Scenario& scenario, const model::TaskProgram& program,
                                          std::optional<double> until);

/// What an archive recorded of the task's bodies, on the clock of the simulation of the task's scenario: one motion for each
/// recording of a sequence. Throws InputError for a tracked body that was not recorded, and where no clock is found.
[[nodiscard]] std::vector<RecordedMotion> motions_of_archive(const model::SceneTask& task,
                                                             const record::Recording& simulated,
                                                             const std::vector<record::ArchiveRecording>& recordings,
                                                             const std::string& where);

}  // namespace snug::identification::internal
