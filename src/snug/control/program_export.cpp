// Programs through the joints for other programs: ROS trajectories, logs as mc_rtc writes them.
#include "snug/control/program_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "snug/control/internal/program_text.hpp"
#include "snug/core/check.hpp"
#include "snug/core/csv_cell.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/robot/dynamics.hpp"

namespace snug::control {
namespace {

using internal::format_header, internal::format_list, internal::quotable;

std::string time_from_start(double time) {
  const double seconds = std::floor(time + 5e-10);
  return fmt::format("{{sec: {:.0f}, nanosec: {:.0f}}}", seconds, std::round(std::max(0.0, time - seconds) * 1e9));
}

void put(std::string& bytes, const void* value, std::size_t size) {
  bytes.append(static_cast<const char*>(value), size);
}
void put_count(std::string& bytes, std::size_t count) {
  const auto value = static_cast<std::uint64_t>(count);
  put(bytes, &value, sizeof value);
}

constexpr double kFollows = 1.5e-4;  // rad (m), that a point may be passed by, of each joint
constexpr double kRounding = 1e-6;   // rad/s^2 (m/s^2)
constexpr int kPositionLength = 12;  // digits: a change in the tenth is 0.001 rad/s^2 over 8 ms
constexpr int kLooks = 8;            // between two points, beside those of the run

/// Where the joints are to be, how fast, and how they gain speed.
struct TrajectoryPoint {
  double time = 0.0;  ///< s
  robot::JointVector q, qd, qdd;
};

/// What joints do between two points that a controller interpolates by quintic polynomials.
struct QuinticState {
  robot::JointVector q, qd;
};

/// The polynomials from one point to the next, by the time from the first.
class Quintics {
 public:
  Quintics(const TrajectoryPoint& a, const TrajectoryPoint& b) : begin_(a), length_(b.time - a.time) {
    const double T = length_;
    const robot::JointVector d = b.q - a.q - T * a.qd - 0.5 * T * T * a.qdd;
    const robot::JointVector v = T * (b.qd - a.qd - T * a.qdd), w = T * T * (b.qdd - a.qdd);
    c3_ = (10.0 * d - 4.0 * v + 0.5 * w) / (T * T * T);
    c4_ = (-15.0 * d + 7.0 * v - w) / (T * T * T * T);
    c5_ = (6.0 * d - 3.0 * v + 0.5 * w) / (T * T * T * T * T);
  }
  [[nodiscard]] QuinticState at(double time) const {
    const TrajectoryPoint& a = begin_;
    const double t = time - a.time;
    QuinticState state;
    state.q = a.q + t * (a.qd + t * (0.5 * a.qdd + t * (c3_ + t * (c4_ + t * c5_))));
    state.qd = a.qd + t * (a.qdd + t * (3.0 * c3_ + t * (4.0 * c4_ + 5.0 * t * c5_)));
    return state;
  }
  /// Of all joints, at the ends or where a joint's acceleration turns.
  [[nodiscard]] double largest_acceleration() const {
    double most = 0.0;
    for (Eigen::Index j = 0; j < c3_.size(); ++j) {
      const auto look = [&](double t) {
        const double clamped = std::clamp(t, 0.0, length_);
        const double a = begin_.qdd[j] + clamped * (6.0 * c3_[j] + clamped * (12.0 * c4_[j] + 20.0 * clamped * c5_[j]));
        if (std::isfinite(a)) most = std::max(most, std::abs(a));
      };
      look(0.0);
      look(length_);
      const double root = std::sqrt(std::max(0.0, 144.0 * c4_[j] * c4_[j] - 360.0 * c3_[j] * c5_[j]));
      const double sum = 12.0 * c4_[j] + std::copysign(root, c4_[j]);  // of 30 c5 t^2 + 12 c4 t + 3 c3 = 0
      if (c5_[j] != 0.0) look(-sum / (60.0 * c5_[j]));
      if (sum != 0.0) look(-6.0 * c3_[j] / sum);
    }
    return most;
  }

 private:
  const TrajectoryPoint& begin_;
  double length_;
  robot::JointVector c3_, c4_, c5_;
};

/// A run changes its accelerations from tick to tick, which polynomials cannot: they swing beyond the largest. So
/// points are means over the tick before them. A mean's acceleration goes evenly from that of one tick to that of the
/// next, which is what a quintic between two points makes of it. It is half a tick later, and off by an acceleration
/// times tick^2 / 24: 0.04 mrad at 15 rad/s^2 and 8 ms.
std::vector<TrajectoryPoint> all_points(const JointRun& run, double tick) {
  const std::vector<JointSample>& samples = run.samples;
  const JointState& start = samples.front().before;
  const JointState& end = samples.back().after;
  SNUG_CHECK(end.qd.norm() < 1e-9, "a run ends at rest");
  const robot::JointVector rest = robot::JointVector::Zero(start.q.size());
  std::vector<TrajectoryPoint> points = {{samples.front().time, start.q - 0.5 * tick * start.qd, start.qd, rest}};
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const JointState& from = samples[i].before;
    const JointState& to = i + 1 < samples.size() ? samples[i + 1].before : end;
    const robot::JointVector qdd = (to.qd - from.qd) / tick;
    points.push_back(
        {samples[i].time + tick, 0.5 * (from.q + to.q) - tick * tick / 12.0 * qdd, 0.5 * (from.qd + to.qd), qdd});
  }
  points.push_back({samples.back().time + 2.0 * tick, end.q, rest, rest});
  return points;
}

/// How far a stretch between two points is beyond its limits; at most 0: within.
double excess_of(const std::vector<TrajectoryPoint>& all, std::size_t from, std::size_t to, const robot::ArmModel& arm,
                 double most_acceleration) {
  const Quintics way(all[from], all[to]);
  double excess = way.largest_acceleration() / most_acceleration - 1.0;
  for (std::size_t i = from; i < to; ++i) {
    for (int look = 0; look < kLooks; ++look) {
      const double time = all[i].time + (all[i + 1].time - all[i].time) * look / kLooks;
      const QuinticState state = way.at(time);
      if (look == 0) excess = std::max(excess, (state.q - all[i].q).cwiseAbs().maxCoeff() / kFollows - 1.0);
      for (Eigen::Index j = 0; j < state.qd.size(); ++j)
        excess = std::max(excess, std::abs(state.qd[j]) / arm.joints[static_cast<std::size_t>(j)].max_speed - 1.0);
    }
  }
  return excess;
}

/// The first of all points, the last, and between them as few as the limits allow, none farther from the next than
/// `stride`; all of them are within the limits.
std::vector<TrajectoryPoint> find_points(const JointRun& run, const robot::ArmModel& arm, double tick,
                                         std::size_t stride) {
  if (run.samples.empty()) return {};
  const std::vector<TrajectoryPoint> all = all_points(run, tick);
  double most = 0.0;
  for (const JointSample& sample : run.samples)
    most = std::max(most, (sample.after.qd - sample.before.qd).cwiseAbs().maxCoeff() / tick);
  most += kRounding;
  std::vector<TrajectoryPoint> points = {all.front()};
  for (std::size_t from = 0; from + 1 < all.size();) {
    std::size_t best = from + 1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t to = std::min(all.size() - 1, from + stride); to > from && least > 0.0; --to) {
      const double excess = excess_of(all, from, to, arm, most);
      if (excess >= least) continue;
      least = excess;
      best = to;
    }
    from = best;
    points.push_back(all[from]);
  }
  return points;
}

/// What a controller makes of the points, said in numbers.
std::string format_extremes(const std::vector<TrajectoryPoint>& points, const robot::ArmModel& arm) {
  double speed = 0.0, acceleration = 0.0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Quintics way(points[i], points[i + 1]);
    acceleration = std::max(acceleration, way.largest_acceleration());
    for (int look = 0; look <= kLooks; ++look) {
      const QuinticState state = way.at(points[i].time + (points[i + 1].time - points[i].time) * look / kLooks);
      for (Eigen::Index j = 0; j < state.qd.size(); ++j)
        speed = std::max(speed, std::abs(state.qd[j]) / arm.joints[static_cast<std::size_t>(j)].max_speed);
    }
  }
  return fmt::format("# by quintic interpolation: at most {:.1f} % of a joint's speed limit, {:.2f} rad/s^2\n",
                     100.0 * speed, acceleration);
}

LogColumn& add(std::vector<LogColumn>& log, const std::string& name, std::size_t samples) {
  log.push_back({name, {}, {}});
  log.back().numbers.reserve(samples);
  return log.back();
}

}  // namespace

std::string format_ros_trajectory(const JointRun& run, const RobotProgram& program, double period) {
  const double tick = program.plan.settings.tick;
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::round(period / tick)));
  const std::vector<TrajectoryPoint> points = find_points(run, program.arm, tick, stride);
  std::string text = format_header(program, "rad, rad/s, rad/s^2, s; payloads in kg and m");
  text += format_extremes(points, program.arm);
  text += "# trajectory_msgs/JointTrajectory\nheader:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: ''\njoint_names:\n";
  for (const robot::Joint& joint : program.arm.joints) text += "  - " + joint.name + "\n";
  text += points.empty() ? "points: []\n" : "points:\n";
  for (const TrajectoryPoint& point : points) {
    text += fmt::format("  - positions: {}\n    velocities: {}\n    accelerations: {}\n    time_from_start: {}\n",
                        format_list(point.q, kPositionLength), format_list(point.qd), format_list(point.qdd),
                        time_from_start(point.time));
  }
  std::string switches;
  for (std::size_t i = 0; i < run.samples.size(); ++i) {
    const JointSample& sample = run.samples[i];
    const bool is_same = i > 0 && sample.io.vacuum == run.samples[i - 1].io.vacuum &&
                         sample.io.blow_off == run.samples[i - 1].io.blow_off;
    if (is_same || sample.row < 0) continue;
    switches +=
        fmt::format("  - {{time_from_start: {}, vacuum: {}, blow_off: {}, row: {}, waypoint: \"{}\"}}\n",
                    time_from_start(sample.time + 0.5 * tick), sample.io.vacuum, sample.io.blow_off, sample.row + 1,
                    quotable(motion::name_of(program.plan.program.waypoints[static_cast<std::size_t>(sample.row)])));
  }
  text += "# no part of the message: what the outputs do, and from which time_from_start of the trajectory on\n";
  return text + (switches.empty() ? "io: []\n" : "io:\n" + switches);
}

std::vector<LogColumn> make_log(const JointRun& run, const robot::ArmModel& arm, const Vector3& gravity_W) {
  const std::size_t count = run.samples.size();
  std::vector<LogColumn> log;
  const auto number = [&](const std::string& name, auto value) {
    LogColumn& column = add(log, name, count);
    for (const JointSample& sample : run.samples) column.numbers.push_back(value(sample));
  };
  number("t", [](const JointSample& s) { return s.time; });
  const auto joints = [&](const char* name, auto value) {
    for (Eigen::Index j = 0; j < arm.joint_count(); ++j) {
      number(fmt::format("{}_{}", name, j), [&](const JointSample& s) { return value(s)[j]; });
    }
  };
  std::vector<robot::JointVector> torques;
  for (const JointSample& s : run.samples) {
    torques.push_back(robot::inverse_dynamics(arm, {s.before.q, s.before.qd, s.after.qdd}, Wrench{}, gravity_W));
  }
  joints("qIn", [](const JointSample& s) -> const robot::JointVector& { return s.before.q; });
  joints("alphaIn", [](const JointSample& s) -> const robot::JointVector& { return s.before.qd; });
  for (Eigen::Index j = 0; j < arm.joint_count(); ++j) {
    LogColumn& column = add(log, fmt::format("tauIn_{}", j), count);
    for (const robot::JointVector& tau : torques) column.numbers.push_back(tau[j]);
  }
  joints("qOut", [](const JointSample& s) -> const robot::JointVector& { return s.after.q; });
  joints("alphaOut", [](const JointSample& s) -> const robot::JointVector& { return s.after.qd; });
  const auto pose = [&](const std::string& name, auto value) {
    const char* quat[] = {"w", "x", "y", "z"};
    for (int k = 0; k < 4; ++k) {
      number(name + "_orientation_" + quat[k], [&](const JointSample& s) {
        const Quaternion inverse = Quaternion(value(s).R).conjugate();
        return k == 0 ? inverse.w() : inverse.vec()[k - 1];
      });
    }
    for (int k = 0; k < 3; ++k) {
      number(name + "_position_" + quat[k + 1], [&](const JointSample& s) { return value(s).p[k]; });
    }
  };
  pose(arm.name + "_FloatingBase", [&](const JointSample&) -> const Pose& { return arm.X_WB; });
  pose("tool", [](const JointSample& s) -> const Pose& { return s.tool.X_WE; });
  number("vacuum", [](const JointSample& s) { return s.io.vacuum ? 1.0 : 0.0; });
  number("program_row", [](const JointSample& s) { return static_cast<double>(s.row); });
  LogColumn& states = add(log, "Executor_Main", 0);
  for (const JointSample& sample : run.samples) states.texts.emplace_back(sample.state);
  return log;
}

std::string format_log_csv(const std::vector<LogColumn>& log) {
  std::string text;
  std::size_t rows = 0;
  for (const LogColumn& column : log) {
    text += (text.empty() ? "" : ";") + csv_cell(column.name);
    rows = std::max({rows, column.numbers.size(), column.texts.size()});
  }
  text += '\n';
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t k = 0; k < log.size(); ++k) {
      if (k > 0) text += ';';
      const LogColumn& column = log[k];
      if (!column.texts.empty()) {
        text += column.texts[i];
      } else if (std::isfinite(column.numbers[i])) {
        fmt::format_to(std::back_inserter(text), "{}", column.numbers[i]);
      }
    }
    text += '\n';
  }
  return text;
}

std::string format_log_flat(const std::vector<LogColumn>& log) {
  static_assert(std::endian::native == std::endian::little, "the form is little-endian");
  std::string bytes;
  put_count(bytes, log.size());
  for (const LogColumn& column : log) {
    const bool is_numeric = column.texts.empty();
    bytes += static_cast<char>(is_numeric ? 1 : 0);
    put_count(bytes, column.name.size());
    bytes += column.name;
    put_count(bytes, is_numeric ? column.numbers.size() : column.texts.size());
    if (is_numeric) put(bytes, column.numbers.data(), column.numbers.size() * sizeof(double));
    for (const std::string& entry : column.texts) {
      put_count(bytes, entry.size());
      bytes += entry;
    }
  }
  return bytes;
}

}  // namespace snug::control
