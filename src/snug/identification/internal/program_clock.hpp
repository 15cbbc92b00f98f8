// Program clock: where a robot's log stands in time beside a run of the program that the robot was sent.
#pragma once

#include <functional>
#include <optional>

#include "snug/record/archive.hpp"
#include "snug/validation/simulated_run.hpp"

namespace snug::identification::internal {

/// s, what the log's clock shows at the run's time 0, by the tool's way to its first pick: nothing that is felt has
/// changed its timing by then. `guess` is within 0.15 s. None where the tool does not move before the vacuum is
/// switched on, or the vacuum never is. Needs has_drive.
[[nodiscard]] std::optional<double> find_program_start(const validation::SimulatedRun& run,
                                                       const record::ArchiveRecording& recording, double guess);

/// m, root mean square over the log: how far its tool is from where the run's tool is within `early_or_late` seconds.
/// `to_run`: of the log's clock, the run's. Infinite where no sample of the log is within the run.
[[nodiscard]] double find_path_distance(const validation::SimulatedRun& run, const record::ArchiveRecording& recording,
                                        const std::function<double(double)>& to_run, double early_or_late);

}  // namespace snug::identification::internal
