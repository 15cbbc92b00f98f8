// validate: the report's four criteria (section 4.4.1) for a simulated run and the repetitions of its experiment.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "snug/validation/metrics.hpp"

namespace snug::validation {

/// Mean over repetitions in which the value was measured, and their standard deviation (NaN below two).
struct Spread {
  double mean = 0.0;       ///< NaN when it never was
  double deviation = 0.0;  ///< of one repetition
  int count = 0;           ///< repetitions that count
};

/// Errors of one window over all repetitions.
struct ErrorTable {
  std::vector<Errors> clean, report;  ///< by repetition
};
[[nodiscard]] Spread spread_of(const std::vector<Errors>& errors, double Errors::*value);

/// One box: what became of it, and how well that was predicted.
struct BodyReport {
  std::string body;
  Window window;
  std::string simulated_state;               ///< "packed", "outside" and so on, as the result of the run says
  std::vector<std::string> measured_states;  ///< by repetition: "packed", "outside", "lost", "not measured"
  ErrorTable errors;
};

/// A moment that decides whether a box gets packed (report, Table 3).
struct MomentReport {
  std::string what;  ///< "flipping" or "packing"
  Window window;
  ErrorTable errors;
};

/// Means over all bodies of the mean over repetitions: what the report's tables are compared by. SI.
struct Means {
  double rest_position = 0.0, rest_rotation = 0.0, rms_position = 0.0, rms_rotation = 0.0, rms_force = 0.0,
         rms_torque = 0.0;
  int bodies = 0;  ///< with a rest pose
};

struct Validation {
  std::string simulated;  ///< file name
  std::string sequence;
  std::string protective_stop;  ///< of the simulated run, or empty
  std::vector<Measurement> repetitions;
  std::vector<BodyReport> bodies;  ///< in the order of packing
  std::vector<MomentReport> moments;
  Means clean, report;
};

/// Compares each repetition with the run in each window. `windows` empty: those of find_windows.
[[nodiscard]] Validation validate(const SimulatedRun& run, std::vector<Measurement> repetitions,
                                  std::vector<Window> windows = {});

/// The windows that events of the run give: from 1 s before a box is first held to 2 s after it is last released, but
/// not into the next box's. A body that is never held: as long as it is there.
[[nodiscard]] std::vector<Window> find_windows(const SimulatedRun& run);

/// Reads a CSV with a header and the columns body, start_s, end_s, and perhaps sequence: then only rows of this run's
/// sequence count. Throws InputError (file:line) for anything else, and for bodies that the run does not have.
[[nodiscard]] std::vector<Window> load_windows(const std::filesystem::path& path, const SimulatedRun& run);

/// The recordings of an archive that show boxes (repetitions, not calibrations of a sensor), each on the run's clock. A
/// .csv file is read as one log. Throws InputError for a file that holds none, or none whose clock can be found.
[[nodiscard]] std::vector<Measurement> load_repetitions(const std::filesystem::path& path, const SimulatedRun& run,
                                                        const HandShifts& shifts);

}  // namespace snug::validation
