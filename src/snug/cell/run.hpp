// run: a Scenario and what to do with it in, what became of everything out. The first file to read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "snug/cell/item_event_log.hpp"
#include "snug/cell/recorder.hpp"
#include "snug/cell/simulation.hpp"

namespace snug::cell {

struct RunResult;

struct RunOptions {
  std::optional<motion::Program> program;  ///< none: bodies alone, for `until` seconds
  std::string program_text;                ///< for the recording
  std::string sequence;                    ///< name; needed with a program
  std::string corrections;                 ///< name of a layer of the scenario, or empty
  SimulationOptions simulation;
  int threads = 1;                    ///< that share the work of a step; the result does not depend on it
  std::optional<double> until;        ///< s; absent: to the end of the program, or the scenario's duration
  std::filesystem::path record_path;  ///< HDF5, or empty
  OutputFile* record_file = nullptr;  ///< instead: from record::reserve_recording() before the work; taken; not owned
  std::string version;                ///< for the recording
  std::function<std::string(const RunResult&)> describe;  ///< JSON to keep in the recording, or none
  RunObserver* observer = nullptr;                        ///< sees each frame and event, may stop the run; not owned
};

struct BodyResult {
  std::string name;
  Pose X_WB;
  double speed = 0.0;  ///< m/s, of the centre of mass
};

/// A contact that bears a force at the end of a run.
struct ContactResult {
  std::string body_a, body_b;
  Vector3 p_WQ = Vector3::Zero();       ///< m
  Vector3 n_AB_W = Vector3::UnitZ();    ///< unit, from A to B
  Vector3 force_B_W = Vector3::Zero();  ///< N, on B
  double phi = 0.0;                     ///< m, gap
  bool slides = false;
};

struct RunResult {
  double duration = 0.0;  ///< s, simulated until the program's end (or `until`)
  double wall = 0.0;      ///< s
  double real_time_factor = 0.0;
  double filling_degree_percent = 0.0;
  std::vector<BoxResult> boxes;    ///< of the sequence
  std::vector<BodyResult> bodies;  ///< dynamic ones of a scene without a program
  std::vector<ContactResult> contacts;
  std::vector<LostBody> lost;  ///< that left the cell
  std::vector<record::Event> events;
  std::vector<Repick> repicks;
  SolverSummary solver;
  std::uint64_t state_hash = 0;
  std::optional<ProtectiveStop> stop;  ///< with a robot: the limit that ended the run
  bool is_interrupted = false;         ///< the observer ended the run early
  std::string ended_by = {};           ///< of a run that is driven from outside: who or what ended it
  std::vector<std::string> warnings;   ///< what the result is to be taken with
  /// Empty, or why the run had to stop (body, time, last contacts) or failed though it went on to its end.
  std::string failure;
};

/// Throws InputError for options that do not fit the scenario (unknown sequence, corrections, waypoint name, tick that
/// is no multiple of the time step, no tool or aligner) and for a recording that cannot be written; OutputError when
/// writing it fails.
[[nodiscard]] RunResult run(const model::Scenario& scenario, const RunOptions& options);

}  // namespace snug::cell
