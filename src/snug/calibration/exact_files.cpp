// Calibrated arms as files: the URDF with other origins, and the YAML that drivers read.
#include <tinyxml2.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>

#include "snug/calibration/exact_arm.hpp"
#include "snug/calibration/internal/frames.hpp"
#include "snug/core/input_error.hpp"

namespace snug::calibration {
namespace {

constexpr std::array<const char*, 6> kYamlJoints = {"shoulder", "upper_arm", "forearm",
                                                    "wrist_1",  "wrist_2",   "wrist_3"};
constexpr std::array<const char*, 6> kYamlKeys = {"x", "y", "z", "roll", "pitch", "yaw"};

std::string three(const Vector3& v) {
  return internal::to_text(v.x()) + " " + internal::to_text(v.y()) + " " + internal::to_text(v.z());
}

void set_origin(tinyxml2::XMLDocument& document, tinyxml2::XMLElement& joint, const Pose& X) {
  tinyxml2::XMLElement* origin = joint.FirstChildElement("origin");
  if (origin == nullptr) {
    origin = document.NewElement("origin");
    joint.InsertFirstChild(origin);
  }
  origin->SetAttribute("xyz", three(X.p).c_str());
  origin->SetAttribute("rpy", three(internal::urdf_angles(X.R)).c_str());
}

const char* child_link(const tinyxml2::XMLElement& joint) {
  return joint.FirstChildElement("child")->Attribute("link");
}

/// Relative mesh paths start at the URDF's folder: say the same file from another folder.
void move_meshes(tinyxml2::XMLElement& element, const std::filesystem::path& from, const std::filesystem::path& to) {
  for (auto* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    const char* name = std::string_view(e->Name()) == "mesh" ? e->Attribute("filename") : nullptr;
    if (name != nullptr && std::string_view(name).find("://") == std::string_view::npos &&
        std::filesystem::path(name).is_relative())
      e->SetAttribute("filename", std::filesystem::relative(from / name, to).generic_string().c_str());
    move_meshes(*e, from, to);
  }
}

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
  }
  const Vector3 angles(values[3], values[4], values[5]);
  return {reading == AngleReading::Urdf ? internal::from_urdf_angles(angles) : internal::from_euler_xyz_angles(angles),
          {values[0], values[1], values[2]}};
}

}  // namespace

std::string format_urdf(const std::filesystem::path& nominal_path, const robot::ArmModel& nominal,
                        const robot::ArmModel& arm, const std::string& note, const std::filesystem::path& out_folder) {
  const std::string text = internal::read_file(nominal_path);
  tinyxml2::XMLDocument document;
  document.Parse(text.c_str(), text.size());
  tinyxml2::XMLElement& root = *document.RootElement();
  const int end = internal::last_link(arm);
  for (auto* joint = root.FirstChildElement("joint"); joint != nullptr; joint = joint->NextSiblingElement("joint")) {
    const int moving = robot::find_joint(arm, joint->Attribute("name"));
    if (moving >= 0) {
      set_origin(document, *joint, internal::joint_origin(arm, static_cast<std::size_t>(moving)));
      continue;
    }
    const int child = robot::find_link(arm, child_link(*joint));
    const auto k = static_cast<std::size_t>(child);
    if (child >= 0 && arm.links[k].parent == end && !(arm.links[k].X_SL == nominal.links[k].X_SL))
      set_origin(document, *joint, arm.links[k].X_SL);
  }
  move_meshes(root, std::filesystem::absolute(nominal_path).parent_path(), std::filesystem::absolute(out_folder));
  document.InsertAfterChild(document.FirstChild(), document.NewComment((" " + note + " ").c_str()));
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

void write_text(const std::string& text, const std::filesystem::path& path) { internal::write_file(path, text); }

robot::ArmModel load_calibration_yaml(const std::filesystem::path& path, AngleReading reading,
                                      const robot::ArmModel& nominal) {
  const std::string name = path.string();
  YAML::Node root;
  try {
    root = YAML::Load(internal::read_file(path));
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
