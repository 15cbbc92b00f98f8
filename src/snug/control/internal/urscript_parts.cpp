// Parts of scripts for the controller of a UR robot that all forms of them have.
#include "snug/control/internal/urscript_parts.hpp"

#include <fmt/format.h>

#include <array>

#include "snug/control/internal/program_text.hpp"
#include "snug/core/input_error.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/robot/ur_inverse.hpp"

namespace snug::control::internal {
namespace {

constexpr double kJointSpeed = 1.05;  ///< rad/s, what movej has when nothing is said
constexpr std::array kUrJoints = {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                  "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};

[[noreturn]] void refuse_arm(const robot::ArmModel& arm, const std::string& got) {
  throw InputError(arm.name, "urscript", got, "the URDF of a UR; for other arms: --format ros-trajectory");
}

const char* script_word(bool value) { return value ? "True" : "False"; }

}  // namespace

void check_is_ur(const robot::ArmModel& arm) {
  if (arm.joint_count() != static_cast<int>(kUrJoints.size()))
    refuse_arm(arm, fmt::format("{} joints", arm.joint_count()));
  for (std::size_t i = 0; i < kUrJoints.size(); ++i) {
    if (!arm.joints[i].name.ends_with(kUrJoints[i]))
      refuse_arm(arm, fmt::format("joint '{}' where a UR has '{}'", arm.joints[i].name, kUrJoints[i]));
  }
  if (!robot::find_ur_geometry(arm)) refuse_arm(arm, "axes that do not lie as those of a UR");
  for (const char* link : {"base", "tool0"}) {
    if (robot::find_link(arm, link) < 0) refuse_arm(arm, fmt::format("no link '{}'", link));
  }
}

std::string format_outputs(const std::optional<motion::IO>& before, const motion::IO& io,
                           const UrScriptOptions& options) {
  std::string text;
  const auto output = [&](int number, bool value) {
    text += fmt::format("  set_standard_digital_out({}, {})\n", number, script_word(value));
  };
  if (!before || before->vacuum != io.vacuum) output(options.vacuum_output, io.vacuum);
  if (!before || before->blow_off != io.blow_off) output(options.blow_off_output, io.blow_off);
  return text;
}

std::string wait_function(const UrScriptOptions& options) {
  return fmt::format(
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
      "    if is_wanted == False:\n"
      "      sleep({:.3f})\n"
      "    end\n"
      "  end\n",
      options.vacuum_input, options.vacuum_timeout, options.vent_time);
}

std::string format_wait(const motion::Waypoint& waypoint) {
  return fmt::format("  snug_wait_for_vacuum({}, \"{}\")\n", script_word(waypoint.io.vacuum),
                     quotable(motion::name_of(waypoint)));
}

std::string format_start(const RobotProgram& program, const robot::JointVector& q, const UrScriptOptions& options) {
  return fmt::format("{}  set_tcp({})\n  {}  movej({}, a={}, v={})\n",
                     format_outputs(std::nullopt, motion::IO{}, options), format_tcp(program),
                     format_payload(program, std::nullopt), format_list(q), kJointAcceleration, kJointSpeed);
}

}  // namespace snug::control::internal
