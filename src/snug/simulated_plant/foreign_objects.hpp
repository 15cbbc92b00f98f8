// ForeignObjects: boxes that nobody told the planner of, put into the container of a simulated plant.
#pragma once

#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/core/rng.hpp"
#include "snug/simulated_plant/faults.hpp"

namespace snug::simulated_plant {

/// m, along its own axes; cardboard like the parcels.
inline const Vector3 kForeignSize(0.090, 0.070, 0.060);
inline constexpr double kForeignMass = 0.4;  ///< kg

/// One of them, by the plant's truth.
struct ForeignObject {
  std::string name;
  physics::BodyId body;
  bool is_in = false;       ///< the container, now
  bool has_rested = false;  ///< since it was put there
  Pose X_TB_put;            ///< in the container: where it was put, at rest
  Pose X_TB;                ///< now, or when it was taken out
  /// N, of boxes and tool on it since it rests, contact forces added up: its own weight on a box that carries it is one
  /// of them.
  double peak_force = 0.0;
};

/// The scenario with a body for each object that `faults` ask for, absent until it is put in.
[[nodiscard]] model::Scenario with_objects(model::Scenario scenario, const std::vector<Fault>& faults);

class ForeignObjects {
 public:
  /// `world`: of a scenario `with_objects`; the last bodies are theirs.
  ForeignObjects(const cell::Simulation& simulation, const std::vector<Fault>& faults, std::uint64_t seed);

  /// The next one stands in the container, on the floor or wholly on one box, at a place drawn by the seed, and has to
  /// come to rest. Nothing when there is no such place, or no object left.
  [[nodiscard]] const ForeignObject* put(cell::CellState& state);
  /// To be called when it has come to rest: from now on it counts where it is and what presses on it.
  void note_rest();
  void take_out(cell::CellState& state);
  /// To be called after each tick.
  void watch(const cell::CellState& state, const cell::CellWorkspace& work);

  [[nodiscard]] const std::vector<ForeignObject>& objects() const { return objects_; }

 private:
  [[nodiscard]] std::vector<Pose> free_places(const cell::CellState& state) const;

  const cell::Simulation& simulation_;
  Pose X_WT_;
  Rng rng_;
  std::vector<ForeignObject> objects_;
};

}  // namespace snug::simulated_plant
