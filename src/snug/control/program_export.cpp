// Programs in the languages of real robots: URScript, ROS trajectories, logs as mc_rtc writes them.
#include "snug/control/program_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "snug/core/check.hpp"
#include "snug/core/csv_cell.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/robot/dynamics.hpp"
#include "snug/robot/ur_inverse.hpp"

namespace snug::control {
namespace {

constexpr std::size_t kLongestNote = 200;
constexpr double kFlyBy = 0.05;  ///< m, precision from which a row is passed without a stop
// Of the shorter of the moves on either side: two blends on one move then leave a tenth of it between them. (A
// controller skips a waypoint whose blend overlaps another.)
constexpr double kBlendShare = 0.45;
constexpr double kLeastBlend = 1e-3;  ///< m, below it a blend is a stop
// A row nearer than both to the one before needs no move; a UR10 repeats poses to 0.1 mm.
constexpr double kNoWay = 5e-5;   ///< m
constexpr double kNoTurn = 1e-4;  ///< rad
// What movej has when nothing is said.
constexpr double kJointAcceleration = 1.4;  ///< rad/s^2
constexpr double kJointSpeed = 1.05;        ///< rad/s
constexpr std::array kUrJoints = {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                  "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};

[[noreturn]] void refuse_arm(const robot::ArmModel& arm, const std::string& got) {
  throw InputError(arm.name, "urscript", got, "the URDF of a UR; for other arms: --format ros-trajectory");
}

/// URScript runs on the controllers of one maker: an arm with other axes or other joint names has none.
void check_is_ur(const robot::ArmModel& arm) {
  if (arm.joint_count() != static_cast<int>(kUrJoints.size()))
    refuse_arm(arm, fmt::format("{} joints", arm.joint_count()));
  for (std::size_t i = 0; i < kUrJoints.size(); ++i) {
    if (!arm.joints[i].name.ends_with(kUrJoints[i]))
      refuse_arm(arm, fmt::format("joint '{}' where a UR has '{}'", arm.joints[i].name, kUrJoints[i]));
  }
  if (!robot::find_ur_geometry(arm)) refuse_arm(arm, "axes that do not lie as those of a UR");
}

Pose pose_of(const robot::ArmModel& arm, const std::string& link) {
  const int found = robot::find_link(arm, link);
  if (found < 0) refuse_arm(arm, "no link '" + link + "'");
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

/// Whether the tool holds its pose until the vacuum has changed.
bool waits(const motion::IO& before, const motion::IO& io) {
  return io.vacuum != before.vacuum || (io.blow_off && !before.blow_off);
}

/// A row as the robot's controller gets it.
struct ScriptRow {
  std::size_t row = 0;
  motion::IO before;  ///< switches until then
  bool moves = false;
  double length = 0.0;    ///< m
  double duration = 0.0;  ///< s, from stop to stop
  bool turn_decides = false;
  double blend = 0.0;  ///< m
};

std::vector<ScriptRow> plan_rows(const motion::PreparedProgram& plan, const Pose& X_WE_start) {
  std::vector<ScriptRow> rows;
  Pose X_WE = X_WE_start;
  motion::IO io;
  for (std::size_t i = 0; i < plan.program.waypoints.size(); ++i) {
    const motion::Waypoint& waypoint = plan.program.waypoints[i];
    const motion::MotionLimits& limits = plan.row_limits[i];
    const motion::LspbSegment segment(X_WE, plan.X_WE[i], limits);
    ScriptRow row;
    row.row = i;
    row.before = io;
    row.length = segment.translation().length;
    row.moves = row.length >= kNoWay || segment.rotation().length >= kNoTurn;
    if (row.moves) {
      row.duration = segment.duration();
      const motion::LspbProfile fastest =
          motion::plan_fastest_profile(row.length, limits.max_speed, limits.max_acceleration);
      row.turn_decides = segment.duration() > fastest.duration * (1.0 + 1e-9);
      X_WE = plan.X_WE[i];
    }
    if (row.moves || i == 0 || waypoint.io != io) rows.push_back(row);
    io = waypoint.io;
  }
  for (std::size_t k = 0; k + 1 < rows.size(); ++k) {
    const ScriptRow& next = rows[k + 1];
    const motion::IO& after = plan.program.waypoints[next.row].io;
    if (!rows[k].moves || !next.moves || next.before.vacuum != after.vacuum || next.before.blow_off != after.blow_off)
      continue;
    const double precision = plan.row_limits[rows[k].row].precision;
    const double blend = std::min(precision, kBlendShare * std::min(rows[k].length, next.length));
    if (precision >= kFlyBy && blend >= kLeastBlend) rows[k].blend = blend;
  }
  return rows;
}

/// set_payload of the gripper and what it carries: kg, and the centre of mass in tool0.
std::string payload(const RobotProgram& program, const std::optional<CarriedLoad>& load) {
  const int tool0 = robot::find_link(program.arm, "tool0");
  const SpatialInertia gripper = robot::distal_inertia(program.arm, tool0);
  double mass = gripper.mass;
  Vector3 moment = gripper.mass * gripper.com;
  if (load) {
    const Pose X_TE = program.arm.links[static_cast<std::size_t>(tool0)].X_SL.inverse() * program.arm.X_SE;
    mass += load->mass;
    moment += load->mass * (X_TE * load->com_E);
  }
  const Vector3 com = mass > 0.0 ? Vector3(moment / mass) : Vector3(Vector3::Zero());
  return fmt::format("set_payload({:.4f}, [{:.5f}, {:.5f}, {:.5f}])\n", mass, com.x(), com.y(), com.z());
}

/// Pose of the cup's TCP in tool0, in the robot's notation.
std::string tcp_of(const RobotProgram& program) {
  const Pose X_WE = robot::forward_tool(program.arm, robot::JointVector::Zero(program.arm.joint_count()));
  return ur_pose(pose_of(program.arm, "tool0").inverse() * X_WE);
}

/// Comments: what it was made of, units, tool, and the loads that it carries with the rows they are carried on the way
/// to.
std::string header(const RobotProgram& program, const std::string& units) {
  std::string text;
  for (const std::string& note : program.notes) text += "# " + printable(note, kLongestNote) + "\n";
  text += "# units: " + units + "\n";
  text += fmt::format("# tool: {} (TCP in tool0: position, rotation vector)\n", tcp_of(program));
  text += "# payload table, gripper and box, centre of mass in tool0:\n";
  const auto line = [&](const std::string& rows, const std::optional<CarriedLoad>& load) {
    std::string words = payload(program, load);
    words.pop_back();
    text += fmt::format("#   {:<16} {}\n", rows, words);
  };
  line("gripper alone", std::nullopt);
  for (std::size_t i = 0; i < program.loads.size();) {
    std::size_t end = i + 1;
    while (end < program.loads.size() && program.loads[end] == program.loads[i]) ++end;
    if (program.loads[i]) line(fmt::format("rows {}-{}", i + 1, end), program.loads[i]);
    i = end;
  }
  return text;
}

const char* script_word(bool value) { return value ? "True" : "False"; }

/// Text that can stand between the quotes of a script or of YAML.
std::string quotable(const std::string& text) {
  std::string kept;
  for (const char c : text) kept += c == '"' || c == '\\' ? '\'' : c;
  return kept;
}

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

UrScript format_urscript(const RobotProgram& program, const UrScriptOptions& options) {
  check_is_ur(program.arm);
  const motion::PreparedProgram& plan = program.plan;
  const std::vector<motion::Waypoint>& waypoints = plan.program.waypoints;
  SNUG_CHECK(program.loads.size() == waypoints.size(), "one load for each row");
  const Pose X_BaseW = pose_of(program.arm, "base").inverse();
  const std::string tcp = tcp_of(program);
  const Pose X_WE_start = robot::forward_tool(program.arm, program.q_start);
  const std::vector<ScriptRow> rows = plan_rows(plan, X_WE_start);

  UrScript script;
  std::string body;
  for (const ScriptRow& row : rows) {
    const motion::Waypoint& waypoint = waypoints[row.row];
    const motion::MotionLimits& limits = plan.row_limits[row.row];
    const bool is_first = row.row == 0;
    body += fmt::format("  # {} {}\n", row.row + 1, motion::name_of(waypoint));
    const auto output = [&](int number, bool before, bool value) {
      if (is_first || before != value)
        body += fmt::format("  set_standard_digital_out({}, {})\n", number, script_word(value));
    };
    output(options.vacuum_output, row.before.vacuum, waypoint.io.vacuum);
    output(options.blow_off_output, row.before.blow_off, waypoint.io.blow_off);
    if (waypoint.io.vacuum != row.before.vacuum) {
      body += fmt::format("  snug_wait_for_vacuum({}, \"{}\")\n", script_word(waypoint.io.vacuum),
                          quotable(motion::name_of(waypoint)));
      body += "  " + payload(program, program.loads[row.row]);
      script.nominal_duration += plan.settings.vacuum_wait;
    } else if (waits(row.before, waypoint.io) && plan.settings.vacuum_wait > 0.0) {  // a puff: nothing to sense
      body += fmt::format("  sleep({:.3f})\n", plan.settings.vacuum_wait);
      script.nominal_duration += plan.settings.vacuum_wait;
    }
    if (!row.moves) continue;
    body += fmt::format("  movel({}, a={:.5f}, v={:.5f}{}{})\n", ur_pose(X_BaseW * plan.X_WE[row.row]),
                        limits.max_acceleration, limits.max_speed,
                        row.turn_decides ? fmt::format(", t={:.3f}", row.duration) : "",
                        row.blend > 0.0 ? fmt::format(", r={:.4f}", row.blend) : "");
    script.nominal_duration += row.duration;
    ++script.moves;
  }
  script.simulated_duration = program.simulated_duration > 0.0
                                  ? program.simulated_duration
                                  : motion::compute_duration(plan, X_WE_start, motion::kLongestProgram);

  std::string& text = script.text;
  text = header(program, "m, m/s, m/s^2, rad, s; payloads in kg and m; poses in the controller's base frame");
  text += "def snug_program():\n";
  text +=
      fmt::format("  # {:.1f} s nominal from the start pose: {} moves from stop to stop (blends make them shorter),\n",
                  script.nominal_duration, script.moves);
  text += fmt::format("  # {} s at each change of vacuum. Simulated: {:.1f} s, {}.\n", plan.settings.vacuum_wait,
                      script.simulated_duration, program.simulated_with);
  text += fmt::format(
      "  def snug_wait_for_vacuum(is_wanted, place):\n"
      "    local waited = 0.0\n"
      "    while get_standard_digital_in({}) != is_wanted:\n"
      "      if waited > {:.3f}:\n"
      "        textmsg(\"snug: the vacuum did not change before \", place)\n"
      "        popup(\"the vacuum did not change\", title=\"snug\", error=True, blocking=True)\n"
      "        halt\n"
      "      end\n"
      "      sync()\n"
      "      waited = waited + get_steptime()\n"
      "    end\n"
      "  end\n",
      options.vacuum_input, options.vacuum_timeout);
  text += fmt::format("  set_tcp({})\n", tcp);
  text += "  " + payload(program, std::nullopt);
  text += fmt::format("  movej({}, a={}, v={})\n", list_of(program.q_start), kJointAcceleration, kJointSpeed);
  text += body + "end\nsnug_program()\n";
  return script;
}

std::string format_ros_trajectory(const JointRun& run, const RobotProgram& program, double period) {
  const double tick = program.plan.settings.tick;
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::round(period / tick)));
  std::string text = header(program, "rad, rad/s, rad/s^2, s; payloads in kg and m");
  text += "# trajectory_msgs/JointTrajectory\nheader:\n  stamp: {sec: 0, nanosec: 0}\n  frame_id: ''\njoint_names:\n";
  for (const robot::Joint& joint : program.arm.joints) text += "  - " + joint.name + "\n";
  text += "points:\n";
  const auto point = [&](const robot::JointVector& q, const robot::JointVector& qd, const robot::JointVector& qdd,
                         double time) {
    text += fmt::format("  - positions: {}\n    velocities: {}\n    accelerations: {}\n    time_from_start: {}\n",
                        list_of(q), list_of(qd), list_of(qdd), time_from_start(time));
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
