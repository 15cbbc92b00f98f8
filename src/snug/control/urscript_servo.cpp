// URScript: the joints of a run in time (servoj).
#include "snug/control/urscript.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "snug/control/internal/program_text.hpp"
#include "snug/control/internal/urscript_parts.hpp"
#include "snug/control/joint_knots.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::control {
namespace {

using internal::check_is_ur, internal::format_header, internal::format_outputs, internal::format_part_wait,
    internal::format_script_payload, internal::format_start, internal::format_wait, internal::kJointAcceleration,
    internal::wait_function;

constexpr int kJoints = 6;  // of a UR
// servoj is asked for the least lag of the script manual's ranges, lookahead_time 0.03 to 0.2 s and gain 100 to 2000:
// the targets are smooth already, and this is what the maker's driver for ROS streams joint trajectories with.
constexpr double kLookahead = 0.03;  ///< s
constexpr int kGain = 2000;
// From the axes of a UR10 to the cup in front of its flange are at most 1.7, 1.7, 1.1, 0.6, 0.5 and 0 m: with every
// joint off by this much in the worst direction, the tool is off by 0.084 mm. The arm repeats poses to 0.1 mm.
constexpr double kKnotTolerance = 1.5e-5;  ///< rad
// Of what is printed: steps of 1e-7 rad make accelerations of up to 6e-7 / tick^2, 0.01 rad/s^2 at 8 ms.
constexpr int kPositionDigits = 7;          ///< of rad
constexpr int kSpeedDigits = 6;             ///< of rad/s
constexpr double kAccelerationSlack = 0.1;  ///< rad/s^2
constexpr double kBrakingSlack = 0.02;      ///< s, two ticks more than braking takes
// The robot lags behind its targets by about the lookahead: it gets four of them to arrive where it is to stand.
constexpr double kSettling = 0.12;  ///< s
// An arm that has settled is off by less than a milliradian; one that met something on the way, or lags behind a slider
// of speed, by far more. 0.02 rad of one joint put the cup of a UR10 at most 34 mm beside the target.
constexpr double kArrival = 0.02;  ///< rad, of each joint

robot::JointVector rounded(const robot::JointVector& values, int digits) {
  const double steps = std::pow(10.0, digits);
  return (values * steps).array().round() / steps + 0.0;  // + 0.0: no -0
}

/// Without exponents.
std::string format_fixed(const robot::JointVector& values, int digits) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    text += fmt::format("{}{:.{}f}", i == 0 ? "" : ", ", values[i], digits);
  }
  return text + "]";
}

/// The functions with which a script follows a run. Elements are written out: lists have no arithmetic on the older of
/// the controllers.
std::string follow_functions(const robot::JointVector& q_start) {
  std::string text = fmt::format("  global snug_q = {}\n", format_fixed(q_start, kPositionDigits));
  text +=
      "  global snug_qd = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]\n"
      "  global snug_time = 0.0\n"
      "  # On cubic polynomials from the last knot to that at the joints q with the speeds qd, `duration` later.\n"
      "  # snug_time: of the last target, counted from the last knot; what a step leaves of one polynomial goes on in\n"
      "  # the next, so that no time is lost.\n"
      "  def snug_follow(q, qd, duration):\n"
      "    while snug_time + get_steptime() <= duration + 0.000001:\n"
      "      snug_time = snug_time + get_steptime()\n"
      "      local u = snug_time / duration\n"
      "      local a = (1.0 + 2.0 * u) * (1.0 - u) * (1.0 - u)\n"
      "      local b = u * (1.0 - u) * (1.0 - u) * duration\n"
      "      local c = u * u * (3.0 - 2.0 * u)\n"
      "      local d = u * u * (u - 1.0) * duration\n";
  for (int i = 0; i < kJoints; ++i) {
    text += fmt::format("      local q{0} = a * snug_q[{0}] + b * snug_qd[{0}] + c * q[{0}] + d * qd[{0}]\n", i);
  }
  text += fmt::format(
      "      servoj([q0, q1, q2, q3, q4, q5], 0, 0, t=get_steptime(), lookahead_time={}, gain={})\n"
      "    end\n"
      "    snug_time = snug_time - duration\n"
      "    snug_q = q\n"
      "    snug_qd = qd\n"
      "  end\n"
      "  # Halts unless every joint is where it is to be.\n"
      "  def snug_check_arrival(q):\n"
      "    local actual = get_actual_joint_positions()\n"
      "    local joint = 0\n"
      "    while joint < {}:\n"
      "      local off = actual[joint] - q[joint]\n"
      "      if off > {} or off < -{}:\n"
      "        textmsg(\"snug: the arm did not arrive, it is off by rad: \", off)\n"
      "        textmsg(\"snug: of the joint, counted from 0: \", joint)\n"
      "        popup(\"the arm did not arrive\", title=\"snug\", error=True, blocking=True)\n"
      "        halt\n"
      "      end\n"
      "      joint = joint + 1\n"
      "    end\n"
      "  end\n"
      "  # Stands at the joints q.\n"
      "  def snug_rest(q):\n"
      "    snug_follow(q, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0], {})\n"
      "    stopj({})\n"
      "    snug_time = 0.0\n"
      "    snug_check_arrival(q)\n"
      "  end\n",
      kLookahead, kGain, kJoints, kArrival, kArrival, kSettling, kJointAcceleration);
  return text;
}

/// The states at the start of each sample, and that at the end of the last, as they are printed.
std::vector<TimedJoints> states_of(const JointRun& run, double tick) {
  std::vector<TimedJoints> states;
  const auto add = [&](double time, const JointState& joints) {
    states.push_back({time, rounded(joints.q, kPositionDigits), rounded(joints.qd, kSpeedDigits)});
  };
  for (const JointSample& sample : run.samples) add(sample.time, sample.before);
  if (!run.samples.empty()) add(run.samples.back().time + tick, run.samples.back().after);
  return states;
}

KnotLimits limits_of(const JointRun& run, const robot::ArmModel& arm, double tick) {
  KnotLimits limits{kKnotTolerance, robot::JointVector::Zero(arm.joint_count()), kAccelerationSlack};
  for (Eigen::Index j = 0; j < limits.max_speed.size(); ++j)
    limits.max_speed[j] = arm.joints[static_cast<std::size_t>(j)].max_speed;
  for (const JointSample& sample : run.samples) {
    const double asked = (sample.after.qd - sample.before.qd).cwiseAbs().maxCoeff() / tick;
    limits.max_acceleration = std::max(limits.max_acceleration, asked + kAccelerationSlack);
  }
  return limits;
}

bool is_at_rest(const JointSample& sample) { return sample.before.qd.norm() <= kAlmostAtRest; }

/// The sample from which on joints rest that brake at `from` as hard as they may, on the way to the same row; none:
/// they move on.
std::optional<std::size_t> find_rest(const std::vector<JointSample>& samples, std::size_t from,
                                     double max_acceleration) {
  const double braking = samples[from].before.qd.cwiseAbs().maxCoeff() / max_acceleration + kBrakingSlack;
  for (std::size_t i = from; i < samples.size() && samples[i].row == samples[from].row; ++i) {
    if (samples[i].time - samples[from].time > braking) break;
    if (is_at_rest(samples[i])) return i;
  }
  return std::nullopt;
}

/// The last sample of the rest that begins at `rest`, on the way to the same row.
std::size_t find_end_of_rest(const std::vector<JointSample>& samples, std::size_t rest) {
  std::size_t end = rest;
  while (end + 1 < samples.size() && samples[end + 1].row == samples[rest].row && is_at_rest(samples[end + 1])) ++end;
  return end;
}

/// Writes a run, from its start on.
class ServoWriter {
 public:
  ServoWriter(const JointRun& run, const RobotProgram& program, const UrScriptOptions& options)
      : run_(run),
        program_(program),
        options_(options),
        states_(states_of(run, program.plan.settings.tick)),
        limits_(limits_of(run, program.arm, program.plan.settings.tick)) {}

  /// Nothing of a run without samples.
  UrServoScript write() {
    if (!run_.samples.empty()) wait_for_part(static_cast<std::size_t>(std::max(0, run_.samples.front().row)));
    for (std::size_t i = 0; i < run_.samples.size(); ++i) {
      if (i == 0 || run_.samples[i].row != run_.samples[i - 1].row) begin_row(i);
    }
    if (!states_.empty()) {
      follow(states_.size() - 1);
      rest(states_.back());
    }
    return std::move(script_);
  }

 private:
  /// Outputs change with rows only.
  void begin_row(std::size_t sample) {
    const int row = run_.samples[sample].row;
    if (row < 0) return;
    follow(sample);
    const motion::Waypoint& waypoint = program_.plan.program.waypoints[static_cast<std::size_t>(row)];
    script_.text += fmt::format("  # {} {}\n", row + 1, motion::name_of(waypoint));
    const motion::IO before = io_;
    const motion::IO& io = run_.samples[sample].io;
    const bool changes_vacuum = io.vacuum != before.vacuum;
    const std::optional<std::size_t> stop =
        changes_vacuum ? find_rest(run_.samples, sample, limits_.max_acceleration) : std::nullopt;
    if (stop) follow(*stop);
    const std::size_t departure = stop ? find_end_of_rest(run_.samples, *stop) : sample;
    if (stop) rest(states_[departure]);
    script_.text += format_outputs(io_, io, options_);
    if (stop) script_.text += format_wait(waypoint);
    if (changes_vacuum) {
      script_.text += format_script_payload(program_, program_.loads[static_cast<std::size_t>(row)], options_);
    }
    if (stop && !io.vacuum) wait_for_part(static_cast<std::size_t>(row));
    if (stop) at_ = departure;
    io_ = io;
  }

  /// The box that is picked at the aligner before the vacuum comes on again, from that row on.
  void wait_for_part(std::size_t row) {
    const std::vector<motion::Waypoint>& rows = program_.plan.program.waypoints;
    for (std::size_t i = row; i < rows.size() && !rows[i].io.vacuum; ++i) {
      if (rows[i].motion_class != motion::MotionClass::Pick) continue;
      script_.text += format_part_wait(rows[i], options_);
      return;
    }
  }

  void follow(std::size_t end) {
    const std::span<const TimedJoints> way = std::span(states_).subspan(at_, end - at_ + 1);
    double time = states_[at_].time;
    for (const std::size_t k : find_knots(way, limits_)) {
      script_.text += fmt::format("  snug_follow({}, {}, {:.9g})\n", format_fixed(way[k].q, kPositionDigits),
                                  format_fixed(way[k].qd, kSpeedDigits), way[k].time - time);
      time = way[k].time;
      ++script_.knots;
    }
    script_.followed_duration += time - states_[at_].time;
    at_ = end;
  }

  /// At the joints of that state, from which the script goes on.
  void rest(TimedJoints& state) {
    script_.text += fmt::format("  snug_rest({})\n", format_fixed(state.q, kPositionDigits));
    script_.followed_duration += kSettling;
    state.qd.setZero();
  }

  const JointRun& run_;
  const RobotProgram& program_;
  const UrScriptOptions& options_;
  std::vector<TimedJoints> states_;
  KnotLimits limits_;
  std::size_t at_ = 0;  ///< state that the script has come to
  motion::IO io_;       ///< what the outputs have
  UrServoScript script_;
};

}  // namespace

UrServoScript format_servo_urscript(const JointRun& run, const RobotProgram& program, const UrScriptOptions& options) {
  check_is_ur(program.arm);
  SNUG_CHECK(program.loads.size() == program.plan.program.waypoints.size(), "one load for each row");
  const bool is_finite = std::all_of(run.samples.begin(), run.samples.end(), [](const JointSample& sample) {
    return sample.before.q.allFinite() && sample.before.qd.allFinite() && sample.after.q.allFinite() &&
           sample.after.qd.allFinite();
  });
  if (!is_finite)
    throw InputError(program.arm.name, "urscript", "joints that are not finite", "a run of finite joints");

  const robot::JointVector q_start = run.samples.empty() ? program.q_start : run.samples.front().before.q;
  UrServoScript script = ServoWriter(run, program, options).write();
  script.simulated_duration = static_cast<double>(run.samples.size()) * program.plan.settings.tick;
  std::string text = format_header(program, "rad, rad/s, s; payloads in kg and m");
  text +=
      "# The joints of a simulation, in time: run it with the speed slider at 100 %. Rows in contact end where they\n"
      "# ended there. Waits for the vacuum ask its sensor, stops ask where the joints are; nothing else is felt: at a\n"
      "# force the robot stops by its own safety limits only.\n"
      "def snug_program():\n";
  text += fmt::format(
      "  # Simulated: {:.1f} s. Here: {:.1f} s on polynomials between {} knots, and waits for the vacuum.\n",
      script.simulated_duration, script.followed_duration, script.knots);
  text += wait_function(options) + follow_functions(q_start) + format_start(program, q_start, options);
  script.text = text + script.text + "end\n";
  return script;
}

JointRun begin_at(const JointRun& run, std::size_t sample, std::size_t ramp, double tick) {
  SNUG_CHECK(ramp > 0 && sample + ramp < run.samples.size(), "samples to come up to speed on");
  JointRun begun;
  begun.is_complete = run.is_complete;
  begun.stuck_row = run.stuck_row;
  const double rise = 2.0 * tick * static_cast<double>(ramp);  // s
  // Along the way with the clock t^2 / (2 rise): after `rise` it runs as fast as time.
  const auto state_at = [&](std::size_t step) {
    const double t = tick * static_cast<double>(step), along = t * t / (2.0 * rise), pace = t / rise;
    const std::size_t i = std::min(sample + ramp - 1, sample + static_cast<std::size_t>(along / tick));
    const JointState &from = run.samples[i].before, &to = run.samples[i + 1].before;
    const double u = std::clamp(along / tick - static_cast<double>(i - sample), 0.0, 1.0);
    const TimedJoints a{0.0, from.q, from.qd}, b{tick, to.q, to.qd};
    JointState state;
    state.q = interpolate(a, b, u * tick);
    state.qd = pace * ((1.0 - u) * from.qd + u * to.qd);
    state.qdd = from.qd / rise;
    return state;
  };
  for (std::size_t step = 0; step < 2 * ramp; ++step) {
    JointSample one = run.samples[sample];
    one.before = state_at(step);
    one.after = state_at(step + 1);
    begun.samples.push_back(one);
  }
  begun.samples.insert(begun.samples.end(), run.samples.begin() + static_cast<std::ptrdiff_t>(sample + ramp),
                       run.samples.end());
  for (std::size_t i = 0; i < begun.samples.size(); ++i) begun.samples[i].time = tick * static_cast<double>(i);
  return begun;
}

}  // namespace snug::control
