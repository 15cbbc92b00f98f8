// Programs through the joints for other programs: ROS trajectories, logs as mc_rtc writes them.
#include "snug/control/program_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

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

LogColumn& add(std::vector<LogColumn>& log, const std::string& name, std::size_t samples) {
  log.push_back({name, {}, {}});
  log.back().numbers.reserve(samples);
  return log.back();
}

}  // namespace

std::string format_ros_trajectory(const JointRun& run, const RobotProgram& program, double period) {
  const double tick = program.plan.settings.tick;
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::round(period / tick)));
  std::string text = format_header(program, "rad, rad/s, rad/s^2, s; payloads in kg and m");
  text += "# trajectory_msgs/JointTrajectory\nheader:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: ''\njoint_names:\n";
  for (const robot::Joint& joint : program.arm.joints) text += "  - " + joint.name + "\n";
  text += "points:\n";
  const auto point = [&](const robot::JointVector& q, const robot::JointVector& qd, const robot::JointVector& qdd,
                         double time) {
    text += fmt::format("  - positions: {}\n    velocities: {}\n    accelerations: {}\n    time_from_start: {}\n",
                        format_list(q), format_list(qd), format_list(qdd), time_from_start(time));
  };
  for (std::size_t i = 0; i < run.samples.size(); i += stride) {
    const JointState& joints = run.samples[i].before;
    point(joints.q, joints.qd, joints.qdd, run.samples[i].time);
  }
  if (!run.samples.empty()) {
    const JointState& end = run.samples.back().after;
    SNUG_CHECK(end.qd.norm() < 1e-9, "a run ends at rest");
    const robot::JointVector rest = robot::JointVector::Zero(end.q.size());
    point(end.q, rest, rest, run.samples.back().time + tick);
  }
  text += "---\n# what the outputs do, and from which time_from_start of the trajectory on\nio:\n";
  for (std::size_t i = 0; i < run.samples.size(); ++i) {
    const JointSample& sample = run.samples[i];
    const bool is_same = i > 0 && sample.io.vacuum == run.samples[i - 1].io.vacuum &&
                         sample.io.blow_off == run.samples[i - 1].io.blow_off;
    if (is_same || sample.row < 0) continue;
    text +=
        fmt::format("  - {{time_from_start: {}, vacuum: {}, blow_off: {}, row: {}, waypoint: \"{}\"}}\n",
                    time_from_start(sample.time), sample.io.vacuum, sample.io.blow_off, sample.row + 1,
                    quotable(motion::name_of(program.plan.program.waypoints[static_cast<std::size_t>(sample.row)])));
  }
  return text;
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
