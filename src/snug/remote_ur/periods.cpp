// Periods of RemoteUr: what the robot is told in each, what its sensors say, and whether the motion goes on.
#include <fmt/format.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "snug/cup/phases.hpp"
#include "snug/remote_ur/follow_script.hpp"
#include "snug/remote_ur/internal/signals.hpp"
#include "snug/remote_ur/remote_ur.hpp"
#include "snug/ur/primary_reader.hpp"

namespace snug::remote_ur {
namespace {

using internal::is_on;
using internal::kLongestBraking;

// rad/s^2, of the fastest joint, where a motion is stopped: as the maker's client library brakes.
constexpr double kStopDeceleration = 40.0;
constexpr double kStillJoint = 0.01;  // rad/s
constexpr double kFollowed = 2e-3;    // rad, between a joint and its target: the robot has come there
constexpr double kAskingGap = 0.05;   // s, for which the output is off before
constexpr double kAskingTime = 0.2;   // s, for which the next box is asked for
constexpr double kAskAgain = 5.0;     // s
constexpr double kSamePhase = 1e-9;
constexpr int kPriority = 10;  // of real-time threads

double largest_of(const ur::Values6& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

void put_output(const std::optional<model::DigitalIo>& io, bool value, RobotCommand& command) {
  if (!io) return;
  const std::uint64_t bit = std::uint64_t{1} << io->bit();
  command.output_mask |= bit;
  command.outputs = value != io->active_low ? command.outputs | bit : command.outputs & ~bit;
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

}  // namespace snug::remote_ur
