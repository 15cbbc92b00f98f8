// BeliefSnapshot: everything that a decision depends on, as a value: copied, compared, hashed, written to a file.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/geometry/bounds.hpp"
#include "snug/model/ids.hpp"
#include "snug/packing/agent.hpp"
#include "snug/skills/insertion.hpp"
#include "snug/skills/item_plan.hpp"

namespace snug::planning {

/// Where a box is believed to be.
struct BelievedBox {
  Pose X_WP;  ///< mean
  /// Of the error (p in W [m], rotation vector in W [rad]), linear first.
  Matrix6 covariance = Matrix6::Zero();
  bool was_seen = false;  ///< by the last observation
  bool operator==(const BelievedBox&) const = default;
};

/// A cell that could be: world 0 is nominal, the others are drawn from the scenario's uncertainty.
struct World {
  model::Scenario scenario;               ///< with sizes as measured, obstacles, and as stiff as boxes turned out
  std::vector<std::optional<Pose>> X_WP;  ///< item by item, where this world has it
  double weight = 1.0;                    ///< how well it predicted; of the sampled worlds the sum is their number
  bool operator==(const World&) const = default;
};

/// Where the robot stands when the motion that is planned begins.
struct RobotState {
  Pose X_WE;
  std::vector<double> q;  ///< rad; empty where the tool moves without joints
  motion::IO io;          ///< commanded
  bool operator==(const RobotState&) const = default;
};

/// How worlds are simulated, comparable.
struct SimulationChoice : cell::SimulationOptions {
  SimulationChoice() = default;
  SimulationChoice(cell::SimulationOptions options) : cell::SimulationOptions(std::move(options)) {}  // NOLINT
  bool operator==(const SimulationChoice& other) const {
    return tracking == other.tracking && cup == other.cup && robot == other.robot;
  }
};

/// Who decides where items go.
struct AgentSettings {
  std::string name;          ///< packing::agent_names(), or of who is asked
  bool is_asked = false;     ///< it decides elsewhere: PlanningWorkspace has the way to ask
  std::uint64_t seed = 1;    ///< of its roll-outs
  bool tries_places = true;  ///< packing::DecisionRun::tries_places
  packing::FutureModel future;
  bool operator==(const AgentSettings&) const = default;
};

/// A motion that was sent and was ended by a load, a joint or the clock: it would be again, so it is not sent again.
struct FailedMotion {
  model::ItemIndex item;
  packing::Placement planned;
  skills::InsertionSkill skill = skills::InsertionSkill::TopDown;
  skills::Reorientation reorientation = skills::Reorientation::None;
  /// It failed before the box hung as it was to, by more force than was foreseen: boxes of its type are not turned so.
  bool while_turning = false;
  bool operator==(const FailedMotion&) const = default;
};

struct BeliefSnapshot {
  model::Scenario scenario;     ///< as it was given
  std::string sequence;         ///< name
  std::uint64_t seed = 1;       ///< that the sampled worlds were drawn with
  SimulationChoice simulation;  ///< of the nominal world; sampled ones move the tool without joints
  AgentSettings agent;
  /// Item by item: places that were chosen before the session began; empty: the agent decides item by item.
  std::vector<std::optional<packing::Placement>> chosen;

  std::vector<packing::Item> items;               ///< of the sequence: sizes as measured, arrival as it stood last
  std::vector<std::optional<BelievedBox>> boxes;  ///< item by item; none: not in the cell
  std::vector<World> worlds;                      ///< never empty
  int stiffenings = 0;                            ///< how often boxes turned out stiffer than was believed
  std::vector<geometry::Aabb> obstacles;          ///< W: what is in the container and is no item, with its uncertainty
  std::vector<geometry::Aabb> obstacle_bodies;    ///< W: as the worlds have them, cut back beside boxes
  std::vector<model::ItemIndex> sent;             ///< items that motions were sent for, in that order
  std::vector<FailedMotion> failed;               ///< in that order
  std::vector<model::ItemIndex> skipped;          ///< items that came and are not packed, in that order
  int skips_left = 0;                             ///< items without a place that may still be skipped; below 0: none
  std::optional<model::ItemIndex> next;           ///< the item that follows: the tool goes on to where it is picked
  RobotState robot;

  [[nodiscard]] const model::Scenario& nominal() const { return worlds.front().scenario; }
  bool operator==(const BeliefSnapshot&) const = default;
};

/// The same value, the same hash, on every machine; of the scenario its text counts.
[[nodiscard]] std::uint64_t hash(const BeliefSnapshot& belief);

/// Worlds as they are before anything was seen: the nominal one and `samples` that are drawn from the scenario's
/// uncertainty by the seed. Physics steps are `rehearsal.coarse_steps` times as long, solved to ten times the
/// tolerance. No item is there.
[[nodiscard]] std::vector<World> draw_worlds(const model::Scenario& scenario, const std::string& sequence,
                                             std::uint64_t seed, int samples);
/// Obstacles become static bodies of the world, in the place of those that it had.
void set_obstacles(const BeliefSnapshot& belief, World& world);
/// How stiff boxes are, times what the scenario says, after so many stiffenings.
[[nodiscard]] double stiffness_after(const settings::BeliefParams& params, int stiffenings);
/// Goes from `from` stiffenings to `to`, one by one.
void stiffen(const settings::BeliefParams& params, int from, int to, World& world);

}  // namespace snug::planning
