// Rollout: one simulated run of a cell that could be, nominal or sampled: does waypoints, can go back.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/model/ids.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::planning {

enum class RolloutEnd {
  Completed,
  Failed,          ///< the simulation had to stop
  ProtectiveStop,  ///< of the robot
  TooMuchForce,    ///< of the cup on the held box
  ArmContact,      ///< a link of the arm touched something
  TooLong,         ///< the waypoints did not end
};

/// What happened while waypoints were followed.
struct Episode {
  RolloutEnd end = RolloutEnd::Completed;
  std::string text;          ///< empty, or what ended it, for people
  double peak_force = 0.0;   ///< N, of the cup on the held box
  double peak_torque = 0.0;  ///< Nm, about the lip
  double duration = 0.0;     ///< s, simulated
  std::string arm_contact;   ///< empty, or the first that a link of the arm touched
  [[nodiscard]] bool is_complete() const { return end == RolloutEnd::Completed; }
};

/// What ends an episode as a failure.
struct EpisodeLimits {
  double force = std::numeric_limits<double>::infinity();  ///< N, of the cup on the held box
  bool arm_may_touch = false;                              ///< boxes or what never moves, with its links
};

/// The larger peaks, both durations, the first failure.
void merge(Episode& into, const Episode& episode);
/// Appends waypoints, rounded.
void append(motion::Program& program, const std::vector<motion::Waypoint>& waypoints);

class Rollout {
 public:
  Rollout(const model::Scenario& scenario, const std::string& sequence, const cell::SimulationOptions& options);

  /// Follows the waypoints of `program` that were not followed yet, up to the moment when more can be appended, or
  /// until one of the limits is exceeded.
  Episode run(const motion::Program& program, const EpisodeLimits& limits = {});
  /// Goes on at the end of `program` for this long: boxes come to rest.
  Episode settle(const motion::Program& program, double seconds);
  /// Everything where the anchor says, after boxes came to rest for `seconds`, longer while one still falls: what does
  /// not stay in this world where it was seen shall not count as moved by what is rehearsed.
  void take_up(const cell::CellAnchor& anchor, double seconds);

  [[nodiscard]] const cell::CellState& state() const { return state_; }
  void restore(const cell::CellState& state) { state_ = state; }
  [[nodiscard]] const cell::Simulation& simulation() const { return *simulation_; }
  [[nodiscard]] double time() const { return simulation_->time(state_); }
  /// X_WP of an item; none when it is not in the cell.
  [[nodiscard]] std::optional<Pose> pose_of(model::ItemIndex item) const;
  /// The same of all items, in the order of the sequence.
  [[nodiscard]] std::vector<std::optional<Pose>> poses() const;
  [[nodiscard]] bool is_held(model::ItemIndex item) const;

 private:
  Episode settle(const motion::PreparedProgram& plan, double seconds);
  bool advance(const motion::PreparedProgram& plan, Episode& episode);

  std::unique_ptr<cell::Simulation> simulation_;
  cell::CellState state_;
  cell::CellWorkspace work_;
};

}  // namespace snug::planning
