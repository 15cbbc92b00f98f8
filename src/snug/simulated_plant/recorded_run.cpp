// RecordedRun: a plant's course once more, call by call, written to a recording: what was sent is known by then.
#include "snug/simulated_plant/recorded_run.hpp"
#include "snug/motion/program_csv.hpp"

#include <algorithm>

namespace snug::simulated_plant {
namespace {

/// Frames and events in the order of time.
class Course {
 public:
  Course(SimulatedPlant& plant, const RecordedRunOptions& recorded, const runs::RecorderSetup& setup)
      : plant_(plant),
        said_(recorded.events),
        recorder_(plant.simulation().scenario(), plant.simulation().world(), setup) {
    plant_.watch([this](const cell::CellTick& tick) { add(tick); });
  }
  /// Rows of the motions before this one.
  void begin(int rows) { rows_ = rows; }
  void close(const std::string& result, bool is_interrupted) {
    add_events();
    recorder_.close(result, is_interrupted);
  }
  [[nodiscard]] const std::vector<record::Event>& events() const { return events_; }

 private:
  void add_events() {
    const auto& own = plant_.state().event_log.events();
    const double now = plant_.simulation().time(plant_.state());
    for (; own_ < own.size(); ++own_) events_.push_back(own[own_]);
    for (; next_ < said_.size() && said_[next_].time <= now; ++next_) events_.push_back(said_[next_]);
    recorder_.add_events(events_);
  }
  void add(const cell::CellTick& tick) {
    add_events();
    const runs::FrameInput input{tick.tool.X_WE,
                                 tick.tool.V_WE,
                                 tick.X_WE_reference,
                                 rows_ + tick.row,
                                 &plant_.state().gripper,
                                 tick.command,
                                 plant_.simulation().arm() != nullptr ? &plant_.work().arm : nullptr};
    (void)recorder_.add_frame(plant_.simulation().world(), plant_.state().world, plant_.work().physics, tick.step,
                              input);
  }

  SimulatedPlant& plant_;
  const std::vector<record::Event>& said_;
  runs::Recorder recorder_;
  std::vector<record::Event> events_;
  std::size_t own_ = 0, next_ = 0;
  int rows_ = 0;
};

motion::Program program_of(const std::vector<Call>& calls) {
  motion::Program program{"pack", {}};
  for (const Call& call : calls) {
    const auto& rows = call.motion.waypoints;
    program.waypoints.insert(program.waypoints.end(), rows.begin(), rows.end());
  }
  return program;
}

}  // namespace

void repeat(SimulatedPlant& plant, const std::vector<Call>& calls, const std::function<void(const Call&)>& before) {
  for (std::size_t i = 0; i < calls.size(); ++i) {
    const Call& call = calls[i];
    if (before) before(call);
    if (call.kind == Call::Kind::Bring && call.passed < 0) (void)plant.bring(call.item);
    if (call.kind == Call::Kind::Acknowledge) plant.acknowledge();
    if (call.kind != Call::Kind::Submit) continue;
    const auto bring = [&plant, &calls, i] {
      for (std::size_t k = i + 1; k < calls.size() && calls[k].kind == Call::Kind::Bring && calls[k].passed >= 0; ++k) {
        (void)plant.bring(calls[k].item);
      }
    };
    (void)(call.passed < 0 ? plant.submit(call.motion) : plant.submit(call.motion, {call.passed, bring}));
  }
}

runs::RunResult record(const model::Scenario& scenario, const std::string& sequence,
                       const SimulatedPlantOptions& options, const std::vector<Call>& calls,
                       const RecordedRunOptions& recorded) {
  SimulatedPlant plant(scenario, sequence, options);
  runs::RecorderSetup setup;
  setup.file = recorded.file;
  setup.period = scenario.controller.tick;
  setup.program_name = "pack";
  motion::Program program = program_of(calls);
  program.tracking = options.simulation.tracking;
  setup.program_text = motion::format_program(program);
  setup.sequence = sequence;
  setup.settings_json = recorded.settings_json;
  setup.version = recorded.version;
  if (const cell::CellArm* arm = plant.simulation().arm()) {
    for (const robot::Joint& joint : arm->model().joints) setup.joints.push_back(joint.name);
  }
  Course course(plant, recorded, setup);
  int rows = 0;
  repeat(plant, calls, [&](const Call& call) {
    course.begin(rows);
    rows += static_cast<int>(call.motion.waypoints.size());
  });
  runs::RunResult result;
  result.duration = plant.simulation().time(plant.state());
  result.boxes = plant.boxes();
  std::vector<std::string> packed;
  for (const cell::BoxResult& box : result.boxes) {
    if (box.state == cell::BoxState::Packed) packed.push_back(box.id);
  }
  if (const model::Container* container = model::find_container(scenario, scenario.target)) {
    result.filling_degree_percent = model::compute_filling_degree_percent(scenario, *container, packed);
  }
  result.events = course.events();
  result.repicks = plant.state().event_log.repicks();
  result.solver = plant.work().solver.summary(plant.simulation().world());
  result.lost = plant.work().lost;
  result.warnings = recorded.warnings;
  result.is_interrupted = recorded.is_interrupted;
  result.state_hash = plant.simulation().hash(plant.state());
  course.close(recorded.describe ? recorded.describe(result) : "", recorded.is_interrupted);
  return result;
}

}  // namespace snug::simulated_plant
