// Figures of the robot: cost of a controller tick, of a program through the joints, of a check.
#include "bench/figures/internal/robot_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "bench/figures/internal/scene_bench.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/program_check.hpp"
#include "snug/runs/run.hpp"

namespace snug::bench::internal {
namespace {

/// Every tick of the program by the wall clock: kinematics, distances and QP, without the cell around them.
void measure_ticks(const model::Scenario& scenario, const motion::Program& program, std::vector<Figure>& figures) {
  const cell::Simulation simulation(scenario, "1",
                                    {motion::LaggedTracking{}, cup::CupMode::Holding, scenario.robot->name});
  const motion::PreparedProgram plan = simulation.prepare(program);
  const control::JointController& controller = simulation.arm()->controller();
  const control::StateMachine machine = control::make_demonstrator_machine();
  control::MachineState state = machine.make_state(controller, simulation.arm()->start());
  control::JointControllerWork work;
  std::vector<double> times;
  for (bool has_ended = false; !has_ended && times.size() < 100'000;) {
    const auto start = std::chrono::steady_clock::now();
    has_ended = machine.tick(plan, controller, state, work).program.finished_now;
    times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(times.begin(), times.end());
  figures.push_back(at_most("robot.tick_median", times[times.size() / 2], "us", 60.0));
  figures.push_back(at_most("robot.tick_p99", times[times.size() * 99 / 100], "us", 200.0));
}

}  // namespace

void measure_robot(const BenchOptions& options, std::vector<Figure>& figures) {
  if (!std::filesystem::exists(options.program)) return;
  const model::Scenario scenario = model::load_scenario(options.scenario);
  if (!scenario.robot) return;
  runs::RunOptions run;
  run.program = motion::load_program(options.program);
  run.sequence = "1";
  run.corrections = options.corrections;
  run.simulation.robot = scenario.robot->name;
  const motion::Program program = runs::corrected(scenario, *run.program, options.corrections);
  measure_ticks(scenario, program, figures);

  runs::CheckOptions check_options;
  check_options.sequence = "1";
  const runs::CheckResult check = runs::check_program(scenario, program, check_options);
  const double per_hundred = check.wall * 100.0 / static_cast<double>(program.waypoints.size());
  figures.push_back(at_most("robot.check_100_rows", per_hundred, "s", 0.5));

  const runs::RunResult result = runs::run(scenario, run);
  figures.push_back({"robot.real_time_factor", result.real_time_factor, "1", ">= 50", result.real_time_factor >= 50.0});
  const auto packed = std::count_if(result.boxes.begin(), result.boxes.end(),
                                    [](const cell::BoxResult& box) { return box.state == cell::BoxState::Packed; });
  figures.push_back({"robot.packed", static_cast<double>(packed), "boxes", "", true});
}

}  // namespace snug::bench::internal
