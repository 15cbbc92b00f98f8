// measure_validation: what a virtual experiment with known parameters says of predictions, and what validating costs.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "bench/figures/internal/cpu_time.hpp"
#include "bench/figures/internal/validation_bench.hpp"
#include "snug/core/rng.hpp"
#include "snug/model/sensors.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/runs/run.hpp"
#include "snug/validation/measure.hpp"
#include "snug/validation/page.hpp"

namespace snug::bench::internal {
namespace {

namespace fs = std::filesystem;

constexpr int kValidatedRuns = 3;

class ScratchFolder {
 public:
  ScratchFolder() : path_(fs::temp_directory_path() / ("snug-bench-" + std::to_string(::getpid()))) {
    fs::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] fs::path operator/(const std::string& name) const { return path_ / name; }

 private:
  fs::path path_;
};

validation::SimulatedRun simulate(const model::Scenario& scenario, const BenchOptions& options, const fs::path& path) {
  runs::RunOptions run;
  run.program = motion::load_program(options.program);
  run.sequence = "1";
  run.corrections = options.corrections;
  run.record_path = path;
  (void)runs::run(scenario, run);
  return validation::load_run(path);
}

/// Every parameter one standard error to one side or the other.
model::Scenario off_by_one(model::Scenario scenario, Rng rng) {
  const auto sign = [&] { return rng.index(2) == 0 ? -1.0 : 1.0; };
  for (model::ContactPair& pair : scenario.contact_pairs) {
    pair.params.friction = std::max(0.0, pair.params.friction + 0.01 * sign());
    pair.params.restitution = std::clamp(pair.params.restitution + 0.03 * sign(), 0.0, 1.0);
  }
  for (model::Parcel& parcel : scenario.parcels)
    for (int axis = 0; axis < 3; ++axis) parcel.inertia.com[axis] += 2e-3 * sign();
  for (model::CupElasticity* part : {&scenario.cup.stiffness, &scenario.cup.damping}) {
    // One factor for each whole matrix: it stays positive definite.
    const double factor = 1.0 + 0.05 * sign();
    for (double* value : {&part->lateral, &part->axial, &part->bend, &part->torsion, &part->coupling}) *value *= factor;
  }
  scenario.parcel_clearance = std::max(0.0, scenario.parcel_clearance + 0.3e-3 * sign());
  return scenario;
}

std::vector<validation::MeasureTruth> save(const fs::path& path,
                                           const std::vector<const validation::SimulatedRun*>& runs,
                                           const model::Sensors& sensors) {
  record::ArchiveWriter writer(path);
  std::vector<validation::MeasureTruth> truths;
  for (int k = 1; k <= kValidatedRuns; ++k) {
    validation::MeasureOptions settings;
    settings.repetition = k;
    settings.repetitions = kValidatedRuns;
    const validation::SimulatedRun& run = *runs[static_cast<std::size_t>(k - 1) % runs.size()];
    validation::VirtualMeasurement measured = validation::measure(run, sensors, settings);
    writer.add(measured.recording);
    truths.push_back(std::move(measured.truth));
  }
  writer.close();
  return truths;
}

/// Root mean square of all rest errors, over that of what the sensors alone make: the frame of a body, set once, and
/// the mean of 0.5 s of noise.
double rest_over_noise(const validation::Validation& validation, const model::MotionCaptureParams& sensor) {
  double sum = 0.0, count = 0.0;
  for (const validation::BodyReport& body : validation.bodies) {
    for (const validation::Errors& errors : body.errors.clean) {
      if (!std::isfinite(errors.rest_position)) continue;
      sum += errors.rest_position * errors.rest_position;
      count += 1.0;
    }
  }
  const double samples = validation::kRestSpan * sensor.rate;
  const double variance =
      3.0 * (sensor.position_error * sensor.position_error + sensor.position_noise * sensor.position_noise / samples);
  return std::sqrt(sum / count / variance);
}

double worst_shift_ms(const validation::Validation& validation, const std::vector<validation::MeasureTruth>& truths) {
  double worst = 0.0;
  for (std::size_t k = 0; k < truths.size(); ++k) {
    const validation::ClockTruth clocks[] = {truths[k].motion_capture, truths[k].force_torque, truths[k].encoders};
    const std::vector<validation::SourceClock>& found = validation.repetitions[k].clocks;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (!found[i].fit) return std::numeric_limits<double>::infinity();
      const double expected = clocks[i].offset + clocks[i].rate * found[i].fit->middle;
      worst = std::max(worst, 1e3 * std::abs(found[i].fit->shift - expected));
    }
  }
  return worst;
}

}  // namespace

ValidationFigures measure_validation(const BenchOptions& options) {
  const ScratchFolder folder;
  const model::Scenario scenario = model::load_scenario(options.scenario);
  const model::Sensors sensors = model::load_sensors(options.sensors);
  const validation::SimulatedRun run = simulate(scenario, options, folder / "run.h5");
  ValidationFigures figures;
  {
    const auto truths = save(folder / "true.h5", {&run}, sensors);
    const double start = cpu_seconds();
    const validation::Validation result =
        validation::validate(run, validation::load_repetitions(folder / "true.h5", run, {}));
    const std::string page = validation::make_page(run, result);
    figures.seconds = cpu_seconds() - start;
    figures.true_clean = result.clean;
    figures.true_report = result.report;
    figures.rest_over_noise = rest_over_noise(result, sensors.motion_capture);
    figures.worst_shift_ms = worst_shift_ms(result, truths);
  }
  fs::remove(folder / "true.h5");
  std::vector<validation::SimulatedRun> others;
  std::vector<const validation::SimulatedRun*> pointers;
  for (int k = 1; k <= kValidatedRuns; ++k)
    others.push_back(
        simulate(off_by_one(scenario, Rng(1).split("off by one " + std::to_string(k))), options, folder / "other.h5"));
  for (const validation::SimulatedRun& other : others) pointers.push_back(&other);
  (void)save(folder / "off.h5", pointers, sensors);
  const validation::Validation result =
      validation::validate(run, validation::load_repetitions(folder / "off.h5", run, {}));
  figures.off_clean = result.clean;
  figures.off_report = result.report;
  return figures;
}

}  // namespace snug::bench::internal
