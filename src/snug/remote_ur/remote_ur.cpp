// RemoteUr: a controller of Universal Robots and the cell around it, behind the interface of a plant.
#include "snug/remote_ur/remote_ur.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/remote_ur/follow_script.hpp"
#include "snug/remote_ur/internal/signals.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::remote_ur {
namespace {

using internal::is_on;
using internal::kLongestBraking;

constexpr double kStartPatience = 5.0;    // s, until a program that was sent runs
constexpr double kUnlockPatience = 30.0;  // s: robots take 5 s of theirs before they let a stop be released
constexpr double kUnlockEach = 1.0;       // s, between attempts

control::JointMotion at_rest(const ur::Values6& q) {
  const robot::JointVector zero = robot::JointVector::Zero(6);
  return {served_ur::to_vector(q), zero, zero};
}

}  // namespace

model::Scenario with_speed_to_follow(model::Scenario scenario) {
  if (scenario.robot) scenario.robot->velocity_fraction = std::min(scenario.robot->velocity_fraction, 0.5);
  return scenario;
}

RemoteUr::RemoteUr(const model::Scenario& scenario, const std::string& sequence, RemoteUrOptions options)
    : options_(std::move(options)),
      scenario_(cell::with_fixed_arrivals(scenario, sequence)),
      sequence_(cell::require_sequence(scenario_, sequence)),
      io_(model::robot_io(scenario_)),
      model_(robot::load_arm(scenario_)),
      ur_arm_(model_, scenario_),
      period_(options_.link->period()),
      was_brought_(sequence_.items.size(), false),
      runner_(plant::runner_settings(scenario_, !motion::is_fast(options_.motions.tracking))) {
  if (!options_.is_dry && !io_.vacuum_gauge && !io_.vacuum_reached) {
    throw InputError(scenario_.source_name, "robot.io", "no vacuum_gauge and no vacuum_reached",
                     "one of them: a motion needs to know whether the cup holds a box");
  }
  cell::limit_joint_speeds(scenario_, options_.motions.tracking);
  arm_ = std::make_unique<cell::CellArm>(scenario_,
                                         sequence_.task_stiffness.value_or(scenario_.controller.task_stiffness));
  if (motion::is_fast(options_.motions.tracking)) {
    pace_ = cell::make_joint_pace(scenario_, motion::tempo_of(options_.motions.tracking));
  }
  std::fill_n(was_brought_.begin(),
              std::min(static_cast<std::size_t>(std::max(0, options_.brought)), was_brought_.size()), true);
  set_load(ur_arm_.tool_load().mass, ur_arm_.tool_load().com);
  tick();
  state_ = arm_->make_state(scenario_.seed, served_ur::to_vector(q_));
  number_ = static_cast<std::int32_t>(std::fmod(std::max(0.0, sample_.timestamp) * 1000.0, 1e6));
  wish_ = Wish::Start;
  const bool runs = wait_until(kStartPatience, [this] { return is_ready() || !failure_.empty(); }) && is_ready();
  if (!runs) {
    std::string why = failure_.empty() ? options_.link->why_not() : failure_;
    if (why.empty()) why = why_stopped();
    throw InputError("command line", "--plant", options_.link->name() + ", where the program does not start: " + why,
                     "a robot in remote control with power on, brakes released and no stop");
  }
  switches_.vacuum = is_on(io_.vacuum, sample_.digital_outputs);
  in_the_cell_.insert(options_.to_do.begin(), options_.to_do.end());
  part_is_new_ = !options_.boxes;  // else it is told which it is
  stand();
  feedback_ = told_ = sensors();
  if (options_.is_in_time) thread_ = std::thread([this] { run_in_time(); });
}

RemoteUr::~RemoteUr() {
  (void)finish();
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
  }
  if (thread_.joinable()) thread_.join();
}

plant::Description RemoteUr::describe() const {
  plant::Description description{options_.link->name(), {}, options_.is_in_time ? 0.1 : 0.0};
  for (const robot::Joint& joint : model_.joints) description.joints.push_back(joint.name);
  return description;
}

// --- motions

plant::Motion RemoteUr::as_sent(const plant::Motion& motion) const {
  plant::Motion sent = motion;
  if (!options_.is_dry) return sent;
  sent.guards.vacuum = false;
  sent.guards.hold_factor = 0.0;
  for (motion::Waypoint& waypoint : sent.waypoints) {
    waypoint.X_WE.p.z() += kDryHeight;
    waypoint.io = {};
  }
  return sent;
}

void RemoteUr::start(const plant::Motion& motion) {
  const plant::Motion sent = as_sent(motion);
  std::string refusal = plant::MotionRunner::find_refusal(sent);
  motion::PreparedProgram plan;
  if (refusal.empty()) {
    try {
      plan = cell::prepare(scenario_, sequence_, options_.motions, {"motion", sent.waypoints});
      plan.path_limits = pace_.get();
    } catch (const InputError& error) {
      refusal = error.what();
    }
  }
  const std::lock_guard lock(mutex_);
  SNUG_CHECK(!is_moving_, "a motion is under way");
  is_moving_ = true;
  if (is_stopped_ && is_stop_told_) refusal = "a protective stop is not acknowledged";
  if (!failure_.empty()) refusal = "the plant has failed: " + failure_;
  if (!refusal.empty()) {
    feedback_ = sensors();
    runner_.refuse(std::move(refusal), feedback_);
    return push_result();
  }
  plan_ = std::move(plan);
  stand();
  runner_.begin(sent, reading(), is_holding());
  if (is_holding() && command_.payload == ur_arm_.tool_load().mass) load_item();  // it hung there before
  row_ = -1;
  is_waiting_ = is_stuck_ = is_braking_ = false;
  if (!is_stopped_) return;
  runner_.stop(plant::EndReason::ProtectiveStop, 0.0, 0.0, stop_reason_);
  end_motion();
  push_result();
}

/// The controller begins anew where the robot was told to stand.
void RemoteUr::stand() {
  from_ = to_ = at_rest(q_);
  phase_ = 1.0;
  qd_ = {};
  state_.machine.joints.q = from_.q;
  arm_->stand(state_);
  state_.machine.tool = control::tool_at(model_, from_);
  motion::ControllerState program = motion::make_controller_state(state_.machine.tool.X_WE);
  program.command = state_.machine.tool;
  program.io = switches_;
  program.tick_count = program_.tick_count;
  program.sensed = program_.sensed;
  program_ = program;
}

void RemoteUr::end_motion() {
  if (runner_.end().reason == plant::EndReason::ProtectiveStop) {
    is_stop_told_ = true;
    runner_.add({time(), plant::FaultRaised{plant::EndReason::ProtectiveStop, runner_.end().where}});
  }
  if (is_stopped_) q_ = sample_.target_q;
  stand();
  if (!failure_.empty()) runner_.stop(plant::EndReason::Fault, 0.0, 0.0, failure_);
  runner_.rest(time());
  is_braking_ = true;  // it stands
  feedback_ = sensors();
  is_braking_ = false;
  runner_.finish(feedback_);
}

void RemoteUr::fail(std::string why) {
  if (!failure_.empty()) return;
  failure_ = std::move(why);
  awaited_.clear();
  feedback_.end = {plant::EndReason::Fault, std::nullopt, 0.0, 0.0, failure_};
  runner_.add({time(), plant::FaultRaised{plant::EndReason::Fault, failure_}});
}

void RemoteUr::cancel_motion() {
  if (!runner_.is_moving() || runner_.has_ended()) return;
  runner_.stop(plant::EndReason::Cancelled);
  begin_braking();
}

void RemoteUr::cancel() {
  const std::lock_guard lock(mutex_);
  cancel_motion();
}

// --- for who calls

plant::Feedback RemoteUr::read() { return told_; }

std::vector<plant::Event> RemoteUr::advance() {
  std::unique_lock lock(mutex_);
  if (results_.empty()) {
    if (options_.is_interrupted && options_.is_interrupted()) {
      cancel_motion();
      if (!awaited_.empty()) {
        awaited_.clear();
        runner_.add({time(), plant::FaultRaised{plant::EndReason::Cancelled, "interrupted while waiting for a box"}});
        push_result();
      }
    }
    if (!is_moving_ && awaited_.empty()) return {};
    if (!failure_.empty() && runner_.is_moving()) {
      end_motion();
      push_result();
    } else if (thread_.joinable()) {
      news_.wait_for(lock, std::chrono::milliseconds(100), [this] { return !results_.empty(); });
    } else {
      lock.unlock();
      do {
        tick();
      } while (results_.empty() && !is_moving_);  // a box takes its time
      lock.lock();
    }
  }
  if (results_.empty()) return {};
  Result result = std::move(results_.front());
  results_.pop_front();
  told_ = std::move(result.feedback);
  for (const plant::Event& event : result.events) {
    if (plant::get<plant::MotionEnded>(event) != nullptr) is_moving_ = false;
  }
  return std::move(result.events);
}

bool RemoteUr::bring(const model::ParcelId& item) {
  const auto found = std::ranges::find(sequence_.items, item.value, &model::Item::parcel);
  const auto index = static_cast<std::size_t>(found - sequence_.items.begin());
  std::vector<perception::SceneBox> boxes;
  if (options_.boxes) (void)options_.boxes(boxes);  // without an answer the sensor tells
  const std::lock_guard lock(mutex_);
  if (std::ranges::find(boxes, item.value, &perception::SceneBox::item) != boxes.end()) in_the_cell_.insert(item.value);
  if (!failure_.empty()) told_.end = {plant::EndReason::Fault, std::nullopt, 0.0, 0.0, failure_};  // that is why
  if (found == sequence_.items.end() || was_brought_[index] || !failure_.empty()) return false;
  was_brought_[index] = true;
  awaited_.push_back(item);
  look_for_part();
  if (!awaited_.empty()) ask_for_part();
  if (runner_.has_events()) push_result();
  return true;
}

void RemoteUr::perceive(std::span<const perception::Expectation> expected) {
  perception::Scene scene;
  std::string failure;
  {
    const std::lock_guard lock(mutex_);
    scene.time = time();
    scene.X_WE = current().X_WE;
    failure = failure_;
  }
  std::vector<perception::SceneBox> boxes;
  if (failure.empty() && options_.boxes) failure = options_.boxes(boxes);
  for (perception::SceneBox& box : boxes) {
    const auto item = std::ranges::find(sequence_.items, box.item, &model::Item::parcel);
    if (item == sequence_.items.end()) continue;
    const bool was_brought = was_brought_[static_cast<std::size_t>(item - sequence_.items.begin())];
    if (!was_brought && std::ranges::find(options_.to_do, box.item) == options_.to_do.end()) continue;
    scene.boxes.push_back(std::move(box));
  }
  perception::Observation observation = options_.perception->perceive(scene, expected);
  const std::lock_guard lock(mutex_);
  if (!failure.empty()) {
    fail(failure);
    observation.missing.clear();  // nothing was looked at
  }
  for (const perception::PoseEstimate& one : observation.seen) {
    std::erase_if(seen_boxes_, [&](const auto& seen) { return seen.first == one.item; });
    seen_boxes_.emplace_back(one.item, one.X_WP);
  }
  observation.time = time();
  runner_.add({observation.time, plant::Perceived{std::move(observation)}});
  push_result();
}

void RemoteUr::acknowledge() {
  {
    const std::lock_guard lock(mutex_);
    if (!is_stopped_ || !failure_.empty()) return;
  }
  const auto is_released = [this] { return sample_.safety_mode == 1 || sample_.safety_mode == 2; };
  for (double waited = 0.0; waited < kUnlockPatience; waited += kUnlockEach) {
    {
      const std::lock_guard lock(mutex_);
      if (is_released()) break;
      wish_ = Wish::Unlock;
    }
    if (wait_until(kUnlockEach, [&] { return is_released() || !failure_.empty(); })) break;
  }
  {
    const std::lock_guard lock(mutex_);
    wish_ = Wish::Start;
    has_started_ = false;
  }
  (void)wait_until(kStartPatience, [this] { return is_ready() || !failure_.empty(); });
  const std::lock_guard lock(mutex_);
  if (!is_ready()) return fail("the robot cannot continue after its stop: " + why_stopped());
  is_stopped_ = false;
  stand();
}

Vector3 RemoteUr::size_of(std::size_t item) const {
  return model::collision_size(scenario_, *model::find_parcel(scenario_, sequence_.items[item].parcel));
}

std::vector<std::optional<perception::SceneBox>> RemoteUr::perceived() {
  const std::lock_guard lock(mutex_);
  std::vector<std::optional<perception::SceneBox>> boxes(sequence_.items.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const auto seen = std::ranges::find(seen_boxes_, sequence_.items[i].parcel, &std::pair<std::string, Pose>::first);
    if (seen != seen_boxes_.end()) boxes[i] = perception::SceneBox{seen->first, seen->second, size_of(i)};
  }
  return boxes;
}

int RemoteUr::late_periods() {
  const std::lock_guard lock(mutex_);
  return late_before_ + sample_.late;
}

std::string RemoteUr::finish() {
  {
    const std::lock_guard lock(mutex_);
    if (ends_ || !failure_.empty()) return failure_;
    if (runner_.is_moving()) cancel_motion();
  }
  (void)wait_until(kLongestBraking + 1.0, [this] { return !runner_.is_moving() || !failure_.empty(); });
  {
    const std::lock_guard lock(mutex_);
    if (is_stopped_) return failure_;
    ends_ = true;
  }
  constexpr double kEndPatience = 2.0;  // s
  (void)wait_until(kEndPatience,
                   [this] { return sample_.script == script_word(number_, ScriptState::Ended) || !failure_.empty(); });
  const std::lock_guard lock(mutex_);
  return failure_;
}

}  // namespace snug::remote_ur
