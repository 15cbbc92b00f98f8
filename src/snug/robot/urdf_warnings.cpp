// UrdfWarnings: what was assumed of a URDF that says too little, or more than an arm needs; and its limits alone.
#include "snug/robot/urdf_warnings.hpp"

#include <algorithm>
#include <limits>

#include "snug/core/read_file.hpp"
#include "snug/robot/internal/urdf.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::robot {
namespace {

using internal::Element;

/// Calls visit(joint) for each joint that moves; nothing of what is no XML.
template <class Visit>
void visit_moving(const std::string& text, const internal::UrdfSource& source, const Visit& visit) {
  tinyxml2::XMLDocument document;
  if (document.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr) return;
  for (const Element& joint : Element(document.RootElement(), source, "").children("joint")) {
    if (joint.text("type") != "fixed") visit(joint);
  }
}

bool is_without_limit(const Element& joint) { return joint.text("type") == "continuous" && !joint.has("limit"); }

/// Does its limit say that nobody knew its speed?
bool is_without_speed(const Element& joint) {
  return joint.has("limit") && joint.child("limit").number_or("velocity", 1.0) == 0.0;
}

/// One line for each package whose meshes come from a folder of another name; `robot` is the root element.
void add_renamed_packages(const Element& robot, std::vector<std::string>& found) {
  std::vector<std::string> told;
  for (const Element& link : robot.children("link")) {
    for (const Element& collision : link.children("collision")) {
      for (const Element& geometry : collision.children("geometry")) {
        for (const Element& mesh : geometry.children("mesh")) {
          const std::string folder = internal::renamed_package(mesh).string();
          if (folder.empty() || std::ranges::find(told, folder) != told.end()) continue;
          told.push_back(folder);
          found.push_back(mesh.where() + ": '" + mesh.text("filename") + "' is taken from '" + folder +
                          "': its package is in no folder of its name");
        }
      }
    }
  }
}

/// Links from the tool to the root.
std::vector<std::string> path_of(const std::vector<Element>& joints, const std::string& tool_frame) {
  std::vector<std::string> path = {tool_frame};
  for (std::size_t i = 0; i < path.size() && i <= joints.size(); ++i) {
    for (const Element& joint : joints)
      if (joint.child("child").text("link") == path[i]) path.push_back(joint.child("parent").text("link"));
  }
  return path;
}

}  // namespace

std::vector<std::string> find_assumptions(const std::filesystem::path& path, const std::string& tool_frame) {
  const std::string text = read_file(path, "a URDF", internal::kLargestUrdf);
  const internal::UrdfSource source{path.string(), path.parent_path()};
  tinyxml2::XMLDocument document;
  if (document.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr)
    return {};
  const std::vector<Element> joints = Element(document.RootElement(), source, "").children("joint");
  const std::vector<std::string> path_links = path_of(joints, tool_frame);
  std::vector<std::string> found;
  constexpr std::size_t kMostNames = 4;
  std::vector<Element> fixed;
  for (const Element& joint : joints) {
    if (joint.text("type") == "fixed") continue;
    if (std::ranges::find(path_links, joint.child("child").text("link")) == path_links.end())
      fixed.push_back(joint);
    else if (is_without_limit(joint))
      found.push_back(joint.where() + ": " + joint.path() +
                      ": continuous, without limit: 180 degrees a second are assumed");
    else if (is_without_speed(joint))
      found.push_back(joint.where() + ": " + joint.path() + ": velocity 0 is taken as unknown: " +
                      (joint.text("type") == "prismatic" ? "1 m/s is assumed" : "180 degrees a second are assumed"));
  }
  add_renamed_packages(Element(document.RootElement(), source, ""), found);
  if (fixed.empty()) return found;
  std::string line = fixed.front().where() + ": " + std::to_string(fixed.size()) + " moving joint" +
                     (fixed.size() == 1 ? "" : "s") + " off the path to the tool frame '" + tool_frame + "' fixed:";
  for (std::size_t i = 0; i < std::min(kMostNames, fixed.size()); ++i)
    line += (i == 0 ? " '" : ", '") + fixed[i].text("name") + "'";
  found.push_back(line + (fixed.size() > kMostNames ? ", ..." : ""));
  return found;
}

std::vector<std::string> find_unknown_efforts(const std::filesystem::path& path) {
  std::vector<std::string> found;
  const std::string text = read_file(path, "a URDF", internal::kLargestUrdf);
  visit_moving(text, {path.string(), path.parent_path()}, [&](const Element& joint) {
    if (!joint.has("limit")) return;
    const Element limit = joint.child("limit");
    if (limit.number_or("effort", 1.0) != 0.0) return;
    found.push_back(limit.where() + ": " + joint.path() +
                    ": effort 0 is taken as unknown: its torque does not stop the robot");
  });
  return found;
}

std::vector<JointLimits> parse_joint_limits(const std::string& text, const std::string& name) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<JointLimits> limits;
  visit_moving(text, {name, {}}, [&](const Element& joint) {
    if (is_without_limit(joint)) limits.push_back({joint.text("name"), internal::assumed_speed(joint), kInfinity});
    if (!joint.has("limit")) return;
    const Element limit = joint.child("limit");
    const double effort = limit.number("effort");
    const double speed = limit.number("velocity");
    limits.push_back(
        {joint.text("name"), speed == 0.0 ? internal::assumed_speed(joint) : speed, effort > 0.0 ? effort : kInfinity});
  });
  return limits;
}

}  // namespace snug::robot
