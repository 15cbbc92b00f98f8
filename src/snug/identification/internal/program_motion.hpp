// capture_program: the run of a program, in memory; ProgramRun: what recordings of it are compared with.
#pragma once

#include <optional>
#include <string>

#include "snug/identification/internal/scene_motion.hpp"
#include "snug/model/scenario.hpp"
#include "snug/model/scene_task.hpp"
#include "snug/record/recording.hpp"
#include "snug/validation/simulated_run.hpp"

namespace snug::identification::internal {

struct CapturedRun {
  record::Recording recording;
  std::string failure;  ///< empty, or why it stopped early
};
[[nodiscard]] CapturedRun capture_program(const model::Scenario& scenario, const model::TaskProgram& program,
                                          std::optional<double> until);

/// One run that all recordings of the program are compared with, whatever each has of its own.
struct ProgramRun {
  validation::SimulatedRun seen;  ///< a run that failed on its way: as far as it went
  std::string failure;            ///< empty, or why nothing is to be compared
};
[[nodiscard]] ProgramRun run_program(const model::Scenario& scenario, const model::SceneTask& task, double until);
/// s, of the simulation: what has to be run for this recording.
[[nodiscard]] double end_of(const model::SceneTask& task, const RecordedMotion& motion, const OwnValues& own);
[[nodiscard]] SimulatedMotion motion_of(const ProgramRun& run, const model::SceneTask& task,
                                        const RecordedMotion& motion, const OwnValues& own);

}  // namespace snug::identification::internal
