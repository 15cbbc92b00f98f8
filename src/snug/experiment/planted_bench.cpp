// measure_planted: numbers put into virtual experiments of a program, and what identification makes of their
// recordings.
#include "snug/experiment/internal/planted_bench.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "snug/cell/run.hpp"
#include "snug/experiment/internal/scene_bench.hpp"
#include "snug/identification/scene_fit.hpp"
#include "snug/model/number_edit.hpp"
#include "snug/model/sensors.hpp"
#include "snug/validation/measure.hpp"

namespace snug::experiment::internal {
namespace {

constexpr double kClip = 20.0;   // s, from the beginning of the program
constexpr int kPlantedRuns = 3;  // repetitions, as archives have of a sequence
constexpr double kDelay = 5e-4;  // s, of what clocks are found to

record::Recording run_clip(const model::Scenario& scenario, const BenchOptions& options) {
  cell::RunCapture capture;
  cell::RunOptions run;
  run.program = motion::load_program(options.program);
  run.sequence = "1";
  run.corrections = options.corrections;
  run.until = kClip;
  run.observer = &capture;
  (void)cell::run(scenario, run);
  return std::move(capture.recording);
}

/// A number that is planted, how far off the search starts, and how near it has to come back.
struct Planted {
  model::TaskParameter parameter;
  double truth = 0.0, allowed = 0.0;
};

std::vector<Planted> planted_numbers(const std::string& box) {
  const auto one = [](const std::string& name, const std::string& path, double value, double low, double high,
                      double step, double truth, double allowed) {
    return Planted{{name, {path}, model::ParameterForm::Value, value, low, high, step, false, name}, truth, allowed};
  };
  return {one("cup_bend", "cup.stiffness.bend", 5.0, 2.0, 10.0, 0.1, 5.9, 0.05 * 5.9),
          one("cup_lateral", "cup.stiffness.lateral", 2500.0, 1500.0, 5000.0, 50.0, 2900.0, 0.05 * 2900.0),
          one("com_x", "parcels." + box + ".com[0]", 0.0, -0.03, 0.03, 0.0005, 0.008, 0.002)};
}

}  // namespace

void measure_planted(const BenchOptions& options, std::vector<Figure>& figures) {
  if (!std::filesystem::exists(options.program) || !std::filesystem::exists(options.sensors)) return;
  const model::Scenario base = model::load_scenario(options.scenario);
  const std::string box = model::find_sequence(base, "1")->items.front().parcel;
  const std::vector<Planted> numbers = planted_numbers(box);
  model::SceneTask task;
  task.path = task.scenario = options.scenario;
  task.program = model::TaskProgram{options.program, "1", options.corrections, false};
  task.simulation_time = kClip;
  task.tracked = {{box, {}, {}, {}}};
  task.start.from = model::StartFrom::Scenario;
  const model::Sensors sensors = model::load_sensors(options.sensors);
  task.position_noise = sensors.motion_capture.position_noise;
  task.rotation_noise = sensors.motion_capture.rotation_noise;
  // The frame of the box's markers is off by a constant, which is no noise; the world's, the robot's base, is not.
  task.own.delay = kDelay;
  task.own.frame_position = sensors.motion_capture.position_error;
  task.own.frame_rotation = sensors.motion_capture.rotation_error;
  task.rotation_position_ratio = task.position_noise / task.rotation_noise;
  task.search.held_back = 0;
  task.search.local = 60;
  std::vector<model::NumberEdit> edits;
  for (const Planted& number : numbers) {
    task.parameters.push_back(number.parameter);
    edits.push_back({number.parameter.paths.front(), number.truth});
  }
  const validation::SimulatedRun truth =
      validation::make_run(run_clip(model::with_numbers(base, edits), options), "truth");
  std::vector<record::ArchiveRecording> recordings;
  for (int k = 1; k <= kPlantedRuns; ++k) {
    validation::MeasureOptions settings;
    settings.repetition = k;
    settings.repetitions = kPlantedRuns;
    recordings.push_back(validation::measure(truth, sensors, settings).recording);
  }
  const auto begin = std::chrono::steady_clock::now();
  const identification::SceneExperiment experiment(
      task, identification::motions_of_archive(task, run_clip(base, options), recordings, "virtual experiment"), 2);
  const identification::SceneFit fit = identification::identify_scene(experiment);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const identification::Parameter& found = fit.parameters[i];
    const std::string name = "identification.planted." + found.name;
    const double error = std::abs(found.value - numbers[i].truth);
    figures.push_back(at_most(name + "_error", error, "SI", numbers[i].allowed));
    figures.push_back({name + "_error_over_its_standard_error", error / found.standard_error, "1", "", true});
  }
  figures.push_back({"identification.planted.chi2_per_dof", fit.chi2_per_dof, "1", "", true});
  figures.push_back(at_most("identification.planted.clip_of_20_s", wall.count(), "s", 60.0));
}

}  // namespace snug::experiment::internal
