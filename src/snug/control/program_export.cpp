// Programs in the languages of real robots: URScript, ROS trajectories, logs as mc_rtc writes them.
#include "snug/control/program_export.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "snug/core/check.hpp"
#include "snug/core/csv_cell.hpp"
#include "snug/core/input_error.hpp"
#include "snug/robot/dynamics.hpp"

namespace snug::control {
namespace {

constexpr double kFlyBy = 0.05;  ///< m, precision from which a row is passed without a stop

Pose pose_of(const robot::ArmModel& arm, const std::string& link) {
  const int found = robot::find_link(arm, link);
  if (found < 0) {
    throw InputError(arm.name, "link", "no link '" + link + "'", "the frames 'base' and 'tool0' of a UR robot");
  }
  return robot::link_pose(arm, robot::forward(arm, robot::JointVector::Zero(arm.joint_count())), found);
}

std::string ur_pose(const Pose& X) {
  const Vector3 turn = log_rotation(X.R);
  return fmt::format("p[{:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}]", X.p.x(), X.p.y(), X.p.z(), turn.x(), turn.y(),
                     turn.z());
}

std::string list_of(const robot::JointVector& values) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) text += fmt::format("{}{:.9g}", i == 0 ? "" : ", ", values[i]);
  return text + "]";
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

std::string format_urscript(const motion::PreparedProgram& plan, const robot::ArmModel& arm, const Pose& X_WE_start,
                            const UrScriptOptions& options) {
  const robot::ArmPose zero = robot::forward(arm, robot::JointVector::Zero(arm.joint_count()));
  const Pose X_BaseW = pose_of(arm, "base").inverse();
  std::string text = "def snug_program():\n";
  text += fmt::format("  set_tcp({})\n", ur_pose(pose_of(arm, "tool0").inverse() * zero.X_WE));
  Pose X_WE = X_WE_start;
  motion::IO io;
  for (std::size_t i = 0; i < plan.program.waypoints.size(); ++i) {
    const motion::Waypoint& row = plan.program.waypoints[i];
    const motion::MotionLimits& limits = plan.row_limits[i];
    text += fmt::format("  # {} {}\n", i + 1, row.name);
    const auto output = [&](int number, bool value) {
      text += fmt::format("  set_standard_digital_out({}, {})\n", number, value ? "True" : "False");
    };
    if (i == 0 || row.io.vacuum != io.vacuum) output(options.vacuum_output, row.io.vacuum);
    if (i == 0 || row.io.blow_off != io.blow_off) output(options.blow_off_output, row.io.blow_off);
    const bool waits = row.io.vacuum != io.vacuum || (row.io.blow_off && !io.blow_off);
    if (waits && plan.settings.vacuum_wait > 0.0) text += fmt::format("  sleep({:.3f})\n", plan.settings.vacuum_wait);
    const motion::LspbSegment segment(X_WE, row.X_WE, limits);
    const auto& translation = segment.translation();
    const motion::LspbProfile fastest =
        motion::plan_fastest_profile(translation.length, limits.max_speed, limits.max_acceleration);
    const bool turn_decides = segment.duration() > fastest.duration * (1.0 + 1e-9);
    const bool has_next = i + 1 < plan.program.waypoints.size();
    const bool blends =
        has_next && limits.precision >= kFlyBy && plan.program.waypoints[i + 1].io.vacuum == row.io.vacuum;
    text += fmt::format("  movel({}, a={:.3f}, v={:.3f}{}{})\n", ur_pose(X_BaseW * row.X_WE), limits.max_acceleration,
                        limits.max_speed, turn_decides ? fmt::format(", t={:.3f}", segment.duration()) : "",
                        blends ? fmt::format(", r={:.3f}", std::min(limits.precision, 0.4 * translation.length)) : "");
    X_WE = row.X_WE;
    io = row.io;
  }
  return text + "end\nsnug_program()\n";
}

std::string format_ros_trajectory(const JointRun& run, const robot::ArmModel& arm, double tick, double period) {
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::round(period / tick)));
  std::string text =
      "# trajectory_msgs/JointTrajectory\nheader:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: ''\njoint_names:\n";
  for (const robot::Joint& joint : arm.joints) text += "  - " + joint.name + "\n";
  text += "points:\n";
  const auto point = [&](const JointState& joints, double time) {
    const double seconds = std::floor(time + 5e-10);
    text += fmt::format("  - positions: {}\n    velocities: {}\n    accelerations: {}\n", list_of(joints.q),
                        list_of(joints.qd), list_of(joints.qdd));
    text += fmt::format("    time_from_start: {{sec: {:.0f}, nanosec: {:.0f}}}\n", seconds,
                        std::round(std::max(0.0, time - seconds) * 1e9));
  };
  for (std::size_t i = 0; i < run.samples.size(); i += stride) point(run.samples[i].before, run.samples[i].time);
  if (!run.samples.empty()) point(run.samples.back().after, run.samples.back().time + tick);
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
