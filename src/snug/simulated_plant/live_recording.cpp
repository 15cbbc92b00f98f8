// LiveRecording: the recording of a simulated plant, written while it is packed.
#include "snug/simulated_plant/live_recording.hpp"

#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/program_tracking.hpp"
#include "snug/simulated_plant/simulated_plant.hpp"

namespace snug::simulated_plant {
namespace {

runs::RecorderSetup setup_of(const SimulatedPlant& plant, const LiveRecordingOptions& options) {
  runs::RecorderSetup setup;
  setup.file = options.file;
  setup.observer = options.observer;
  setup.period = plant.simulation().scenario().controller.tick;
  setup.program_name = "pack";
  setup.program_grows = true;
  setup.sequence = plant.simulation().sequence().name;
  setup.settings_json = options.settings_json;
  setup.version = options.version;
  if (const cell::CellArm* arm = plant.simulation().arm()) {
    for (const robot::Joint& joint : arm->model().joints) setup.joints.push_back(joint.name);
  }
  return setup;
}

}  // namespace

LiveRecording::LiveRecording(SimulatedPlant& plant, const model::Scenario& scenario,
                             const LiveRecordingOptions& options)
    : plant_(plant),
      scenario_(scenario),
      recorder_(plant.simulation().scenario(), plant.simulation().world(), setup_of(plant, options)) {
  recorder_.append_program(motion::format_tracking(plant.simulation().options().tracking));
  plant_.record_to(this);
}

LiveRecording::~LiveRecording() { plant_.record_to(nullptr); }

void LiveRecording::begin_motion(const std::vector<motion::Waypoint>& waypoints) {
  waypoint_count_ = next_count_;
  is_written_ = false;
  try {
    recorder_.append_program(motion::format_program({"motion", waypoints}));
  } catch (const InputError&) {  // a motion that no file can keep: its frames belong to no waypoint
    return;
  }
  is_written_ = true;
  next_count_ += static_cast<int>(waypoints.size());
}

void LiveRecording::note(record::Event event) {
  add_events();
  events_.push_back(std::move(event));
}

void LiveRecording::add_events() {
  const auto& own = plant_.state().event_log.events();
  for (; own_ < own.size(); ++own_) events_.push_back(own[own_]);
  recorder_.add_events(events_);
}

void LiveRecording::add_tick() {
  add_events();
  const cell::CellTick& tick = *plant_.last_tick();
  const runs::FrameInput input{tick.tool.X_WE,
                               tick.tool.V_WE,
                               tick.X_WE_reference,
                               is_written_ ? waypoint_count_ + tick.row : -1,
                               &plant_.state().gripper,
                               tick.command,
                               plant_.simulation().arm() != nullptr ? &plant_.work().arm : nullptr};
  (void)recorder_.add_frame(plant_.simulation().world(), plant_.state().world, plant_.work().physics, tick.step, input);
}

runs::RunResult LiveRecording::close(const RecordingEnd& end) {
  const cell::Simulation& simulation = plant_.simulation();
  add_events();
  runs::RunResult result;
  result.duration = simulation.time(plant_.state());
  result.boxes = plant_.boxes();
  std::vector<std::string> packed;
  for (const cell::BoxResult& box : result.boxes) {
    if (box.state == cell::BoxState::Packed) packed.push_back(box.id);
  }
  if (const model::Container* container = model::find_container(scenario_, scenario_.target)) {
    result.filling_degree_percent = model::compute_filling_degree_percent(scenario_, *container, packed);
  }
  result.events = events_;
  result.repicks = plant_.state().event_log.repicks();
  result.solver = plant_.work().solver.summary(simulation.world());
  result.lost = plant_.work().lost;
  result.warnings = end.warnings;
  result.is_interrupted = end.is_interrupted;
  result.ended_by = end.ended_by;
  result.state_hash = simulation.hash(plant_.state());
  recorder_.close(end.describe ? end.describe(result) : "", end.is_interrupted);
  return result;
}

}  // namespace snug::simulated_plant
