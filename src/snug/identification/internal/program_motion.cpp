// ProgramRun: the boxes of a program's run, as its frames have them.
#include "snug/identification/internal/program_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/tracking.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/record/archive.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/run.hpp"
#include "snug/validation/simulated_run.hpp"

namespace snug::identification::internal {
namespace {

constexpr double kTail = 0.1;  // s, of simulation after what is compared

runs::RunResult run_observed(const model::Scenario& scenario, const model::TaskProgram& program,
                             std::optional<double> until, runs::RunObserver& observer) {
  runs::RunOptions options;
  options.program = motion::load_program(program.file);
  options.simulation.tracking =
      motion::choose_tracking(program.controller, program.tempo, options.program->tracking, program.file.string());
  if (program.robot) {
    if (*program.robot != "none") options.simulation.robot = *program.robot;
  } else if (scenario.robot && scenario.robot->name == options.program->robot) {
    options.simulation.robot = options.program->robot;
  }
  options.sequence = program.sequence;
  options.corrections = program.corrections;
  options.until = until;
  options.observer = &observer;
  if (program.with_phases) options.simulation.cup = *program.with_phases ? cup::CupMode::Phases : cup::CupMode::Holding;
  return runs::run(scenario, options);
}

/// Keeps of a run where its tracked bodies are.
class PoseCapture final : public runs::RunObserver {
 public:
  explicit PoseCapture(const model::SceneTask& task) : task_(task), tracks(task.tracked.size()) {}
  void begin(const record::RecordingHeader& header) override {
    for (const model::RecordedObject& object : task_.tracked) bodies_.push_back(record::find_body(header, object.body));
  }
  bool add(const record::Frame& frame) override {
    end = frame.time;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (bodies_[b] < 0) continue;
      const record::BodySample& body = frame.bodies[static_cast<std::size_t>(bodies_[b])];
      tracks[b].add(frame.time, body.present ? body.X_WB : record::lost_pose());
    }
    return true;
  }
  void add(const record::Event& /*event*/) override {}

 private:
  const model::SceneTask& task_;
  std::vector<int> bodies_;  ///< of the header

 public:
  std::vector<Track> tracks;
  double end = -1.0;  ///< s, of the last frame
};

/// Where the item stands, in the simulation, that was seen to stand there: where the scenario says, unless it was seen
/// further from there than motion capture errs; its height and tilt are the support's.
Pose arrival_pose(const cell::Simulation& simulation, std::size_t item, const Pose& X_WP_seen) {
  constexpr double kPlace = 1.5e-3, kTurn = 0.012;  // m, rad: five times what a frame of markers is set to
  Pose nearest;
  double least = std::numeric_limits<double>::infinity();
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Pose X_WP = cell::pose_at_aligner(simulation.scenario(), simulation.sequence().items[item], quarter);
    const double angle = log_rotation(X_WP.R.transpose() * X_WP_seen.R).norm();
    if (angle >= least) continue;
    least = angle;
    nearest = X_WP;
  }
  const Vector3 shift = X_WP_seen.p - nearest.p;
  if (shift.norm() <= kPlace && least <= kTurn) return nearest;
  const double yaw = log_rotation(X_WP_seen.R * nearest.R.transpose()).z();
  return {exp_rotation(Vector3(0.0, 0.0, yaw)) * nearest.R, nearest.p + Vector3(shift.x(), shift.y(), 0.0)};
}

/// The tool on the recorded path, from its first tick on.
ProgramRun run_led(const model::Scenario& scenario, const model::SceneTask& task, const RecordedDrive& drive,
                   double until) {
  cell::SimulationOptions options;
  options.cup = runs::cup_for(scenario, task.program->corrections);
  if (task.program->with_phases)
    options.cup = *task.program->with_phases ? cup::CupMode::Phases : cup::CupMode::Holding;
  const cell::Simulation simulation(scenario, task.program->sequence, options);
  cell::CellState state = simulation.take_up({{}, drive.tool.front().X_WE, {}});
  cell::CellWorkspace work = simulation.make_workspace();
  std::vector<int> items;  // of the tracked bodies
  const auto item_of = [&](const std::string& parcel) {
    const auto& all = simulation.sequence().items;
    const auto found = std::ranges::find(all, parcel, &model::Item::parcel);
    return found == all.end() ? -1 : static_cast<int>(found - all.begin());
  };
  ProgramRun run;
  for (const model::RecordedObject& object : task.tracked) items.push_back(item_of(object.body));
  run.tracks.resize(items.size());
  run.until = until;
  std::size_t arrived = 0;
  for (std::size_t k = 1; k < drive.tool.size() && simulation.time(state) < until; ++k) {
    for (; arrived < drive.arrivals.size() && drive.arrivals[arrived].time <= simulation.time(state); ++arrived) {
      const RecordedDrive::Arrival& arrival = drive.arrivals[arrived];
      const int item = item_of(arrival.parcel);
      if (item < 0) continue;
      (void)simulation.feed(item, arrival_pose(simulation, static_cast<std::size_t>(item), arrival.X_WP), state);
    }
    const cell::CellTick tick =
        simulation.advance(cell::ToolCommand{drive.tool[k], {drive.vacuum[k], drive.blow_off[k]}}, state, work);
    run.end = simulation.time(state);
    for (std::size_t b = 0; b < items.size(); ++b) {
      if (items[b] < 0) continue;
      const physics::BodyId body = simulation.world().parcels[static_cast<std::size_t>(items[b])];
      const bool is_there = state.world.bodies[static_cast<std::size_t>(body.index)].is_present;
      run.tracks[b].add(run.end, is_there
                                     ? record::PoseSample(physics::pose_of(simulation.world().model, state.world, body))
                                     : record::lost_pose());
    }
    if (!tick.failure) continue;
    if (k == 1) run.failure = tick.failure.text;
    return run;
  }
  run.end = std::numeric_limits<double>::infinity();
  return run;
}

record::PoseSample midway(const record::PoseSample& a, const record::PoseSample& b) {
  if (!record::is_tracked(a) || !record::is_tracked(b)) return record::lost_pose();
  const Matrix3 R = a.pose().R;
  return Pose{R * exp_rotation(0.5 * log_rotation(R.transpose() * b.pose().R)), 0.5 * (a.p + b.p)};
}

bool is_same(const record::PoseSample& a, const record::PoseSample& b) {
  return a == b || (!record::is_tracked(a) && !record::is_tracked(b));
}

}  // namespace

CapturedRun capture_program(const model::Scenario& scenario, const model::TaskProgram& program,
                            std::optional<double> until) {
  runs::RunCapture capture;
  const runs::RunResult result = run_observed(scenario, program, until, capture);
  return {std::move(capture.recording), result.failure.text};
}

void Track::add(double time, const record::PoseSample& pose) {
  const std::size_t count = poses.size();
  if (count >= 2 && is_same(poses[count - 1], pose) && is_same(poses[count - 2], pose)) {
    times.back() = time;
    return;
  }
  times.push_back(time);
  poses.push_back(pose);
}

ProgramRun run_program(const model::Scenario& scenario, const model::SceneTask& task, const RecordedDrive* drive,
                       double until) {
  if (drive != nullptr) return run_led(scenario, task, *drive, until);
  PoseCapture capture(task);
  const runs::RunResult result = run_observed(scenario, *task.program, until, capture);
  ProgramRun run;
  run.tracks = std::move(capture.tracks);
  run.until = until;
  run.end = result.failure ? capture.end : std::numeric_limits<double>::infinity();
  if (capture.end <= 0.0) run.failure = result.failure ? result.failure.text : "the run ended before its first frame";
  return run;
}

double end_of(const model::SceneTask& task, const RecordedMotion& motion, const OwnValues& own, double until) {
  const double end = std::min(motion.times[sample_count(task, motion) - 1], until);
  return end - own.late_at(end) + kTail;
}

SimulatedMotion motion_of(const ProgramRun& run, const RecordedMotion& motion, const ComparedSamples& samples,
                          const OwnValues& own) {
  SimulatedMotion simulated;
  simulated.failure = run.failure;
  simulated.end = std::isfinite(run.end) ? run.end + own.late_at(run.end) : run.end;
  if (!run.failure.empty()) return simulated;
  for (std::size_t b = 0; b < motion.tracked.size(); ++b) {
    std::vector<record::PoseSample>& poses = simulated.bodies.emplace_back(motion.times.size(), record::lost_pose());
    const Track& track = run.tracks[b];
    validation::PoseCursor cursor(track.times, track.poses);
    const auto at = [&](double time) { return cursor.at(time, std::numeric_limits<double>::infinity()); };
    for (const std::size_t k : samples[b]) {
      // The mean of what is curved, too: two instants as far from the middle as those averaged are in the mean.
      const double count = averaged_at(motion.tracked[b], k);
      const double spread = motion.period * std::sqrt((count * count - 1.0) / 12.0);
      const double middle = motion.times[k] - own.late_at(motion.times[k]);
      poses[k] = at(middle - spread);
      if (spread > 0.0) poses[k] = midway(poses[k], at(middle + spread));
    }
  }
  return simulated;
}

}  // namespace snug::identification::internal
