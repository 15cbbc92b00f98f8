// compare_robot: what of a UR does not fit the robot of a scenario, and what is to be set.
#include "snug/remote_ur/compare_robot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "snug/calibration/dh.hpp"
#include "snug/core/rng.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/served_ur/ur_arm.hpp"

namespace snug::remote_ur {
namespace {

constexpr int kPositions = 200;       // joint positions of which the kinematics are compared
constexpr double kLimitSlack = 1e-3;  // rad, rad/s: rounding of limits in URDFs

calibration::DhTable table_of(const ur::RobotFacts& robot) {
  calibration::DhTable table;
  for (std::size_t j = 0; j < 6; ++j) table[j] = {robot.dh_theta[j], robot.dh_d[j], robot.dh_a[j], robot.dh_alpha[j]};
  return table;
}

double deviation(const ur::RobotFacts& robot, const served_ur::UrArm& arm) {
  const calibration::DhTable table = table_of(robot);
  Rng rng(1);
  double most = 0.0;
  for (int i = 0; i < kPositions; ++i) {
    ur::Values6 q{};
    for (double& angle : q) angle = rng.uniform(-std::numbers::pi, std::numbers::pi);
    const Vector3 p_BaseEo = (calibration::forward(table, served_ur::to_vector(q)) * arm.tool()).p;
    const double distance = (p_BaseEo - (arm.forward(q) * arm.tool()).p).norm();
    if (!std::isfinite(distance)) return std::numeric_limits<double>::infinity();
    most = std::max(most, distance);
  }
  return most;
}

std::string in_mm(double x, double y, double z) {
  const auto tenths = [](double metres) { return 0.1 * std::round(1e4 * metres) + 0.0; };  // no -0.0
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) mm", tenths(x), tenths(y), tenths(z));
}

class Comparison {
 public:
  Comparison(const RobotReport& robot, const model::Scenario& scenario, const Tolerances& tolerances)
      : robot_(robot), tolerances_(tolerances), model_(robot::load_arm(scenario)), arm_(model_, scenario) {}

  std::vector<Finding> run() {
    compare_modes();
    compare_kinematics();
    compare_limits();
    compare_tcp();
    compare_payload();
    return std::move(findings_);
  }

 private:
  void add(const char* what, bool fits, std::string robot, std::string expected, std::string remedy) {
    if (fits) remedy.clear();
    findings_.push_back(
        {what, fits ? Verdict::Fits : Verdict::Differs, std::move(robot), std::move(expected), std::move(remedy)});
  }
  void add_unknown(const char* what, std::string expected, std::string remedy) {
    findings_.push_back({what, Verdict::Unknown, "not told", std::move(expected), std::move(remedy)});
  }

  void compare_modes() {
    const ur::PrimaryState& state = robot_.state;
    add("safety mode", state.safety_mode == 1, ur::safety_mode_name(state.safety_mode), "NORMAL",
        state.safety_mode == 3 ? "find out why the robot stopped, then `unlock protective stop`"
                               : "release the stop at the teach pendant");
    add("robot mode", state.robot_mode == 7, ur::robot_mode_name(state.robot_mode), "RUNNING",
        "switch the power on and release the brakes");
    if (robot_.is_in_remote_control) {
      add("remote control", *robot_.is_in_remote_control, *robot_.is_in_remote_control ? "yes" : "no", "yes",
          "switch the teach pendant from Local to Remote");
    } else {
      add_unknown("remote control", "yes", "nothing on a CB3; else switch the teach pendant from Local to Remote");
    }
    const bool has_program = state.is_program_running || state.is_program_paused;
    add("program", !has_program,
        state.is_program_paused ? "paused"
        : has_program           ? "running"
                                : "none",
        "none", "stop the program");
    add("speed slider", state.speed_slider > 0.999, fmt::format("{:.0f} %", 100.0 * state.speed_slider), "100 %",
        "set the slider, unless the robot should be slower than planned");
  }

  void compare_kinematics() {
    const double most = deviation(robot_.state.robot, arm_);
    add("kinematics", most <= tolerances_.position, fmt::format("tool's end off by up to {:.3f} mm", 1e3 * most),
        fmt::format("at most {:.3f} mm", 1e3 * tolerances_.position),
        "name the URDF of this robot's own calibration in `robot.urdf`");
  }

  void compare_limits() {
    const ur::RobotFacts& has = robot_.state.robot;
    const ur::RobotFacts& needs = arm_.facts();
    for (std::size_t j = 0; j < 6; ++j) {
      const bool reaches =
          has.joint_min[j] <= needs.joint_min[j] + kLimitSlack && has.joint_max[j] >= needs.joint_max[j] - kLimitSlack;
      if (!reaches) {
        add("joint range", false, fmt::format("joint {}: {:.3f} .. {:.3f} rad", j, has.joint_min[j], has.joint_max[j]),
            fmt::format("{:.3f} .. {:.3f} rad", needs.joint_min[j], needs.joint_max[j]),
            "narrow the joint in the URDF, or widen it in the safety configuration");
      }
      if (!(has.joint_speed[j] >= needs.joint_speed[j] - kLimitSlack)) {
        add("joint speed", false, fmt::format("joint {}: {:.3f} rad/s", j, has.joint_speed[j]),
            fmt::format("{:.3f} rad/s", needs.joint_speed[j]),
            "lower the joint's velocity in the URDF, or raise it in the safety configuration");
      }
    }
    if (findings_.back().what != "joint range" && findings_.back().what != "joint speed")
      add("joint limits", true, "as wide and as fast", "those of the URDF", "");
  }

  void compare_tcp() {
    const Pose X_FT = served_ur::to_pose(robot_.state.tcp_offset);
    const ur::Values6 wanted = served_ur::to_values(arm_.tool());
    const double distance = (X_FT.p - arm_.tool().p).norm();
    const double angle = log_rotation(X_FT.R.transpose() * arm_.tool().R).norm();
    const ur::Values6& has = robot_.state.tcp_offset;
    add("TCP", distance <= tolerances_.position && angle <= tolerances_.angle,
        fmt::format("{}, turned by {:.2f} degrees", in_mm(has[0], has[1], has[2]), 180.0 / std::numbers::pi * angle),
        in_mm(wanted[0], wanted[1], wanted[2]),
        fmt::format("set_tcp(p[{:.5f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}])", wanted[0], wanted[1], wanted[2],
                    wanted[3], wanted[4], wanted[5]));
  }

  void compare_payload() {
    const SpatialInertia& tool = arm_.tool_load();
    const std::string expected =
        fmt::format("{:.3f} kg at {}", tool.mass, in_mm(tool.com.x(), tool.com.y(), tool.com.z()));
    const std::string remedy = fmt::format("set_payload({:.3f}, [{:.4f}, {:.4f}, {:.4f}]): the gripper without a box",
                                           tool.mass, tool.com.x(), tool.com.y(), tool.com.z());
    if (!robot_.payload) return add_unknown("payload", expected, remedy);
    std::string robot = fmt::format("{:.3f} kg", *robot_.payload);
    bool fits = std::abs(*robot_.payload - tool.mass) <= tolerances_.mass;
    if (robot_.payload_cog) {
      const ur::Values3& cog = *robot_.payload_cog;
      fits = fits && (Vector3(cog[0], cog[1], cog[2]) - tool.com).norm() <= tolerances_.centre;
      robot += " at " + in_mm(cog[0], cog[1], cog[2]);
    }
    add("payload", fits, std::move(robot), expected, remedy);
  }

  const RobotReport& robot_;
  const Tolerances& tolerances_;
  robot::ArmModel model_;
  served_ur::UrArm arm_;
  std::vector<Finding> findings_;
};

}  // namespace

double kinematic_deviation(const ur::RobotFacts& robot, const model::Scenario& scenario) {
  const robot::ArmModel model = robot::load_arm(scenario);
  return deviation(robot, served_ur::UrArm(model, scenario));
}

std::vector<Finding> compare_robot(const RobotReport& robot, const model::Scenario& scenario,
                                   const Tolerances& tolerances) {
  return Comparison(robot, scenario, tolerances).run();
}

}  // namespace snug::remote_ur
