// SceneRun: bodies, springs and drops without a program.
#include <algorithm>
#include <chrono>
#include <memory>

#include "snug/cell/internal/program_run.hpp"
#include "snug/cell/scene.hpp"

namespace snug::cell::internal {
namespace {

constexpr double kRecordPeriod = 0.008;  ///< s

}  // namespace

RunResult run_scene(const model::Scenario& scenario, const RunOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  Scene scene(scenario);
  const double until = options.until.value_or(scenario.duration);
  std::unique_ptr<Recorder> recorder;
  if (is_recorded(options)) {
    RecorderSetup setup;
    setup.path = options.record_path;
    setup.file = options.record_file;
    setup.observer = options.observer;
    setup.period = std::max(kRecordPeriod, scenario.time_step);
    setup.version = options.version;
    recorder = std::make_unique<Recorder>(scenario, scene.world(), setup);
  }
  const auto stride = static_cast<std::int64_t>(std::max(1.0, std::round(kRecordPeriod / scenario.time_step)));
  const auto steps = static_cast<std::int64_t>(std::ceil(until / scenario.time_step - 1e-9));
  SolverMonitor monitor;
  RunResult result;
  bool is_stopped = false;  // by the observer
  for (std::int64_t i = 0; i < steps && result.failure.empty() && !is_stopped; ++i) {
    const physics::StepReport report = scene.advance();
    monitor.add(report);
    result.failure = describe_failure(scene.world(), scene.state(), scene.work(), report);
    if (recorder && (i + 1) % stride == 0) {
      is_stopped = !recorder->add_frame(scene.world(), scene.state(), scene.work(), report, FrameInput{});
    }
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  result.duration = scene.state().time(scene.world().model);
  result.wall = wall.count();
  result.real_time_factor = result.duration / result.wall;
  result.solver = monitor.summary();
  result.state_hash = physics::hash_of(scene.state());
  for (std::size_t i = 0; i < scene.world().model.bodies.size(); ++i) {
    const physics::BodyModel& body = scene.world().model.bodies[i];
    if (body.kind != physics::BodyKind::Dynamic || !scene.state().bodies[i].is_present) continue;
    result.bodies.push_back({body.name,
                             physics::pose_of(scene.world().model, scene.state(), physics::BodyId{static_cast<int>(i)}),
                             scene.state().bodies[i].velocity.norm()});
  }
  result.is_interrupted = is_stopped;
  if (recorder) recorder->close(options.describe ? options.describe(result) : "", result.is_interrupted);
  return result;
}

}  // namespace snug::cell::internal
