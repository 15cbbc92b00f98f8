// run: a Scenario and what to do with it in, what became of everything out. The first file to read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/runs/recorder.hpp"
#include "snug/runs/result.hpp"

namespace snug::runs {

struct RunOptions {
  std::optional<motion::Program> program;  ///< none: bodies alone, for `until` seconds
  std::string program_text;                ///< for the recording
  std::string sequence;                    ///< name; needed with a program
  std::string corrections;                 ///< name of a layer of the scenario, or empty
  cell::SimulationOptions simulation;
  int threads = 1;                    ///< that share the work of a step; the result does not depend on it
  std::optional<double> until;        ///< s; absent: to the end of the program, or the scenario's duration
  std::filesystem::path record_path;  ///< HDF5, or empty
  OutputFile* record_file = nullptr;  ///< instead: from record::reserve_recording() before the work; taken; not owned
  std::string version;                ///< for the recording
  std::function<std::string(const RunResult&)> describe;  ///< JSON to keep in the recording, or none
  RunObserver* observer = nullptr;                        ///< sees each frame and event, may stop the run; not owned
};

/// Throws InputError for options that do not fit the scenario (unknown sequence, corrections, waypoint name, tick that
/// is no multiple of the time step, no tool or aligner) and for a recording that cannot be written; OutputError when
/// writing it fails.
[[nodiscard]] RunResult run(const model::Scenario& scenario, const RunOptions& options);

}  // namespace snug::runs
