// RunResult: what became of a run; one schema for the command line, recordings and pages (result_json.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "snug/cell/cell_arm.hpp"
#include "snug/cell/failure.hpp"
#include "snug/cell/item_event_log.hpp"
#include "snug/cell/lost_body.hpp"
#include "snug/cell/solver_summary.hpp"

namespace snug::runs {

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
  std::vector<cell::BoxResult> boxes;  ///< of the sequence
  std::vector<BodyResult> bodies;      ///< dynamic ones of a scene without a program
  std::vector<ContactResult> contacts;
  std::vector<cell::LostBody> lost;  ///< that left the cell
  std::vector<record::Event> events;
  std::vector<cell::Repick> repicks;
  cell::SolverSummary solver;
  std::uint64_t state_hash = 0;
  std::optional<cell::ProtectiveStop> stop;  ///< with a robot: the limit that ended the run
  bool is_interrupted = false;               ///< the observer ended the run early
  std::string ended_by = {};                 ///< of a run that is driven from outside: who or what ended it
  std::vector<std::string> warnings;         ///< what the result is to be taken with
  cell::Failure failure;                     ///< why the run had to stop, or failed though it went on to its end
};

struct RepickOffsets {
  double mean = 0.0, worst = 0.0;  ///< m
};
[[nodiscard]] RepickOffsets summarize(const std::vector<cell::Repick>& repicks);

}  // namespace snug::runs
