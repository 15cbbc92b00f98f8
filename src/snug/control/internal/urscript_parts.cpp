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

constexpr double kJointSpeed = 1.05;        ///< rad/s, what movej has when nothing is said
constexpr double kElsewhere = 1e-6;         ///< rad, of a joint: the start is on the way to where the program begins
constexpr double kPayloadTransition = 0.1;  ///< s, over which payloads change
constexpr std::array kUrJoints = {"shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
                                  "wrist_1_joint",      "wrist_2_joint",       "wrist_3_joint"};

[[noreturn]] void refuse_arm(const robot::ArmModel& arm, const std::string& got) {
  throw InputError(arm.name, "urscript", got, "the URDF of a UR; for other arms: --format ros-trajectory");
}

const char* script_word(bool value) { return value ? "True" : "False"; }

const char* word_of(model::DigitalKind kind) {
  switch (kind) {
    case model::DigitalKind::Standard:
      return "standard";
    case model::DigitalKind::Configurable:
      return "configurable";
    case model::DigitalKind::Tool:
      return "tool";
  }
  return "";
}

/// An expression that is True where the input says yes.
std::string is_on(const model::DigitalIo& at) {
  const std::string input = fmt::format("get_{}_digital_in({})", word_of(at.kind), at.number);
  return at.active_low ? "(" + input + " == False)" : input;
}

/// One that is True while the pressure is below that, Pa, gauge.
std::string is_deeper(const model::GaugeIo& gauge, double pressure) {
  return fmt::format("get_{}_analog_in({}) {} {:.6g}", gauge.kind == model::AnalogKind::Tool ? "tool" : "standard",
                     gauge.number, gauge.at_vacuum > gauge.at_ambient ? ">" : "<", gauge.reading_of(pressure));
}

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
  const auto output = [&](const model::DigitalIo& at, bool value) {
    text +=
        fmt::format("  set_{}_digital_out({}, {})\n", word_of(at.kind), at.number, script_word(value != at.active_low));
  };
  if (!before || before->vacuum != io.vacuum) output(options.io.vacuum, io.vacuum);
  if (options.io.blow_off && (!before || before->blow_off != io.blow_off)) output(*options.io.blow_off, io.blow_off);
  return text;
}

std::string wait_function(const UrScriptOptions& options) {
  if (options.is_dry) return {};
  const std::optional<model::GaugeIo>& gauge = options.io.vacuum_gauge;
  if (!options.io.vacuum_reached && !gauge) {
    throw InputError("robot.io", "vacuum_reached", "neither that input nor a vacuum_gauge",
                     "one of them: a script has to know when the vacuum has come and gone");
  }
  const std::string is_other = options.io.vacuum_reached
                                   ? fmt::format("{} != is_wanted", is_on(*options.io.vacuum_reached))
                                   : fmt::format("({}) != is_wanted", is_deeper(*gauge, options.pressure_reached));
  std::string text =
      "  def snug_halt_unless(is_fine, text, place):\n"
      "    if is_fine == False:\n"
      "      textmsg(text, place)\n"
      "      popup(text, title=\"snug\", error=True, blocking=True)\n"
      "      halt\n"
      "    end\n"
      "  end\n";
  text += fmt::format(
      "  def snug_wait_for_vacuum(is_wanted, place):\n"
      "    local waited = 0.0\n"
      "    while {}:\n"
      "      snug_halt_unless(waited <= {:.3f}, \"snug: the vacuum did not change before \", place)\n"
      "      sync()\n"
      "      waited = waited + get_steptime()\n"
      "    end\n"
      "    if is_wanted == False:\n"
      "      sleep({:.3f})\n",
      is_other, options.vacuum_timeout, options.vent_time);
  if (gauge) {
    text += fmt::format(
        "      waited = 0.0\n"
        "      while {}:\n"
        "        snug_halt_unless(waited <= {:.3f}, \"snug: the vacuum did not go before \", place)\n"
        "        sync()\n"
        "        waited = waited + get_steptime()\n"
        "      end\n",
        is_deeper(*gauge, options.pressure_gone), options.vacuum_timeout);
  }
  text += "    end\n  end\n";
  if (!options.io.part_present) return text;
  return text + fmt::format(
                    "  def snug_wait_for_part(place):\n"
                    "    local waited = 0.0\n"
                    "    while {} == False:\n"
                    "      snug_halt_unless(waited <= {:.3f}, \"snug: no box came for \", place)\n"
                    "      sync()\n"
                    "      waited = waited + get_steptime()\n"
                    "    end\n"
                    "  end\n",
                    is_on(*options.io.part_present), options.part_timeout);
}

std::string format_wait(const motion::Waypoint& waypoint) {
  return fmt::format("  snug_wait_for_vacuum({}, \"{}\")\n", script_word(waypoint.io.vacuum),
                     quotable(motion::name_of(waypoint)));
}

std::string format_part_wait(const motion::Waypoint& waypoint, const UrScriptOptions& options) {
  if (!options.io.part_present || options.is_dry) return {};
  return fmt::format("  snug_wait_for_part(\"{}\")\n", quotable(motion::name_of(waypoint)));
}

std::string format_script_payload(const RobotProgram& program, const std::optional<CarriedLoad>& load,
                                  const UrScriptOptions& options) {
  if (!options.has_inertia) return "  " + format_payload(program, load);
  const SpatialInertia payload = payload_of(program, load);
  const Matrix3& I = payload.inertia;
  return fmt::format(
      "  set_target_payload({:.4f}, [{:.5f}, {:.5f}, {:.5f}], [{:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}], {})\n",
      payload.mass, payload.com.x(), payload.com.y(), payload.com.z(), I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2),
      I(1, 2), kPayloadTransition);
}

std::string format_start(const RobotProgram& program, const robot::JointVector& q, const UrScriptOptions& options) {
  std::string text = fmt::format("{}  set_tcp({})\n{}", format_outputs(std::nullopt, motion::IO{}, options),
                                 format_tcp(program), format_script_payload(program, std::nullopt, options));
  const auto go = [&](const robot::JointVector& joints) {
    text += fmt::format("  movej({}, a={}, v={})\n", format_list(joints), kJointAcceleration, kJointSpeed);
  };
  if (q.size() == program.q_start.size() && (q - program.q_start).cwiseAbs().maxCoeff() > kElsewhere)
    go(program.q_start);
  go(q);
  return text;
}

}  // namespace snug::control::internal
