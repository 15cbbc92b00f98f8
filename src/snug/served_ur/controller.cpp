// Controller: the simulated cell as what a UR controller makes of it, one period after the other.
#include "snug/served_ur/controller.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/cup/phases.hpp"
#include "snug/served_ur/internal/programs.hpp"
#include "snug/ur/primary.hpp"

namespace snug::served_ur {
namespace {

using ur::RobotMode;
using ur::RuntimeState;
using ur::SafetyMode;

constexpr double kPowerTime = 0.5;  ///< s, from power on to idle, and from there until the brakes are released
constexpr double kMovingOut = 0.5;  // s, of motion after a stop that was released
constexpr int kStopByForce = 157, kStopAskedFor = 209;  // codes of error messages
constexpr int kWarning = 2;                             // level of an error message
constexpr double kPartTime = 0.1;                       // s, that a part which was asked for takes to come
constexpr std::size_t kMostMessages = 1000;

/// The bit of a signal, as it stands where the signal says yes or no.
std::uint64_t bit_of(const std::optional<model::DigitalIo>& io, bool says) {
  return io && says != io->active_low ? std::uint64_t{1} << io->bit() : 0;
}
bool says(const std::optional<model::DigitalIo>& io, std::uint64_t bits) {
  return io && (((bits >> io->bit()) & 1U) != 0) != io->active_low;
}

std::uint64_t with_bits(std::uint64_t word, std::uint8_t mask, std::uint8_t bits, int shift) {
  const std::uint64_t at = std::uint64_t{mask} << shift;
  return (word & ~at) | ((std::uint64_t{bits} << shift) & at);
}

/// Clients compare the words for a function that is not there.
std::string as_controllers_say(const std::string& error) {
  constexpr std::string_view kUnknown = "unknown function '";
  if (!error.starts_with(kUnknown)) return error;
  return "compile_error_name_not_found:" +
         error.substr(kUnknown.size(), error.find('\'', kUnknown.size()) - kUnknown.size()) + ":";
}

}  // namespace

Controller::Controller(const cell::Simulation& simulation, ControllerSettings settings)
    : simulation_(simulation),
      settings_(std::move(settings)),
      io_(model::robot_io(simulation.scenario())),
      outputs_off_(bit_of(io_.vacuum, false) | bit_of(io_.blow_off, false) | bit_of(io_.next_part, false)),
      arm_(simulation),
      initial_(simulation.make_state()),
      initial_reading_(simulation.read_still(initial_)),
      programs_(std::make_unique<internal::Programs>(arm_, period_of(settings_.model), settings_.programs_reach_others,
                                                     inputs_)) {
  SNUG_CHECK(std::abs(simulation.scenario().controller.tick - period_of(settings_.model)) < 1e-12,
             "the cell's tick is the controller's period");
  data_.robot_mode = RobotMode::Running;
  data_.digital_outputs = outputs_off_;
  data_.tcp_offset = to_values(arm_.tool());
  data_.payload = arm_.tool_load().mass;
  data_.payload_cog = {arm_.tool_load().com.x(), arm_.tool_load().com.y(), arm_.tool_load().com.z()};
  data_.target_q = to_values(initial_.arm->machine.joints.q);
  read_cell();
}

Controller::~Controller() = default;

std::vector<std::string> Controller::take_messages() { return std::exchange(messages_, {}); }

void Controller::tell(std::string packet) {
  if (messages_.size() < kMostMessages) messages_.push_back(std::move(packet));
}

void Controller::step() {
  const auto start = std::chrono::steady_clock::now();
  ++period_;
  data_.timestamp = static_cast<double>(period_) * period_of(settings_.model);
  take_inputs();
  advance_mode();
  hold();
  run_programs();
  if (data_.target_qd != ur::Values6{}) moving_out_ = std::max(0, moving_out_ - 1);
  advance_cell();
  read_cell();
  data_.execution_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Masks say which bits are meant in this period; registers keep what they were given.
void Controller::take_inputs() {
  data_.inputs = inputs_.registers;
  data_.digital_outputs = with_bits(data_.digital_outputs, inputs_.standard_mask, inputs_.standard, 0);
  data_.digital_outputs = with_bits(data_.digital_outputs, inputs_.configurable_mask, inputs_.configurable, 8);
  data_.digital_outputs = with_bits(data_.digital_outputs, inputs_.tool_mask & 3U, inputs_.tool, 16);
  for (std::size_t n = 0; n < 2; ++n) {
    if (((inputs_.analog_mask >> n) & 1U) == 0) continue;
    // a fraction of 10 V, or of the range 4 .. 20 mA
    const double fraction = std::clamp(inputs_.analog[n], 0.0, 1.0);
    data_.analog_outputs[n] = ((inputs_.analog_type >> n) & 1U) != 0 ? 10.0 * fraction : 0.004 + 0.016 * fraction;
  }
  if (inputs_.speed_slider_mask != 0) {
    data_.target_speed_fraction = std::clamp(inputs_.speed_slider_fraction, 0.0, 1.0);
  }
  inputs_.standard_mask = inputs_.configurable_mask = inputs_.tool_mask = inputs_.analog_mask = 0;
  inputs_.speed_slider_mask = 0;
}

void Controller::set_mode(RobotMode mode) {
  data_.robot_mode = mode;
  mode_since_ = period_;
}

void Controller::set_safety(SafetyMode mode) {
  data_.safety_mode = mode;
  tell(ur::robot_state(data_, robot(), model()));  // at once: clients ask the last state whether a stop is released
  tell(ur::safety_mode_message(data_.timestamp, mode));
}

void Controller::power_on() {
  if (data_.robot_mode == RobotMode::PowerOff && data_.safety_mode != SafetyMode::Fault) set_mode(RobotMode::PowerOn);
}

void Controller::power_off() {
  wants_brakes_released_ = false;
  if (data_.robot_mode == RobotMode::PowerOff) return;
  programs_->abort();
  if (run_ && !is_ended_) run_->stand();
  set_mode(RobotMode::PowerOff);
}

void Controller::release_brakes() {
  if (data_.safety_mode == SafetyMode::Fault || data_.robot_mode == RobotMode::Running) return;
  power_on();
  if (!wants_brakes_released_ && data_.robot_mode == RobotMode::Idle) mode_since_ = period_;
  wants_brakes_released_ = true;
}

bool Controller::release_stop(double after) {
  const double since = static_cast<double>(period_ - stopped_since_) * period_of(settings_.model);
  if (data_.safety_mode != SafetyMode::ProtectiveStop || since < after) return false;
  set_safety(SafetyMode::Normal);
  moving_out_ = static_cast<int>(std::lround(kMovingOut / period_of(settings_.model)));
  return true;
}

void Controller::restart_safety() {
  if (data_.safety_mode != SafetyMode::Fault) return;
  run_.reset();
  is_ended_ = false;
  feeder_ = {};
  data_.digital_outputs = outputs_off_;
  data_.target_q = to_values(initial_.arm->machine.joints.q);
  set_safety(SafetyMode::Normal);
  set_mode(RobotMode::PowerOff);
}

bool Controller::obey(std::string_view line) {
  line = trim(line);
  if (line == "power on")
    power_on();
  else if (line == "power off")
    power_off();
  else if (line == "set robotmode run")
    release_brakes();
  else if (line == "set unlock protective stop")
    is_unlock_wanted_ = data_.safety_mode == SafetyMode::ProtectiveStop;
  else if (line == "stop program")
    stop_program();
  else
    return false;
  return true;
}

void Controller::run_program(std::string_view text) {
  program_error_.clear();
  is_loaded_last_ = false;
  programs_->start(text, data_, may_move());
}
void Controller::stop_program() { programs_->stop(); }

bool Controller::load_program(std::string_view file) {
  namespace fs = std::filesystem;
  const std::string name(file.substr(file.find_last_of("/\\") + 1));
  if (settings_.programs.empty() || name.empty() || name.front() == '.') return false;
  try {
    loaded_text_ = read_file(fs::path(settings_.programs) / fs::path(name).replace_extension(".script"),
                             "a program in URScript", kLongestProgram);
  } catch (const InputError&) {
    return false;
  }
  programs_->abort();
  loaded_name_ = name;
  is_loaded_last_ = true;
  return true;
}

bool Controller::play() {
  if (programs_->is_active()) return programs_->resume();
  if (loaded_name_.empty() || !may_move()) return false;
  run_program(loaded_text_);
  is_loaded_last_ = true;
  return programs_->is_active();
}

bool Controller::pause_program() { return programs_->pause(); }
void Controller::close_popup() { programs_->close_popup(); }
const std::string& Controller::program_name() const { return is_loaded_last_ ? loaded_name_ : programs_->name(); }

void Controller::run_programs() {
  using Kind = internal::ProgramNews::Kind;
  programs_->step(data_);
  const std::optional<std::string> stop = programs_->take_protective_stop();
  if (stop && data_.safety_mode == SafetyMode::Normal) {
    if (run_ && !is_ended_) run_->stand();
    stop_for_protection(*stop, kStopAskedFor);
    program_error_ = *stop;
  }
  data_.runtime_state = !programs_->is_active()  ? RuntimeState::Stopped
                        : programs_->is_paused() ? RuntimeState::Paused
                                                 : RuntimeState::Playing;
  for (const internal::ProgramNews& news : programs_->take_news()) {
    switch (news.kind) {
      case Kind::Started:
        tell(ur::key_message(data_.timestamp, "PROGRAM_XXX_STARTED", news.text));
        break;
      case Kind::Stopped:
        tell(ur::key_message(data_.timestamp, "PROGRAM_XXX_STOPPED", news.text));
        break;
      case Kind::Failed:
        program_error_ = std::to_string(news.line) + ":" + std::to_string(news.column) + ": " + news.text;
        tell(ur::runtime_exception(data_.timestamp, news.line, news.column, as_controllers_say(news.text)));
        break;
      case Kind::Halted:
        program_error_ = std::to_string(news.line) + ": " + news.text;
        break;
      case Kind::Text:
        tell(ur::text_message(data_.timestamp, news.text));
        break;
    }
  }
}

void Controller::advance_mode() {
  if (is_unlock_wanted_) is_unlock_wanted_ = !release_stop(kUnlockAskedAfter);
  const double since = static_cast<double>(period_ - mode_since_) * period_of(settings_.model);
  if (since < kPowerTime) return;
  if (data_.robot_mode == RobotMode::PowerOn) {
    set_mode(RobotMode::Idle);
  } else if (data_.robot_mode == RobotMode::Idle && wants_brakes_released_) {
    wants_brakes_released_ = false;
    set_mode(RobotMode::Running);
  }
}

bool Controller::may_move() const {
  return data_.robot_mode == RobotMode::Running && data_.safety_mode == SafetyMode::Normal;
}

void Controller::hold() {
  if (!may_move()) data_.target_q = to_values(state().arm->machine.joints.q);
  if (!programs_->is_active()) data_.target_qd = data_.target_qdd = {};
}

void Controller::begin_run() {
  ++run_count_;
  run_ = std::make_unique<runs::OutsideRun>(
      simulation_, settings_.begin_run ? settings_.begin_run(run_count_) : runs::OutsideRunOptions{});
}

void Controller::advance_cell() {
  if (is_ended_) return;
  if (!run_ && data_.digital_outputs == outputs_off_ && !programs_->is_active()) return;
  if (!run_) begin_run();
  take_next_part();
  const int item = settings_.feeds_on_request && io_.next_part ? -1 : feeder_.next(simulation_, run_->state());
  if (item >= 0 && (!settings_.feeds_when_placed || feeder_.is_last_placed(simulation_, run_->state()))) {
    (void)run_->feed(item, 0);
    feeder_.advance();
  }
  cell::OutsideCommand command;
  command.joints.kinds.assign(6, control::DriveKind::Position);
  command.joints.target = to_vector(data_.target_q);
  command.cup = {says(io_.vacuum, data_.digital_outputs), says(io_.blow_off, data_.digital_outputs)};
  const cell::Failure failure = run_->advance(command).failure;
  if (failure) fail(failure);
}

/// In the place of what stands there. The input for it goes off in between, as where boxes take their time.
void Controller::take_next_part() {
  const bool is_asked = says(io_.next_part, data_.digital_outputs);
  const bool has_begun = is_asked && !was_asked_;
  was_asked_ = is_asked;
  const int item = feeder_.coming(simulation_);
  if (!has_begun || item < 0) return;
  run_->bring(item, 0);
  feeder_.advance();
  part_since_ = period_ + std::llround(kPartTime / period_of(settings_.model));
}

void Controller::stand() {
  data_.target_q = to_values(state().arm->machine.joints.q);
  data_.target_qd = data_.target_qdd = {};
}

void Controller::stop_for_protection(const std::string& why, int code) {
  stand();
  programs_->abort();
  stopped_since_ = period_;
  is_unlock_wanted_ = false;
  tell(ur::error_message(data_.timestamp, code, 0, kWarning, why));
  set_safety(SafetyMode::ProtectiveStop);
}

/// The arm's stop is released at once: it is the controller that keeps it standing, so that the cell goes on. What the
/// arm pressed on comes to rest meanwhile and shows its load again when the arm moves: that is no new stop.
void Controller::fail(const cell::Failure& failure) {
  if (run_->is_stopped_for_protection()) {
    run_->acknowledge();
    if (moving_out_ > 0) return;
    if (data_.safety_mode == SafetyMode::ProtectiveStop) return stand();
    return stop_for_protection(failure.text, kStopByForce);
  }
  end(failure.text);
  is_ended_ = true;
  programs_->abort();
  tell(ur::error_message(data_.timestamp, 100, 0, 4, failure.text));
  set_safety(SafetyMode::Fault);
  set_mode(RobotMode::PowerOff);
}

void Controller::end(const std::string& why) {
  if (!run_ || is_ended_) return;
  is_ended_ = true;
  const runs::RunResult result = run_->finish(why);
  if (settings_.end_run) settings_.end_run(run_count_, result);
}

std::uint64_t Controller::read_inputs(const cell::CellState& state) const {
  const cup::CupState& cup = state.gripper.cup;
  const double reached = cup::kEstablishedVacuum * simulation_.scenario().cup.vacuum.pressure_gauge_hold;
  const bool is_reached = cup.body >= 0 && cup.pressure_gauge <= reached;
  return bit_of(io_.vacuum_reached, is_reached) |
         bit_of(io_.part_present, state.waiting_item >= 0 && period_ >= part_since_);
}

void Controller::read_gauge(const cell::CellState& state) {
  if (!io_.vacuum_gauge) return;
  const model::GaugeIo& gauge = *io_.vacuum_gauge;
  const double reading = gauge.reading_of(std::clamp(state.gripper.cup.pressure_gauge, gauge.pressure_gauge, 0.0));
  auto& inputs = gauge.kind == model::AnalogKind::Tool ? data_.tool_analog_inputs : data_.analog_inputs;
  inputs[static_cast<std::size_t>(gauge.number)] = reading;
}

void Controller::read_cell() {
  const cell::CellState& now = state();
  const cell::ArmReading& reading = run_ ? run_->reading() : initial_reading_;
  const control::JointMotion& joints = now.arm->machine.joints;
  data_.actual_q = to_values(joints.q);
  data_.actual_qd = to_values(joints.qd);
  for (std::size_t j = 0; j < std::min<std::size_t>(6, reading.joints.size()); ++j) {
    data_.target_moment[j] = reading.joints[j].torque;
  }
  const Pose X_FT = to_pose(data_.tcp_offset);
  data_.actual_tcp_pose = to_values(arm_.forward(data_.actual_q) * X_FT);
  data_.target_tcp_pose = to_values(arm_.forward(data_.target_q) * X_FT);
  data_.actual_tcp_speed = arm_.tcp_speed(data_.actual_q, data_.actual_qd, X_FT);
  data_.target_tcp_speed = arm_.tcp_speed(data_.target_q, data_.target_qd, X_FT);
  data_.digital_inputs = read_inputs(now);
  read_gauge(now);
  data_.speed_scaling = data_.target_speed_fraction;
  const Pose X_WT = arm_.base() * arm_.forward(data_.actual_q) * X_FT;
  read_force(now, X_WT);
  const robot::ArmPose at = robot::forward(arm_.model(), joints.q);
  const Vector3 elbow = arm_.base().inverse() * at.X_WS[3].p;
  data_.elbow_position = {elbow.x(), elbow.y(), elbow.z()};
  // at rest: what an accelerometer in the tool reads of gravity
  const Vector3 felt = -(X_WT.R.transpose() * simulation_.scenario().gravity);
  data_.tool_acceleration = {felt.x(), felt.y(), felt.z()};
}

/// On the tool, of all but what the controller believes to be its payload; about the TCP, in the axes of Base.
void Controller::read_force(const cell::CellState& state, const Pose& X_WT) {
  const Wrench load = run_ ? run_->tool_load() : Wrench{};
  const Pose& X_WE = state.arm->machine.tool.X_WE;
  const Vector3& gravity = simulation_.scenario().gravity;
  const Pose X_WF = X_WE * arm_.tool().inverse();
  Vector3 force = X_WE.R * load.force;
  Vector3 torque = X_WE.R * load.torque + (X_WE.p - X_WT.p).cross(force);
  const auto add_weight = [&](double mass, const Vector3& p_FCo) {
    force += mass * gravity;
    torque += (X_WF * p_FCo - X_WT.p).cross(mass * gravity);
  };
  add_weight(arm_.tool_load().mass, arm_.tool_load().com);
  add_weight(-data_.payload, Vector3(data_.payload_cog[0], data_.payload_cog[1], data_.payload_cog[2]));
  force = arm_.base().R.transpose() * force;
  torque = arm_.base().R.transpose() * torque;
  data_.actual_tcp_force = {force.x(), force.y(), force.z(), torque.x(), torque.y(), torque.z()};
  data_.ft_raw_wrench = data_.actual_tcp_force;
}

}  // namespace snug::served_ur
