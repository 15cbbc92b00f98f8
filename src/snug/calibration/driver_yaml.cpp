// Calibrated arms as YAML that drivers read.
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "snug/calibration/exact_arm.hpp"
#include "snug/calibration/internal/complaints.hpp"
#include "snug/calibration/internal/frames.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/model/yaml_limits.hpp"

namespace snug::calibration {
namespace {

constexpr std::array<const char*, 6> kYamlJoints = {"shoulder", "upper_arm", "forearm",
                                                    "wrist_1",  "wrist_2",   "wrist_3"};
constexpr std::array<const char*, 6> kYamlKeys = {"x", "y", "z", "roll", "pitch", "yaw"};

[[noreturn]] void refuse(const std::string& name, const YAML::Node& node, const std::string& key,
                         const std::string& got, const std::string& expected) {
  throw InputError(name + ":" + std::to_string(node.Mark().line + 1), key, got, expected);
}

Pose read_yaml_origin(const std::string& name, const YAML::Node& node, const std::string& joint, AngleReading reading) {
  std::array<double, 6> values{};
  if (!node.IsMap()) refuse(name, node, joint, "no mapping", "x, y, z, roll, pitch, yaw");
  for (std::size_t i = 0; i < kYamlKeys.size(); ++i) {
    const YAML::Node value = node[kYamlKeys[i]];
    if (!value) refuse(name, node, joint, std::string("no '") + kYamlKeys[i] + "'", "x, y, z, roll, pitch, yaw");
    if (!YAML::convert<double>::decode(value, values[i]) || !std::isfinite(values[i]))
      refuse(name, value, joint + "." + kYamlKeys[i], value.IsScalar() ? value.Scalar() : "no number",
             "a finite number");
    const double most = i < 3 ? internal::kFarthest : internal::kLargestTurn;
    if (!(std::abs(values[i]) <= most))
      refuse(name, value, joint + "." + kYamlKeys[i], value.Scalar(),
             std::string(i < 3 ? "metres" : "radians") + ", at most " + internal::to_text(most));
  }
  const Vector3 angles(values[3], values[4], values[5]);
  return {reading == AngleReading::Urdf ? internal::from_urdf_angles(angles) : internal::from_euler_xyz_angles(angles),
          {values[0], values[1], values[2]}};
}

}  // namespace

robot::ArmModel load_calibration_yaml(const std::filesystem::path& path, AngleReading reading,
                                      const robot::ArmModel& nominal) {
  return parse_calibration_yaml(read_file(path, "a calibration file of a driver (YAML)"), path.string(), reading,
                                nominal);
}

robot::ArmModel parse_calibration_yaml(const std::string& text, const std::string& name, AngleReading reading,
                                       const robot::ArmModel& nominal) {
  model::check_yaml(text, name);
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw InputError(name + ":" + std::to_string(error.mark.line + 1), "", error.msg, "YAML that can be parsed");
  }
  if (nominal.joint_count() != 6)
    throw InputError(name, "", std::to_string(nominal.joint_count()) + " joints of the URDF", "six, as in the file");
  if (!root.IsMap() || !root["kinematics"] || !root["kinematics"].IsMap())
    refuse(name, root, "kinematics", "nothing", "a mapping of the six joints");
  const YAML::Node kinematics = root["kinematics"];
  const std::vector<std::string> known(kYamlJoints.begin(), kYamlJoints.end());
  for (const auto& entry : kinematics) {
    const std::string key = entry.first.Scalar();
    if (key == "hash" || std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string_view nearest = find_nearest(key, known);
    refuse(name, entry.first, "kinematics", "'" + key + "'",
           nearest.empty() ? "shoulder, upper_arm, forearm, wrist_1, wrist_2, wrist_3, hash"
                           : "'" + std::string(nearest) + "'");
  }
  robot::ArmModel arm = nominal;
  for (std::size_t i = 0; i < kYamlJoints.size(); ++i) {
    const YAML::Node node = kinematics[kYamlJoints[i]];
    if (!node) refuse(name, kinematics, "kinematics", std::string("no '") + kYamlJoints[i] + "'", "all six joints");
    const Pose& X_SL = nominal.links[static_cast<std::size_t>(internal::joint_parent(nominal, i))].X_SL;
    arm.joints[i].X_SJ = X_SL * read_yaml_origin(name, node, kYamlJoints[i], reading);
  }
  return arm;
}

std::string format_calibration_yaml(const robot::ArmModel& arm, AngleReading reading) {
  std::string text = reading == AngleReading::Urdf
                         ? "# roll, pitch, yaw: fixed axes, R = Rz(yaw) Ry(pitch) Rx(roll)\n"
                         : "# roll, pitch, yaw: moving axes, R = Rx(roll) Ry(pitch) Rz(yaw)\n";
  text += "kinematics:\n";
  for (std::size_t i = 0; i < kYamlJoints.size(); ++i) {
    const Pose X = internal::joint_origin(arm, i);
    const Vector3 angles = reading == AngleReading::Urdf ? internal::urdf_angles(X.R) : internal::euler_xyz_angles(X.R);
    const std::array<double, 6> values = {X.p.x(), X.p.y(), X.p.z(), angles.x(), angles.y(), angles.z()};
    text += std::string("  ") + kYamlJoints[i] + ":\n";
    for (std::size_t k = 0; k < values.size(); ++k)
      text += std::string("    ") + kYamlKeys[k] + ": " + internal::to_text(values[k]) + "\n";
  }
  return text;
}

}  // namespace snug::calibration
