// try_motion: a prepared program done in a cell with contact.
#include "snug/runs/program_trial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "snug/cell/aligner_feed.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::runs {
namespace {

using cell::BoxResult;
using cell::BoxState;
using cell::CellState;
using cell::CellTick;
using cell::CellWorkspace;
using cell::FailureKind;
using cell::find_item;
using cell::Simulation;

/// Of the states of the machine that every arm of a cell has.
const control::StateMachine& machine_names() {
  static const control::StateMachine machine = control::make_demonstrator_machine();
  return machine;
}

/// Follows the vacuum tick by tick, to tell where it comes on and no box is ever held by it.
class SealWatch {
 public:
  void look(const motion::PreparedProgram& plan, const CellState& state, int row, MotionTrial& trial) {
    const bool is_on = state.controller.io.vacuum;
    if (is_on && !is_on_) {
      const motion::Waypoint& waypoint = plan.program.waypoints[static_cast<std::size_t>(std::max(0, row))];
      has_held_ = false;
      waypoint_ = motion::name_of(waypoint);
      first_event_ = events_before_;
    }
    if (is_on_ && !is_on) end(state, trial);
    is_on_ = is_on;
    has_held_ |= state.gripper.cup.body >= 0;
    events_before_ = state.event_log.events().size();
  }

  /// Of a vacuum that is on still, too.
  void end(const CellState& state, MotionTrial& trial) {
    if (is_on_ && !has_held_) trial.missed_seals.push_back(reason_in(state.event_log.events()));
    is_on_ = false;
  }

 private:
  [[nodiscard]] std::string reason_in(const std::vector<record::Event>& events) const {
    for (std::size_t i = first_event_; i < events.size(); ++i) {
      if (events[i].kind == "no seal") return events[i].text;
    }
    return waypoint_;
  }

  bool is_on_ = false;
  bool has_held_ = false;
  std::string waypoint_;
  std::size_t events_before_ = 0;  ///< of the log, before the tick
  std::size_t first_event_ = 0;    ///< since the vacuum came on
};

/// Boxes that rows pick and that wait.
std::vector<std::string> find_left_waiting(const model::Sequence& sequence, const motion::Program& program,
                                           const std::vector<BoxResult>& boxes) {
  std::vector<std::string> left;
  for (const BoxResult& box : boxes) {
    const bool is_picked = std::ranges::any_of(program.waypoints, [&](const motion::Waypoint& waypoint) {
      const int item = waypoint.motion_class == motion::MotionClass::Pick ? find_item(sequence, waypoint) : -1;
      return item >= 0 && sequence.items[static_cast<std::size_t>(item)].parcel == box.id;
    });
    if (box.state == BoxState::Waiting && is_picked) left.push_back(box.id);
  }
  return left;
}

void append(std::string& list, const std::string& entry) { list += (list.empty() ? "" : "; ") + entry; }

/// One tick, kept in the trial until the program has ended and the joints rest.
CellTick advance(const Simulation& simulation, const motion::PreparedProgram& plan, CellState& state,
                 CellWorkspace& work, MotionTrial& trial) {
  control::JointSample sample;
  sample.time = simulation.time(state);
  if (state.arm) {
    sample.before = state.arm->machine.joints;
    sample.tool = state.arm->machine.tool;
  }
  CellTick tick = simulation.advance(plan, state, work);
  trial.failure = tick.failure;
  if (!state.arm) return tick;
  auto& samples = trial.joints.samples;
  if (trial.joints.is_complete && samples.back().after.qd.norm() <= control::kAlmostAtRest) return tick;
  sample.after = state.arm->machine.joints;
  sample.io = state.controller.io;
  sample.row = tick.row;
  sample.state = machine_names().name_of(state.arm->machine.state);
  samples.push_back(std::move(sample));
  return tick;
}

}  // namespace

MotionTrial try_motion(const Simulation& simulation, const motion::PreparedProgram& plan) {
  MotionTrial trial;
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  SealWatch seals;
  bool has_ended = false;
  while (!has_ended && !trial.failure) {
    const CellTick tick = advance(simulation, plan, state, work, trial);
    has_ended = tick.has_ended;
    seals.look(plan, state, tick.row, trial);
    if (simulation.time(state) > motion::kLongestProgram)
      trial.failure = {FailureKind::TooLong, "the program did not end within two hours"};
  }
  trial.joints.is_complete = has_ended && !trial.failure;
  trial.duration = simulation.time(state);
  while (!trial.failure && simulation.time(state) < trial.duration + motion::kSettleTime) {
    (void)advance(simulation, plan, state, work, trial);
  }
  if (simulation.arm() != nullptr) {
    control::bring_to_rest(simulation.arm()->controller(), plan.settings.tick, trial.joints);
  }
  seals.end(state, trial);
  trial.boxes = simulation.boxes(state);
  trial.left_waiting = find_left_waiting(simulation.sequence(), plan.program, trial.boxes);
  return trial;
}

std::string compare_trials(const MotionTrial& wanted, const MotionTrial& trial) {
  if (trial.failure) return trial.failure.text;
  std::string worse;
  for (std::size_t i = 0; i < trial.boxes.size() && i < wanted.boxes.size(); ++i) {
    if (wanted.boxes[i].state != BoxState::Packed || trial.boxes[i].state == BoxState::Packed) continue;
    append(worse, fmt::format("{} is {}, not packed", trial.boxes[i].id, name_of(trial.boxes[i].state)));
  }
  return worse;
}

std::string find_loss(const MotionTrial& trial) {
  if (trial.failure) return trial.failure.text;
  std::string lost;
  for (const std::string& missed : trial.missed_seals) append(lost, "no seal toward " + missed);
  for (const BoxResult& box : trial.boxes) {
    const bool may_wait = std::ranges::find(trial.left_waiting, box.id) == trial.left_waiting.end();
    if (box.state == BoxState::Packed || (box.state == BoxState::Waiting && may_wait)) continue;
    append(lost, fmt::format("{} is {}, not packed", box.id, name_of(box.state)));
  }
  return lost;
}

}  // namespace snug::runs
