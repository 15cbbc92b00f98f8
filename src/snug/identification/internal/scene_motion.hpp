// simulate_scene: where tracked bodies would have been at the times of a recording.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "snug/identification/driven_path.hpp"
#include "snug/identification/recorded_motion.hpp"
#include "snug/model/scenario.hpp"
#include "snug/model/scene_task.hpp"

namespace snug::identification::internal {

/// What a recording has of its own, by name.
struct OwnValues {
  /// `values`: in the order of own_deviation(); empty: all zero.
  OwnValues(const model::SceneTask& task, Eigen::Index path_unknowns, const Eigen::VectorXd& values);
  /// s, what a recording's clock shows at a time less what the simulation's does.
  [[nodiscard]] double late_at(double time) const { return delay + clock_rate * time; }
  Twist start;              ///< added to the start twist of each tracked body
  double delay = 0.0;       ///< s, at time 0
  double clock_rate = 0.0;  ///< by how much the recording's clock is fast, relative
  Pose bias;                ///< of the simulation's world in the recorded one
  std::vector<Pose> X_BM;   ///< of each tracked body: the frame that was recorded
  Eigen::VectorXd path;     ///< shares of the modes of the driven bodies' paths
};
/// Standard deviations expected of velocity (3), angular velocity (3), delay, clock rate, bias: position (3), rotation
/// vector (3), then of each tracked body's frame the same; as far as they are fitted; of the driven bodies' paths last.
[[nodiscard]] Eigen::VectorXd own_deviation(const model::SceneTask& task, Eigen::Index path_unknowns);
/// For each own unknown: the one tracked body of which it changes residuals; none: it may change those of all.
[[nodiscard]] std::vector<std::optional<std::size_t>> own_bodies(const model::SceneTask& task,
                                                                 Eigen::Index path_unknowns);

struct SimulatedMotion {
  /// X_WB by tracked body at each time of the recording; not a number where the simulation does not reach.
  std::vector<std::vector<record::PoseSample>> bodies;
  double end = std::numeric_limits<double>::infinity();  ///< s, on the recording's clock: it broke off there
  std::string failure;
};

/// Samples of a recording that lie within the simulation's time; at least one.
[[nodiscard]] std::size_t sample_count(const model::SceneTask& task, const RecordedMotion& motion);
/// Of each tracked body the samples that are compared, as indices into the motion's times.
using ComparedSamples = std::vector<std::vector<std::size_t>>;
[[nodiscard]] ComparedSamples compared_samples(const model::SceneTask& task, const RecordedMotion& motion);

/// Rows of a body before it may touch another one, as the scenario has their shapes; at most those asked for.
[[nodiscard]] std::size_t count_flight_rows(const model::Scenario& scenario, const RecordedBody& body,
                                            const model::StartSettings& start);

/// `driven`: paths of the bodies that the recording drives. `flights`: rows of free flight of each tracked body, with
/// StartFrom::FreeFlight. `until`: s, on the recording's clock: what comes later is not simulated.
[[nodiscard]] SimulatedMotion simulate_scene(const model::Scenario& scenario, const model::SceneTask& task,
                                             const RecordedMotion& motion, std::span<const DrivenPath> driven,
                                             const std::vector<std::size_t>& flights, const OwnValues& own,
                                             double until);

}  // namespace snug::identification::internal
