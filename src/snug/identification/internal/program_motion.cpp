// ProgramRun: the boxes of a program's run, as its frames have them.
#include "snug/identification/internal/program_motion.hpp"

#include "snug/cell/run.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/record/archive.hpp"

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

namespace {

constexpr double kGap = 0.1;  // s, between frames that are one motion

record::PoseSample midway(const record::PoseSample& a, const record::PoseSample& b) {
  if (!record::is_tracked(a) || !record::is_tracked(b)) return record::lost_pose();
  const Matrix3 R = a.pose().R;
  return Pose{R * exp_rotation(0.5 * log_rotation(R.transpose() * b.pose().R)), 0.5 * (a.p + b.p)};
}

}  // namespace

ProgramRun run_program(const model::Scenario& scenario, const model::SceneTask& task, double until) {
  const CapturedRun captured = capture_program(scenario, *task.program, until);
  ProgramRun run;
  if (captured.recording.frames.size() >= 2)
    run.seen = validation::make_run(captured.recording, "simulation");
  else
    run.failure = captured.failure.empty() ? "the run ended before its first frame" : captured.failure;
  return run;
}

double end_of(const model::SceneTask& task, const RecordedMotion& motion, const OwnValues& own) {
  return motion.times[sample_count(task, motion) - 1] - own.delay + kGap;
}

SimulatedMotion motion_of(const ProgramRun& run, const model::SceneTask& task, const RecordedMotion& motion,
                          const OwnValues& own) {
  SimulatedMotion simulated;
  simulated.failure = run.failure;
  if (!run.failure.empty()) return simulated;
  const std::size_t count = sample_count(task, motion);
  for (const RecordedBody& body : motion.tracked) {
    const int index = record::find_body(run.seen.header, body.body);
    std::vector<record::PoseSample>& poses = simulated.bodies.emplace_back(motion.times.size(), record::lost_pose());
    if (index < 0) continue;
    validation::PoseCursor cursor(run.seen.times, run.seen.bodies[static_cast<std::size_t>(index)]);
    for (std::size_t k = 0; k < count; ++k) {
      // The mean of what is curved, too: two instants as far from the middle as those averaged are in the mean.
      const double middle = motion.times[k] - own.delay;
      poses[k] = cursor.at(middle - motion.spread, kGap);
      if (motion.spread > 0.0) poses[k] = midway(poses[k], cursor.at(middle + motion.spread, kGap));
    }
  }
  return simulated;
}

}  // namespace snug::identification::internal
