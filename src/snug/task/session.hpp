// PackingSession: item after item, decide, try in what could be, do it, look, go on.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "snug/packing/agent.hpp"
#include "snug/task/item_plan.hpp"
#include "snug/task/uncertainty.hpp"

namespace snug::task {

/// How the session learns where boxes came to rest.
enum class Perception {
  Exact,          ///< the poses of the simulation
  Noisy,          ///< those with noise
  DeadReckoning,  ///< never: boxes are believed to be where they were planned
};

/// When an item counts as placed.
struct PlaceLimits {
  double position = 0.020;                       ///< m, level distance from where it was planned
  double tilt = 6.0 * std::numbers::pi / 180.0;  ///< rad, from how it was planned
  double displacement = 0.020;                   ///< m, of a box that was there before
  double force = 150.0;                          ///< N, of the cup on the box: an attempt is given up
};

struct SessionOptions {
  std::string agent = "contact-aware";
  packing::Ask ask;  ///< decides in its place, if set (packing/remote_agent.hpp); `agent` is then its name
  packing::PackingSettings packing;
  /// m, of agents that decide as items come (`PackingSettings::last_squeeze`): 1 mm more than the clearance that the
  /// demonstrator's boxes have in contact (docs/decisions/0005).
  double last_squeeze = 0.003;
  int threads = 1;              ///< results do not depend on it
  int samples = 8;              ///< courses of events that could be, executed beside the one that counts; 0: none
  double accepted_share = 1.0;  ///< of the samples that have to succeed for an attempt to be taken at once
  double good_share = 0.8;      ///< of the samples, for an attempt to be taken after `max_attempts`
  double least_share = 0.5;     ///< of the samples, below which not even the best attempt is taken
  int max_attempts = 10;        ///< for an item: candidates times manners
  int most_attempts = 24;       ///< where none was good
  /// What may follow an item; absent: any parcel of the scenario.
  std::optional<packing::FutureModel> future;
  Uncertainty uncertainty;
  PlaceLimits limits;
  Perception perception = Perception::Exact;
  double perception_noise = 0.002;  ///< m, half width (Noisy); angles: this many rad per 100 mm
  cell::SimulationOptions simulation{motion::ControllerKind::Faithful, cup::CupMode::Phases, {}};
};

struct AttemptForces {
  double force = 0.0;         ///< N
  double torque = 0.0;        ///< Nm
  double displacement = 0.0;  ///< m, of the other boxes, the largest
};

struct ItemReport {
  std::string id;
  bool is_placed = false;
  std::string reason;  ///< why not
  packing::Placement planned;
  TurnManner turn = TurnManner::None;
  PlaceManner manner = PlaceManner::Straight;
  int flips = 0;
  int attempts = 0;         ///< simulated for this item
  int stops = 0;            ///< of them that ended with a protective stop of the robot, in the course that counts
  int samples = 0;          ///< in which it was tried beside the course that counts
  double share = 0.0;       ///< of the samples that succeeded; means nothing without samples
  AttemptForces predicted;  ///< largest of the samples; means nothing without samples
  AttemptForces happened;
  double position_error = 0.0;    ///< m
  double angle_error = 0.0;       ///< rad
  double decision_seconds = 0.0;  ///< wall clock, of the agent alone
  double prediction_seconds = 0.0;
};

struct SessionResult {
  std::string sequence;
  std::string agent;
  std::vector<ItemReport> items;
  motion::Program program;
  std::vector<packing::Placement> plan;  ///< in the order of packing
  int planned_boxes = 0, executed_boxes = 0;
  double planned_percent = 0.0, executed_percent = 0.0;
  double decision_seconds_median = 0.0;
  double duration = 0.0;  ///< s, simulated
  std::vector<cell::BoxResult> boxes;
  std::uint64_t state_hash = 0;
  std::string stopped;  ///< why the session ended
  std::string failure;  ///< empty, or why the robot did not get home: the program cannot be run to its end
};

/// Called after every item.
using Progress = std::function<void(const SessionResult& so_far, int item, int items)>;

/// Packs a sequence. Agents that re-arrange or know the sequence (manual, offline) make their plan first, and its boxes
/// are executed in its order. Throws InputError for an unknown sequence, agent, or a scenario that cannot be packed.
[[nodiscard]] SessionResult pack(const model::Scenario& scenario, const std::string& sequence,
                                 const SessionOptions& options, const Progress& progress = {});

/// The same with the decisions made: each placement is executed in the best manner; boxes that do not
/// come to their place are left out.
[[nodiscard]] SessionResult execute(const model::Scenario& scenario, const std::string& sequence,
                                    const std::vector<packing::Placement>& plan, const SessionOptions& options,
                                    const Progress& progress = {});

}  // namespace snug::task
