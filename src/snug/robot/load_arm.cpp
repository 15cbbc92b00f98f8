// load_arm: the arm that a scenario names, checked against what the scenario says about it.
#include "snug/robot/load_arm.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/robot/dynamics.hpp"
#include "snug/robot/internal/inertia.hpp"

namespace snug::robot {
namespace {

/// Complains about something the scenario says of the arm.
class ScenarioChecks {
 public:
  ScenarioChecks(const model::Scenario& scenario, const ArmModel& arm) : scenario_(scenario), arm_(arm) {
    for (const Link& link : arm.links) names_.push_back(link.name);
  }

  void check_link(const std::string& key, const std::string& name) const {
    if (find_link(arm_, name) >= 0) return;
    const std::string_view nearest = find_nearest(name, names_);
    throw InputError(scenario_.source_name, "robot." + key, "'" + name + "'",
                     nearest.empty()
                         ? "a link of " + scenario_.robot->urdf
                         : "a link of " + scenario_.robot->urdf + ", nearest is '" + std::string(nearest) + "'");
  }

  void check_joints(const std::string& key, const std::vector<double>& q) const {
    if (q.size() != arm_.joints.size())
      throw InputError(scenario_.source_name, "robot." + key, std::to_string(q.size()) + " numbers",
                       std::to_string(arm_.joints.size()) + ", one for each joint of " + scenario_.robot->urdf);
    for (std::size_t i = 0; i < q.size(); ++i)
      if (!(arm_.joints[i].lower <= q[i] && q[i] <= arm_.joints[i].upper))
        throw InputError(scenario_.source_name, "robot." + key, std::to_string(q[i]) + " for " + arm_.joints[i].name,
                         std::to_string(arm_.joints[i].lower) + " to " + std::to_string(arm_.joints[i].upper));
  }

 private:
  const model::Scenario& scenario_;
  const ArmModel& arm_;
  std::vector<std::string> names_;
};

constexpr const char* kMountedTool = "E";

/// The gripper that the file does not have: a link E on the link that is the tool frame, of the mass of the scenario's
/// tool, evenly along the way there. What it consists of is drawn and touched as the scenario's tool.
void mount_tool(const model::Scenario& scenario, const Pose& X_LE, ArmModel& arm) {
  if (find_link(arm, kMountedTool) >= 0)
    throw InputError(scenario.source_name, "robot.tool_pose", "a pose of E, though there is a link 'E'",
                     "no 'tool_pose': " + scenario.robot->urdf + " has a gripper");
  Link tool;
  tool.name = kMountedTool;
  tool.parent = arm.tool_link;
  tool.segment = arm.last_segment();
  tool.X_SL = arm.X_SE * X_LE;
  if (scenario.tool) {
    const Vector3 p_EL = X_LE.inverse().p;
    const Matrix3 rod = p_EL.squaredNorm() * Matrix3::Identity() - p_EL * p_EL.transpose();
    tool.inertia = {scenario.tool->mass, 0.5 * p_EL, scenario.tool->mass / 12.0 * rod};
    internal::add_inertia(tool.inertia, tool.X_SL, arm.segments.back());
  }
  arm.tool_link = static_cast<int>(arm.links.size());
  arm.X_SE = tool.X_SL;
  arm.links.push_back(std::move(tool));
}

/// The arm with what the scenario says about it, its efforts as the file has them.
ArmModel load_as_written(const model::Scenario& scenario) {
  if (!scenario.robot)
    throw InputError(scenario.source_name, "robot", "",
                     "a 'robot' in the scenario, to run through the joints of an arm");
  const model::RobotParams& robot = *scenario.robot;
  ArmModel arm = load_urdf(urdf_path(scenario), robot.tool_frame);
  arm.X_WB = robot.X_WB;
  if (robot.X_LE) mount_tool(scenario, *robot.X_LE, arm);
  const ScenarioChecks checks(scenario, arm);
  checks.check_link("flange_frame", robot.flange_frame);
  checks.check_link("sensor_frame", robot.sensor_frame);
  checks.check_joints("posture", robot.posture);
  if (!robot.joints_start.empty()) checks.check_joints("joints_start", robot.joints_start);
  for (const model::SelfCollisionPair& pair : robot.self_collision) {
    checks.check_link("self_collision.links", pair.link_a);
    checks.check_link("self_collision.links", pair.link_b);
  }
  return arm;
}

/// A joint that cannot hold the arm by what its file says, or has the number of one that cannot: who wrote it did not
/// know them.
struct WeakJoint {
  std::size_t joint = 0;
  std::size_t cannot_hold = 0;  ///< the joint whose number it is
  double needed = 0.0;          ///< Nm or N, of that one, at rest in the posture
};
std::vector<WeakJoint> find_weak(const model::Scenario& scenario, const ArmModel& arm) {
  const JointVector zero = JointVector::Zero(arm.joint_count());
  const JointVector torques =
      inverse_dynamics(arm, {joint_vector(scenario.robot->posture), zero, zero}, {}, scenario.gravity);
  const auto needed = [&](std::size_t joint) { return std::abs(torques[static_cast<Eigen::Index>(joint)]); };
  std::vector<WeakJoint> weak;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    for (std::size_t k = 0; k < arm.joints.size(); ++k) {
      if (arm.joints[k].max_effort != arm.joints[i].max_effort || needed(k) <= arm.joints[k].max_effort) continue;
      weak.push_back({i, k, needed(k)});
      break;
    }
  }
  return weak;
}

}  // namespace

ArmModel load_arm(const model::Scenario& scenario) {
  ArmModel arm = load_as_written(scenario);
  for (const WeakJoint& weak : find_weak(scenario, arm))
    arm.joints[weak.joint].max_effort = std::numeric_limits<double>::infinity();
  return arm;
}

std::vector<std::string> find_weak_joints(const model::Scenario& scenario) {
  const ArmModel arm = load_as_written(scenario);
  std::vector<std::string> found;
  for (const WeakJoint& weak : find_weak(scenario, arm)) {
    const Joint &joint = arm.joints[weak.joint], &held = arm.joints[weak.cannot_hold];
    const char* unit = held.kind == JointKind::Revolute ? "Nm" : "N";
    found.push_back(fmt::format(
        "{}: joint '{}': effort {:g} is taken as unknown: its torque does not stop the robot; to hold the arm in its "
        "posture joint '{}' needs {:.0f} {}",
        urdf_path(scenario).string(), joint.name, joint.max_effort, held.name, weak.needed, unit));
  }
  return found;
}

std::filesystem::path urdf_path(const model::Scenario& scenario) {
  const std::filesystem::path path = scenario.robot->urdf;
  return path.is_relative() ? std::filesystem::path(scenario.source_name).parent_path() / path : path;
}

JointVector joint_vector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

}  // namespace snug::robot
