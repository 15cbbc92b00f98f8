// Parts of text that programs for real robots have in common.
#include "snug/control/internal/program_text.hpp"

#include <fmt/format.h>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::control::internal {
namespace {

constexpr std::size_t kLongestNote = 200;

}  // namespace

Pose pose_at_zero(const robot::ArmModel& arm, const std::string& link) {
  const int found = robot::find_link(arm, link);
  if (found < 0) throw InputError(arm.name, "links", "no link '" + link + "'", "a URDF that has it, as those of a UR");
  return robot::link_pose(arm, robot::forward(arm, robot::JointVector::Zero(arm.joint_count())), found);
}

std::string format_pose(const Pose& X) {
  const Vector3 turn = log_rotation(X.R);
  return fmt::format("p[{:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}]", X.p.x(), X.p.y(), X.p.z(), turn.x(), turn.y(),
                     turn.z());
}

std::string format_list(const robot::JointVector& values, int digits) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i)
    text += fmt::format("{}{:.{}g}", i == 0 ? "" : ", ", values[i], digits);
  return text + "]";
}

std::string quotable(const std::string& text) {
  std::string kept;
  for (const char c : text) kept += c == '"' || c == '\\' ? '\'' : c;
  return kept;
}

SpatialInertia payload_of(const RobotProgram& program, const std::optional<CarriedLoad>& load) {
  const int flange = robot::find_link(program.arm, program.flange);
  if (flange < 0) {
    throw InputError(program.arm.name, "links", "no link '" + program.flange + "'",
                     "the link on which the tool is mounted: `flange_frame` of the scenario's robot");
  }
  const SpatialInertia gripper = robot::distal_inertia(program.arm, flange);
  if (!load) return gripper;
  const Pose X_FE = program.arm.links[static_cast<std::size_t>(flange)].X_SL.inverse() * program.arm.X_SE;
  const SpatialInertia box{load->mass, X_FE * load->com_E, X_FE.R * load->inertia_E * X_FE.R.transpose()};
  SpatialInertia both{gripper.mass + box.mass, Vector3::Zero(), Matrix3::Zero()};
  if (both.mass > 0.0) both.com = (gripper.mass * gripper.com + box.mass * box.com) / both.mass;
  for (const SpatialInertia& one : {gripper, box}) {
    const Vector3 r = one.com - both.com;
    both.inertia += one.inertia + one.mass * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
  }
  return both;
}

std::string format_payload(const RobotProgram& program, const std::optional<CarriedLoad>& load) {
  const SpatialInertia payload = payload_of(program, load);
  const Vector3 com = payload.mass > 0.0 ? payload.com : Vector3(Vector3::Zero());
  return fmt::format("set_payload({:.4f}, [{:.5f}, {:.5f}, {:.5f}])\n", payload.mass, com.x(), com.y(), com.z());
}

std::string format_tcp(const RobotProgram& program) {
  const Pose X_WE = robot::forward_tool(program.arm, robot::JointVector::Zero(program.arm.joint_count()));
  return format_pose(pose_at_zero(program.arm, program.flange).inverse() * X_WE);
}

std::string format_header(const RobotProgram& program, const std::string& units) {
  std::string text;
  for (const std::string& note : program.notes) text += "# " + printable(note, kLongestNote) + "\n";
  text += "# units: " + units + "\n";
  text += fmt::format("# tool: {} (TCP in {}: position, rotation vector)\n", format_tcp(program), program.flange);
  text += "# payload table, gripper and box, centre of mass in " + program.flange + ":\n";
  const auto line = [&](const std::string& rows, const std::optional<CarriedLoad>& load) {
    std::string words = format_payload(program, load);
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

}  // namespace snug::control::internal
