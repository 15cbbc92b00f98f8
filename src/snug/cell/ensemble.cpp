// Ensemble: the same run under small random changes of what nobody knows exactly: one lucky run proves nothing.
#include "snug/cell/ensemble.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "snug/core/parallel.hpp"

namespace snug::cell {
namespace {

EnsembleRun run_one(const model::Scenario& scenario, const RunOptions& options, const EnsembleOptions& ensemble,
                    int index) {
  const Rng rng = Rng(ensemble.seed).split("ensemble " + std::to_string(index));
  const RunResult result = run(perturbed(scenario, ensemble.perturbation, rng), options);
  EnsembleRun one;
  one.boxes = static_cast<int>(result.boxes.size());
  one.packed = static_cast<int>(std::count_if(result.boxes.begin(), result.boxes.end(),
                                              [](const BoxResult& box) { return box.state == BoxState::Packed; }));
  one.filling_degree_percent = result.filling_degree_percent;
  for (const Repick& repick : result.repicks) one.worst_repick = std::max(one.worst_repick, repick.offset);
  one.state_hash = result.state_hash;
  one.failure = result.failure;
  return one;
}

void summarize(EnsembleResult& result) {
  double sum = 0.0, square = 0.0;
  result.lowest_packed_percent = 100.0;
  for (const EnsembleRun& one : result.runs) {
    const double percent = one.boxes > 0 ? 100.0 * one.packed / one.boxes : 0.0;
    result.failed_runs += one.failure.empty() ? 0 : 1;
    sum += percent;
    square += percent * percent;
    result.lowest_packed_percent = std::min(result.lowest_packed_percent, percent);
  }
  const double count = static_cast<double>(result.runs.size());
  result.mean_packed_percent = sum / count;
  const double variance = square / count - result.mean_packed_percent * result.mean_packed_percent;
  result.standard_deviation_percent = std::sqrt(std::max(0.0, variance));
}

}  // namespace

model::Scenario perturbed(const model::Scenario& scenario, const Perturbation& perturbation, Rng rng) {
  model::Scenario changed = scenario;
  const auto draw = [&rng](double half_width) { return rng.uniform(-half_width, half_width); };
  if (changed.aligner) {
    const double x = draw(perturbation.aligner_position), y = draw(perturbation.aligner_position);
    const double yaw = draw(perturbation.aligner_yaw);
    changed.aligner->X_WA = changed.aligner->X_WA * Pose{exp_rotation(Vector3(0.0, 0.0, yaw)), Vector3(x, y, 0.0)};
  }
  for (model::Parcel& parcel : changed.parcels) {
    for (int i = 0; i < 3; ++i) parcel.size[i] += draw(perturbation.parcel_size);
  }
  for (model::ContactPair& pair : changed.contact_pairs) pair.params.friction *= 1.0 + draw(perturbation.friction);
  draw_masses(changed, perturbation.mass, rng.split("mass"));
  return changed;
}

void draw_masses(model::Scenario& scenario, double half_width, Rng rng) {
  if (half_width == 0.0) return;
  for (model::Parcel& parcel : scenario.parcels) {
    const double factor = 1.0 + rng.uniform(-half_width, half_width);
    parcel.inertia.mass *= factor;
    parcel.inertia.inertia *= factor;
  }
}

EnsembleResult run_ensemble(const model::Scenario& scenario, const RunOptions& options,
                            const EnsembleOptions& ensemble) {
  RunOptions unrecorded = options;
  unrecorded.record_path.clear();
  unrecorded.record_file = nullptr;
  unrecorded.observer = nullptr;
  EnsembleResult result;
  result.runs.resize(static_cast<std::size_t>(ensemble.count));
  parallel_for(ensemble.count, ensemble.threads, [&](int i, int) {
    result.runs[static_cast<std::size_t>(i)] = run_one(scenario, unrecorded, ensemble, i);
  });
  summarize(result);
  return result;
}

}  // namespace snug::cell
