// SceneRun: bodies, springs and drops without a program.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "snug/cell/scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/runs/internal/program_run.hpp"

namespace snug::runs::internal {
namespace {

using cell::event_of;
using cell::find_failure;
using cell::Scene;
using cell::SolverMonitor;

constexpr double kRecordPeriod = 0.008;  ///< s

}  // namespace

RunResult run_scene(const model::Scenario& scenario, const RunOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  Scene scene(scenario, options.threads);
  const double until = options.until.value_or(scenario.duration);
  const double period = scenario.record_period.value_or(kRecordPeriod);
  const auto stride = static_cast<std::int64_t>(std::max(1.0, std::round(period / scenario.time_step)));
  const std::int64_t first = scene.state().step_index;
  const auto end = static_cast<std::int64_t>(std::ceil(until / scenario.time_step - 1e-9));
  if (first > 0 && first >= end) {
    throw InputError(scenario.source_name, "initial_state",
                     fmt::format("starts at {} s", scene.state().time(scene.world().model)),
                     fmt::format("before the end of the run, {} s: a longer duration, or --until", until));
  }
  std::unique_ptr<Recorder> recorder;
  if (is_recorded(options)) {
    RecorderSetup setup;
    setup.path = options.record_path;
    setup.file = options.record_file;
    setup.observer = options.observer;
    setup.period = static_cast<double>(stride) * scenario.time_step;
    setup.version = options.version;
    recorder = std::make_unique<Recorder>(scenario, scene.world(), setup);
  }
  SolverMonitor monitor(scenario.solver.contact_limits);
  RunResult result;
  bool is_stopped = false;  // by the observer
  for (std::int64_t i = first; i < end && !result.failure && !is_stopped; ++i) {
    const physics::StepReport report = scene.advance();
    monitor.add(report, scene.state().time(scene.world().model));
    if (report.status == physics::StepStatus::LostBody) {
      result.events.push_back(event_of(scene.lost().back()));
    } else {
      result.failure = find_failure(scene.world(), scene.state(), scene.work(), report);
    }
    for (record::Event& event : monitor.take_events(scene.world())) result.events.push_back(std::move(event));
    if (!recorder) continue;
    recorder->add_events(result.events);
    if ((i + 1) % stride != 0 && !result.failure) continue;
    is_stopped = !recorder->add_frame(scene.world(), scene.state(), scene.work(), report, FrameInput{});
  }
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  result.duration = scene.state().time(scene.world().model);
  result.wall = wall.count();
  result.real_time_factor = (result.duration - static_cast<double>(first) * scenario.time_step) / result.wall;
  result.lost = scene.lost();
  fill_contacts(scene.world(), scene.state(), monitor, result);
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

}  // namespace snug::runs::internal
