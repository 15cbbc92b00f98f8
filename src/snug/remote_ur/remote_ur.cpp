// RemoteUr: a controller of Universal Robots and the cell around it, behind the interface of a plant.
#include "snug/remote_ur/remote_ur.hpp"

#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/phases.hpp"
#include "snug/remote_ur/follow_script.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/ur/primary_reader.hpp"

namespace snug::remote_ur {
namespace {

constexpr double kStartPatience = 5.0;    // s, until a program that was sent runs
constexpr double kUnlockPatience = 15.0;  // s: robots take 5 s before they let a stop be released
constexpr double kUnlockEach = 1.0;       // s, between attempts
// rad/s^2, of the fastest joint, where a motion is stopped: as the maker's client library brakes.
constexpr double kStopDeceleration = 40.0;
constexpr double kLongestBraking = 1.0;  // s, then the robot counts as standing
constexpr double kStillJoint = 0.01;     // rad/s
constexpr double kFollowed = 2e-3;       // rad, between a joint and its target: the robot has come there
constexpr double kAskingGap = 0.05;      // s, for which the output is off before
constexpr double kAskingTime = 0.2;      // s, for which the next box is asked for
constexpr double kAskAgain = 5.0;        // s
constexpr double kSamePhase = 1e-9;
constexpr int kPriority = 10;  // of real-time threads

double largest_of(const ur::Values6& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

bool is_on(const std::optional<model::DigitalIo>& io, std::uint64_t bits) {
  return io && (((bits >> io->bit()) & 1U) != 0) != io->active_low;
}

void put_output(const std::optional<model::DigitalIo>& io, bool value, RobotCommand& command) {
  if (!io) return;
  const std::uint64_t bit = std::uint64_t{1} << io->bit();
  command.output_mask |= bit;
  command.outputs = value != io->active_low ? command.outputs | bit : command.outputs & ~bit;
}

control::JointMotion at_rest(const ur::Values6& q) {
  const robot::JointVector zero = robot::JointVector::Zero(6);
  return {served_ur::to_vector(q), zero, zero};
}

/// Between two ticks of the controller, `length` s apart: the cubic with their positions and speeds.
ur::Values6 between(const control::JointMotion& from, const control::JointMotion& to, double share, double length) {
  if (std::abs(share - 1.0) < kSamePhase) return served_ur::to_values(to.q);
  const double s = share, s2 = s * s, s3 = s2 * s;
  const robot::JointVector q = (2.0 * s3 - 3.0 * s2 + 1.0) * from.q + (s3 - 2.0 * s2 + s) * length * from.qd +
                               (3.0 * s2 - 2.0 * s3) * to.q + (s3 - s2) * length * to.qd;
  return served_ur::to_values(q);
}

/// Adds the weight of a mass in the flange to a wrench about Eo in the axes of W.
void add_weight(double mass, const Vector3& p_FCo, const Pose& X_WF, const Vector3& p_WE, const Vector3& gravity,
                Wrench& load) {
  load.force += mass * gravity;
  load.torque += (X_WF * p_FCo - p_WE).cross(mass * gravity);
}

}  // namespace

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
                     "one of them: a motion has to know whether the cup holds a box");
  }
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

// --- periods

void RemoteUr::run_in_time() {
  sched_param priority = {};
  priority.sched_priority = kPriority;
  (void)::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &priority);  // where the system lets it
  for (;;) {
    {
      const std::lock_guard lock(mutex_);
      if (is_stopping_ || !failure_.empty()) return;
    }
    tick();
  }
}

void RemoteUr::tick() {
  RobotCommand command;
  Wish wish = Wish::None;
  {
    const std::lock_guard lock(mutex_);
    wish = std::exchange(wish_, Wish::None);
    if (wish == Wish::Start) {
      ++number_;
      has_started_ = false;
      late_before_ += sample_.late;
    }
    command = make_command();
  }
  std::string trouble;
  if (wish == Wish::Unlock) (void)options_.link->unlock();
  if (wish == Wish::Start) {
    // A zero of the force sensor is right while nothing is touched: at first, not after a stop.
    const bool zeroes = options_.link->is_e_series() && !std::exchange(has_zeroed_, true);
    trouble = options_.link->start(follow_script(ur_arm_, zeroes, number_));
  }
  RobotSample sample;
  if (trouble.empty()) trouble = options_.link->exchange(command, sample);
  {
    const std::lock_guard lock(mutex_);
    take(sample, trouble);
  }
  news_.notify_all();
}

bool RemoteUr::wait_until(double seconds, const std::function<bool()>& is_so) {
  if (thread_.joinable()) {
    std::unique_lock lock(mutex_);
    return news_.wait_for(lock, std::chrono::duration<double>(seconds), is_so);
  }
  for (auto left = static_cast<int>(seconds / period_); left > 0 && !is_so(); --left) tick();
  return is_so();
}

RobotCommand RemoteUr::make_command() {
  ur::Values6 before = q_;
  if (runner_.is_moving()) {
    if (is_braking_)
      brake();
    else
      lead();
  }
  ++command_.count;
  command_.mode = ends_                 ? RobotCommand::Mode::Ends
                  : runner_.is_moving() ? RobotCommand::Mode::Moves
                                        : RobotCommand::Mode::Stands;
  command_.q[2] = command_.mode == RobotCommand::Mode::Moves ? command_.q[1] : q_;
  command_.q[1] = command_.mode == RobotCommand::Mode::Moves ? before : q_;
  command_.q[0] = q_;
  command_.output_mask = 0;
  if (has_started_ && !options_.is_dry) {
    put_output(io_.vacuum, switches_.vacuum, command_);
    put_output(io_.blow_off, switches_.blow_off, command_);
    const bool is_asking = asking_periods_ > 0 && asking_periods_ * period_ <= kAskingTime + 0.5 * period_;
    put_output(io_.next_part, is_asking, command_);
    asking_periods_ = std::max(0, asking_periods_ - 1);
  }
  return command_;
}

/// The target of the coming period: as much further as the robot is to move in it.
void RemoteUr::lead() {
  const double tick = scenario_.controller.tick;
  const double speed = std::clamp(sample_.speed, 0.0, 1.0) * (options_.is_dry ? kDrySpeed : 1.0);
  phase_ += period_ / tick * speed;
  while (phase_ > 1.0 + kSamePhase) {
    phase_ -= 1.0;
    from_ = to_;
    compute_tick();
  }
  const ur::Values6 next = between(from_, to_, phase_, tick);
  for (std::size_t j = 0; j < next.size(); ++j) qd_[j] = (next[j] - q_[j]) / period_;
  q_ = next;
}

/// The next tick of the joints' controller, from where it led them before: the robot follows with a lag of its own.
void RemoteUr::compute_tick() {
  if (runner_.phase() == plant::MotionPhase::Following && !runner_.has_ended() &&
      motion::will_finish(plan_, program_.command, program_)) {
    runner_.arrive(time());
  }
  state_.machine.tool = control::tool_at(model_, state_.machine.joints);
  const control::MachineTick tick = arm_->tick(plan_, program_, state_, work_);
  to_ = state_.machine.joints;
  switches_ = tick.program.io;
  row_ = tick.program.row;
  is_waiting_ = program_.phase == motion::ControllerPhase::Waiting;
  is_stuck_ = tick.outcome == control::Outcome::Stuck;
}

void RemoteUr::brake() {
  const double fastest = largest_of(qd_), drop = kStopDeceleration * period_;
  const double share = fastest > drop ? (fastest - drop) / fastest : 0.0;
  for (std::size_t j = 0; j < q_.size(); ++j) {
    q_[j] += 0.5 * (1.0 + share) * qd_[j] * period_;
    qd_[j] *= share;
  }
  ++braking_periods_;
}

void RemoteUr::take(const RobotSample& sample, const std::string& trouble) {
  if (!trouble.empty()) {
    fail(trouble);
    if (runner_.is_moving()) end_motion();
    push_result();
    return;
  }
  sample_ = sample;
  if (!has_started_) {
    q_ = sample_.target_q;
    has_started_ = is_ready();
    return;
  }
  if (runner_.is_moving()) ++moving_periods_;
  watch_robot();
  if (runner_.is_moving()) step_motion();
  look_for_part();
  if (runner_.is_moving() || runner_.has_events()) push_result();
}

/// After a period in which a motion was under way: whether it goes on.
void RemoteUr::step_motion() {
  const plant::TickReading felt = reading();
  const Pose X_WE = robot::forward_tool(model_, served_ur::to_vector(sample_.q));
  program_.sensed = {felt.pressure_gauge, X_WE.R * felt.F_E.force, felt.hold_factor};
  if (is_stopped_) {
    runner_.stop(plant::EndReason::ProtectiveStop, 0.0, 0.0, stop_reason_);
    return end_motion();
  }
  if (is_braking_) {
    const bool stands = largest_of(qd_) == 0.0 && braking_periods_ > 1 && largest_of(sample_.qd) < kStillJoint;
    if (stands || braking_periods_ * period_ > kLongestBraking) end_motion();
    return;
  }
  if (runner_.phase() == plant::MotionPhase::Settling) {
    ur::Values6 off = q_;
    for (std::size_t j = 0; j < off.size(); ++j) off[j] -= sample_.q[j];
    const double speed = sensors().V_WE.linear.norm();
    constexpr double kMoves = 1.0;  // m/s
    if (runner_.is_settled(felt.time, largest_of(off) > kFollowed ? kMoves : speed)) end_motion();
    return;
  }
  if (row_ >= 0) runner_.follow({motion::WaypointIndex(row_), felt.time, is_waiting_});
  runner_.check(felt);
  if (is_stuck_ && !runner_.has_ended()) runner_.stop(plant::EndReason::Timeout, 0.0, 0.0, "stuck");
  if (runner_.has_ended()) begin_braking();
}

void RemoteUr::begin_braking() {
  is_braking_ = true;
  braking_periods_ = 0;
}

bool RemoteUr::is_ready() const {
  return sample_.script == script_word(number_, ScriptState::Follows) &&
         sample_.runtime_state == static_cast<int>(ur::RuntimeState::Playing) && sample_.robot_mode == 7 &&
         (sample_.safety_mode == 1 || sample_.safety_mode == 2);
}

std::string RemoteUr::why_stopped() const {
  if (sample_.safety_mode != 1 && sample_.safety_mode != 2)
    return std::string("safety mode ") + ur::safety_mode_name(sample_.safety_mode);
  if (sample_.robot_mode != 7) return std::string("robot mode ") + ur::robot_mode_name(sample_.robot_mode);
  if (sample_.script == script_word(number_, ScriptState::Silent)) return "its targets came too late";
  return "its program does not run";
}

/// The robot may stop at any time, also while it stands.
void RemoteUr::watch_robot() {
  if (ends_ || is_stopped_ || is_ready()) return;
  is_stopped_ = true;
  is_stop_told_ = false;
  stop_reason_ = why_stopped();
}

void RemoteUr::look_for_part() {
  const bool is_wired = io_.part_present.has_value();
  const bool is_there = !is_wired || is_on(io_.part_present, sample_.digital_inputs);
  if (!is_there) part_is_new_ = true;
  if (awaited_.empty()) return;
  const bool has_come = in_the_cell_.contains(awaited_.front().value);
  if (has_come || (is_there && (part_is_new_ || !is_wired))) {
    part_is_new_ = false;
    awaited_periods_ = 0;
    runner_.add({time(), plant::ItemArrived{awaited_.front()}});
    awaited_.pop_front();
    return;
  }
  const double waited = static_cast<double>(++awaited_periods_) * period_;
  if (awaited_periods_ % std::llround(kAskAgain / period_) == 0) ask_for_part();
  if (waited > options_.part_patience)
    fail(fmt::format("no new box came to the aligner within {:.0f} s", options_.part_patience));
}

/// Off first: each time is a time of its own.
void RemoteUr::ask_for_part() { asking_periods_ = static_cast<int>(std::lround((kAskingTime + kAskingGap) / period_)); }

void RemoteUr::set_load(double mass, const Vector3& p_FCo) {
  command_.payload = mass;
  command_.payload_cog = {p_FCo.x(), p_FCo.y(), p_FCo.z()};
  ++command_.payload_count;
}

bool RemoteUr::is_holding() const { return switches_.vacuum && pressure() <= runner_.settings().pressure_needed; }

/// With the box that the motion is for: mass and centre, as it was perceived last.
void RemoteUr::load_item() {
  const model::Parcel* parcel = model::find_parcel(scenario_, runner_.motion().item.value);
  if (parcel == nullptr || options_.is_dry) return;
  const SpatialInertia& tool = ur_arm_.tool_load();
  const Pose X_FW = (ur_arm_.base() * ur_arm_.forward(sample_.q)).inverse();
  const auto seen = std::ranges::find(seen_boxes_, parcel->id, &std::pair<std::string, Pose>::first);
  const Vector3 p_FCo = seen != seen_boxes_.end() ? X_FW * (seen->second * parcel->inertia.com) : ur_arm_.tool().p;
  const double mass = tool.mass + parcel->inertia.mass;
  set_load(mass, (tool.mass * tool.com + parcel->inertia.mass * p_FCo) / mass);
}

/// The robot has to know what it carries.
void RemoteUr::follow_load(const std::vector<plant::Event>& events) {
  const SpatialInertia& tool = ur_arm_.tool_load();
  for (const plant::Event& event : events) {
    if (plant::get<plant::VacuumDropped>(event) != nullptr) set_load(tool.mass, tool.com);
    if (plant::get<plant::VacuumBuilt>(event) != nullptr) load_item();
  }
  if (!switches_.vacuum && command_.payload != tool.mass) set_load(tool.mass, tool.com);
}

void RemoteUr::push_result() {
  std::vector<plant::Event> events = runner_.take_events();
  follow_load(events);
  results_.push_back({current(), std::move(events)});
}

// --- what the robot's sensors say

double RemoteUr::pressure() const {
  if (io_.vacuum_gauge) {
    const std::size_t first = io_.vacuum_gauge->kind == model::AnalogKind::Tool ? 2 : 0;
    const double reading = sample_.analog_inputs[first + static_cast<std::size_t>(io_.vacuum_gauge->number)];
    return std::min(0.0, io_.vacuum_gauge->pressure_of(reading)) + 0.0;
  }
  return is_on(io_.vacuum_reached, sample_.digital_inputs) ? scenario_.cup.vacuum.pressure_gauge_hold : 0.0;
}

/// From what the cup carries and touches, weight included; without the gripper's own.
Wrench RemoteUr::load_on_tool() const {
  const Pose& X_WBase = ur_arm_.base();
  const Pose X_WF = X_WBase * ur_arm_.forward(sample_.q);
  const Pose X_WE = X_WF * ur_arm_.tool();
  const ur::Values6& f = sample_.tcp_force;
  Wrench load;
  load.force = X_WBase.R * Vector3(f[0], f[1], f[2]);
  load.torque = X_WBase.R * Vector3(f[3], f[4], f[5]);
  const ur::Values3& cog = sample_.payload ? sample_.payload_cog : command_.payload_cog;
  const SpatialInertia& tool = ur_arm_.tool_load();
  add_weight(sample_.payload.value_or(command_.payload), Vector3(cog[0], cog[1], cog[2]), X_WF, X_WE.p,
             scenario_.gravity, load);
  add_weight(-tool.mass, tool.com, X_WF, X_WE.p, scenario_.gravity, load);
  return {X_WE.R.transpose() * load.force, X_WE.R.transpose() * load.torque};
}

plant::TickReading RemoteUr::reading() const {
  plant::TickReading now;
  now.time = time();
  now.F_E = load_on_tool();
  now.pressure_gauge = pressure();
  now.is_vacuum_on = switches_.vacuum;
  now.hold_factor = cup::sensed_hold_factor(scenario_.cup, now.pressure_gauge, now.F_E);
  return now;
}

plant::Feedback RemoteUr::sensors() const {
  const plant::TickReading now = reading();
  const control::JointMotion joints{served_ur::to_vector(sample_.q), served_ur::to_vector(sample_.qd),
                                    robot::JointVector::Zero(6)};
  const motion::ToolState tool = control::tool_at(model_, joints);
  plant::Feedback fed;
  fed.time = now.time;
  fed.X_WE = tool.X_WE;
  fed.V_WE = tool.V_WE;
  fed.q.assign(sample_.q.begin(), sample_.q.end());
  fed.qd.assign(sample_.qd.begin(), sample_.qd.end());
  fed.torques.assign(sample_.torques.begin(), sample_.torques.end());
  fed.pressure_gauge = now.pressure_gauge;
  fed.F_E = now.F_E;
  fed.io = switches_;
  if (!runner_.is_moving() || is_braking_) {
    if (largest_of(sample_.qd) < kStillJoint) fed.V_WE = Twist{};
  }
  return fed;
}

plant::Feedback RemoteUr::current() const {
  if (!runner_.is_moving()) return feedback_;
  plant::Feedback now = sensors();
  now.end = feedback_.end;
  runner_.fill(now);
  return now;
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
        runner_.add({time(), plant::FaultRaised{plant::EndReason::Cancelled, "interrupted while it waited for a box"}});
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
  if (!is_ready()) return fail("the robot cannot go on after its stop: " + why_stopped());
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
