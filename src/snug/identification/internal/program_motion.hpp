// capture_program: the run of a program, in memory; ProgramRun: what recordings of it are compared with.
#pragma once

#include <optional>
#include <string>

#include "snug/identification/internal/scene_motion.hpp"
#include "snug/model/scenario.hpp"
#include "snug/model/scene_task.hpp"
#include "snug/record/recording.hpp"

namespace snug::identification::internal {

struct CapturedRun {
  record::Recording recording;
  std::string failure;  ///< empty, or why it stopped early
};
[[nodiscard]] CapturedRun capture_program(const model::Scenario& scenario, const model::TaskProgram& program,
                                          std::optional<double> until);

/// A body's poses in a run; of those that are the same to the last bit, one after the other, the first and the last.
struct Track {
  std::vector<double> times;  ///< s
  std::vector<record::PoseSample> poses;
  void add(double time, const record::PoseSample& pose);
};

/// One run that all recordings of the program are compared with, whatever each has of its own.
struct ProgramRun {
  std::vector<Track> tracks;  ///< of the tracked bodies; a run that failed on its way: as far as it went
  double until = 0.0;         ///< s, asked for
  double end = 0.0;           ///< s, reached
  std::string failure;        ///< empty, or why nothing is to be compared
};
/// `drive`: leads the tool, or none: the program does.
[[nodiscard]] ProgramRun run_program(const model::Scenario& scenario, const model::SceneTask& task,
                                     const RecordedDrive* drive, double until);
/// s, of the simulation: what has to be run for this recording, up to `until` on its clock.
[[nodiscard]] double end_of(const model::SceneTask& task, const RecordedMotion& motion, const OwnValues& own,
                            double until);
[[nodiscard]] SimulatedMotion motion_of(const ProgramRun& run, const RecordedMotion& motion,
                                        const ComparedSamples& samples, const OwnValues& own);

}  // namespace snug::identification::internal
