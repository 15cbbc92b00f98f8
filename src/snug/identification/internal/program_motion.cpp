// simulate_program: the boxes of a program's run, as its frames have them.
#include <algorithm>

#include "snug/cell/run.hpp"
#include "snug/identification/internal/program_motion.hpp"
#include "snug/identification/internal/scene_motion.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/record/archive.hpp"
#include "snug/validation/simulated_run.hpp"

namespace snug::identification::internal {

CapturedRun capture_program(const model::Scenario& scenario, const model::TaskProgram& program,
                            std::optional<double> until) {
  cell::RunCapture capture;
  cell::RunOptions options;
  options.program = motion::load_program(program.file);
  options.sequence = program.sequence;
  options.corrections = program.corrections;
  options.until = until;
  options.observer = &capture;
  if (program.with_phases) options.simulation.cup = cup::CupMode::Phases;
  const cell::RunResult result = cell::run(scenario, options);
  return {std::move(capture.recording), result.failure};
}

SimulatedMotion simulate_program(const model::Scenario& scenario, const model::SceneTask& task,
                                 const RecordedMotion& motion, const OwnValues& own) {
  constexpr double kGap = 0.1;  // s, between frames that are one motion
  const std::size_t count = sample_count(task, motion);
  const double end = motion.times[count - 1] - own.delay + kGap;
  const CapturedRun run = capture_program(scenario, *task.program, end);
  SimulatedMotion simulated;
  if (run.recording.frames.size() < 2) {
    simulated.failure = run.failure.empty() ? "the run ended before its first frame" : run.failure;
    return simulated;
  }
  // A run that failed on its way is compared as far as it went; the rest is lost.
  const validation::SimulatedRun seen = validation::make_run(run.recording, "simulation");
  for (const RecordedBody& body : motion.tracked) {
    const int index = record::find_body(seen.header, body.body);
    std::vector<record::PoseSample>& poses = simulated.bodies.emplace_back(motion.times.size(), record::lost_pose());
    if (index < 0) continue;
    validation::PoseCursor cursor(seen.times, seen.bodies[static_cast<std::size_t>(index)]);
    for (std::size_t k = 0; k < count; ++k) poses[k] = cursor.at(motion.times[k] - own.delay, kGap);
  }
  return simulated;
}

}  // namespace snug::identification::internal
