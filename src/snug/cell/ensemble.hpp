// Ensemble: the same run under small random changes of what nobody knows exactly: one lucky run proves nothing.
#pragma once

#include <vector>

#include "snug/cell/run.hpp"
#include "snug/core/rng.hpp"

namespace snug::cell {

/// How far a box's mass may be off, as a share: boxes of the report weigh up to 2.3 % more or less than their type's
/// nominal mass (Tables 8 and 9); this is twice that.
inline constexpr double kMassSpread = 0.05;

/// Half widths of uniform changes.
struct Perturbation {
  double aligner_position = 0.5e-3;                           ///< m, along Ax and Ay
  double aligner_yaw = 0.2 * 3.14159265358979323846 / 180.0;  ///< rad
  double parcel_size = 0.5e-3;                                ///< m, each edge of each box
  double friction = 0.10;                                     ///< share of each pair's coefficient
  double mass = kMassSpread;                                  ///< share of each box's mass
};

struct EnsembleOptions {
  int count = 20;
  std::uint64_t seed = 1;
  int threads = 1;  ///< the results do not depend on it
  Perturbation perturbation;
};

struct EnsembleRun {
  int packed = 0;
  int boxes = 0;
  double filling_degree_percent = 0.0;
  double worst_repick = 0.0;  ///< m
  std::uint64_t state_hash = 0;
  std::string failure;
};

struct EnsembleResult {
  std::vector<EnsembleRun> runs;
  double mean_packed_percent = 0.0;
  double standard_deviation_percent = 0.0;
  double lowest_packed_percent = 0.0;
  int failed_runs = 0;  ///< that did not reach their end, such as by a protective stop
};

/// The scenario with every change drawn from `rng`.
[[nodiscard]] model::Scenario perturbed(const model::Scenario& scenario, const Perturbation& perturbation, Rng rng);

/// Masses and inertias of the scenario's boxes, each times 1 + a uniform draw within the half width.
void draw_masses(model::Scenario& scenario, double half_width, Rng rng);

/// Runs the program `count` times. Throws like run(). Nothing is recorded.
[[nodiscard]] EnsembleResult run_ensemble(const model::Scenario& scenario, const RunOptions& options,
                                          const EnsembleOptions& ensemble);

}  // namespace snug::cell
