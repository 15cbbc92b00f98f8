// ArmEdit: an arm's URDF as a file of the folder, its meshes beside it, and the cell that it is put into.
#include "snug/workspace/arm_edit.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <string_view>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"
#include "snug/geometry/bounds.hpp"
#include "snug/model/scenario.hpp"
#include "snug/robot/arm.hpp"
#include "snug/workspace/folder.hpp"

namespace snug::workspace {
namespace {

using tinyxml2::XMLElement;

constexpr std::size_t kMostLinks = 1000;
constexpr std::size_t kMostMeshes = 200;
/// Names that links at the end of arms have in the field, the likeliest first.
constexpr std::array<std::string_view, 8> kToolNames = {"E",        "tcp",     "tool0",  "tool",
                                                        "tool_tcp", "ee_link", "flange", "tool_link"};

std::string attribute_of(const XMLElement* node, const char* key) {
  const char* value = node->Attribute(key);
  return value == nullptr ? std::string() : std::string(value);
}

/// The root of a URDF; throws InputError.
const XMLElement* read_root(tinyxml2::XMLDocument& document, const std::string& text, const std::string& name) {
  check_utf8(text, name);
  if (document.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS)
    throw InputError(name + ":" + std::to_string(std::max(1, document.ErrorLineNum())), "", document.ErrorName(),
                     "a URDF (XML)");
  const XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "robot")
    throw InputError(name, "", root == nullptr ? "no element" : printable(root->Name(), 40), "<robot>: a URDF");
  return root;
}

/// Calls visit(element) for every element below, in their order.
template <class Visit>
void visit_all(const XMLElement* root, const Visit& visit) {
  for (const XMLElement* one = root->FirstChildElement(); one != nullptr; one = one->NextSiblingElement()) {
    visit(one);
    visit_all(one, visit);
  }
}

/// What stands behind the last slash of a path, a URL or a package's path.
std::string file_of(const std::string& path) {
  const std::size_t slash = path.find_last_of("/\\");
  return slash == std::string::npos ? path : path.substr(slash + 1);
}

/// How many moving joints are between the root and each link.
std::map<std::string, int> count_joints(const XMLElement* root) {
  struct Parent {
    std::string link;
    bool moves = false;
  };
  std::map<std::string, Parent> parents;
  for (const XMLElement* joint = root->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    const XMLElement* parent = joint->FirstChildElement("parent");
    const XMLElement* child = joint->FirstChildElement("child");
    if (parent == nullptr || child == nullptr) continue;
    parents[attribute_of(child, "link")] = {attribute_of(parent, "link"), attribute_of(joint, "type") != "fixed"};
  }
  std::map<std::string, int> counts;
  for (const XMLElement* link = root->FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    if (counts.size() == kMostLinks) break;
    std::string at = attribute_of(link, "name");
    int& count = counts[at];
    std::size_t steps = 0;
    for (auto up = parents.find(at); up != parents.end() && steps < kMostLinks; up = parents.find(at), ++steps) {
      count += up->second.moves ? 1 : 0;
      at = up->second.link;
    }
  }
  return counts;
}

bool is_key_line(std::string_view line, const std::string& key) {
  return line.starts_with(key) && line.size() > key.size() && line[key.size()] == ':';
}

struct BlockSpan {
  std::size_t begin = std::string::npos, end = std::string::npos;
};

/// From the key to before the comments and the empty lines that stand over the next key.
BlockSpan find_span(const std::string& text, const std::string& key) {
  BlockSpan span;
  std::size_t begin = 0;
  while (begin < text.size()) {
    const std::size_t newline = text.find('\n', begin);
    const std::size_t next = newline == std::string::npos ? text.size() : newline + 1;
    const std::string_view line = std::string_view(text).substr(begin, std::min(newline, text.size()) - begin);
    const bool is_inside = line.starts_with(' ') || line.starts_with('\t') || line.starts_with('-');
    if (span.begin == std::string::npos) {
      if (is_key_line(line, key)) {
        span.begin = begin;
        span.end = next;
      }
    } else if (is_inside && !trim(line).empty()) {
      span.end = next;
    } else if (!trim(line).empty() && !line.starts_with('#')) {
      break;
    }
    begin = next;
  }
  return span;
}

/// The link of this name that the arm has, else `otherwise`.
std::string link_or(const robot::ArmModel& arm, const char* name, const std::string& otherwise) {
  return robot::find_link(arm, name) >= 0 ? name : otherwise;
}

std::string quoted(const std::string& word) {
  std::string text = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + "\"";
}

/// A path as YAML: in quotes where it is more than letters, digits, `.`, `/`, `_` and `-`.
std::string path_word(const std::string& path) {
  const bool is_plain = std::ranges::all_of(path, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '/' || c == '_' || c == '-';
  });
  return is_plain && !path.starts_with('-') ? path : quoted(path);
}

/// m, from where a gripper is mounted to E: how far its rod goes back.
double length_of(const model::ToolParams& tool) {
  double lowest = 0.0;
  for (const model::PlacedShape& rod : tool.rod_shapes)
    lowest = std::min(lowest, geometry::bounds(rod.shape, rod.X_BG).lower.z());
  return -lowest;
}

/// That of the robot before, where the arm can stand so; else elbow up and the tool down where an arm of six joints
/// can, else the middle of each joint.
std::vector<double> choose_posture(const robot::ArmModel& arm, const model::Scenario& scenario) {
  if (scenario.robot && scenario.robot->posture.size() == arm.joints.size()) {
    bool can_stay = true;
    for (std::size_t i = 0; i < arm.joints.size(); ++i) {
      const double value = scenario.robot->posture[i];
      can_stay = can_stay && arm.joints[i].lower <= value && value <= arm.joints[i].upper;
    }
    if (can_stay) return scenario.robot->posture;
  }
  constexpr double kQuarter = 0.5 * std::numbers::pi;
  const std::array<double, 6> upright = {0.0, -kQuarter, kQuarter, -kQuarter, -kQuarter, 0.0};
  std::vector<double> posture;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const robot::Joint& joint = arm.joints[i];
    const bool has_ends = std::isfinite(joint.lower) && std::isfinite(joint.upper);
    const bool is_turning = joint.kind == robot::JointKind::Revolute;
    double value = has_ends ? 0.5 * (joint.lower + joint.upper) : 0.0;
    if (arm.joints.size() == upright.size() && is_turning && joint.lower <= upright[i] && upright[i] <= joint.upper)
      value = upright[i];
    posture.push_back(std::round(1e4 * value) / 1e4);
  }
  return posture;
}

}  // namespace

ArmFacts read_arm_facts(const std::string& text, const std::string& name) {
  tinyxml2::XMLDocument document;
  const XMLElement* root = read_root(document, text, name);
  ArmFacts facts;
  facts.name = printable(attribute_of(root, "name"), 60);
  visit_all(root, [&](const XMLElement* one) {
    if (std::string_view(one->Name()) == "mesh") facts.meshes.push_back(attribute_of(one, "filename"));
  });
  const std::map<std::string, int> counts = count_joints(root);
  int most = 0;
  for (const auto& [link, count] : counts) most = std::max(most, count);
  if (most == 0) throw InputError(name, "joint", "none that moves", "a URDF of an arm");
  std::vector<std::string> ends;
  for (const XMLElement* link = root->FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    const std::string which = attribute_of(link, "name");
    const auto found = counts.find(which);
    if (found != counts.end() && found->second == most && !which.empty()) ends.push_back(which);
  }
  for (const std::string_view likely : kToolNames) {  // wherever it is: fingers have joints, too
    if (counts.contains(std::string(likely)) && counts.at(std::string(likely)) > 0) facts.links.emplace_back(likely);
  }
  std::ranges::reverse(ends);  // files name links from the base
  for (const std::string& one : ends) {
    if (std::ranges::find(facts.links, one) == facts.links.end()) facts.links.push_back(one);
  }
  return facts;
}

std::string take_in_urdf(const std::string& text, const std::string& name,
                         const std::function<bool(const std::string&)>& has) {
  (void)read_arm_facts(text, name);
  tinyxml2::XMLDocument document;
  auto* root = const_cast<XMLElement*>(read_root(document, text, name));  // NOLINT: the document is ours
  std::string missing;
  std::size_t count = 0;
  bool is_as_before = true;
  visit_all(root, [&](const XMLElement* one) {
    const std::string_view tag = one->Name();
    if ((tag != "mesh" && tag != "texture") || one->Attribute("filename") == nullptr) return;
    const std::string path = attribute_of(one, "filename"), file = file_of(path);
    is_as_before = is_as_before && file == path;
    const_cast<XMLElement*>(one)->SetAttribute("filename", file.c_str());  // NOLINT
    if (tag == "texture") return;                                          // nobody draws it
    if (++count > kMostMeshes)
      throw InputError(name, "mesh", "more", "at most " + std::to_string(kMostMeshes) + " meshes");
    bool is_there = false;
    try {
      is_there = kind_of_name(file) == FileKind::Mesh && has(file);
    } catch (const InputError&) {
      throw InputError(name + ":" + std::to_string(one->GetLineNum()), "mesh", "'" + printable(path, 80) + "'",
                       "a file .stl, .obj or .dae whose name has letters, digits, '.', '_' and '-' alone");
    }
    if (!is_there && missing.find(file) == std::string::npos) missing += (missing.empty() ? "" : ", ") + file;
  });
  if (!missing.empty())
    throw InputError(name, "mesh", "files that are not in the folder: " + printable(missing, 400),
                     "these files dropped together with the URDF");
  if (is_as_before) return text;
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

std::string find_block(const std::string& text, const std::string& key) {
  const BlockSpan span = find_span(text, key);
  return span.begin == std::string::npos ? std::string() : text.substr(span.begin, span.end - span.begin);
}

std::string replace_block(const std::string& text, const std::string& name, const std::string& key,
                          const std::string& block) {
  const BlockSpan span = find_span(text, key);
  if (span.begin != std::string::npos) return text.substr(0, span.begin) + block + text.substr(span.end);
  if (find_block(text, "name").empty() && find_block(text, "containers").empty())
    throw InputError(name, key, "a text that is not written line by line", "keys that begin lines");
  return text + (text.empty() || text.back() == '\n' ? "" : "\n") + "\n" + block;
}

std::string put_arm(const std::string& text, const std::string& name, const std::string& urdf, const std::string& tool,
                    const std::filesystem::path& file) {
  const std::string source = read_file(file, "a URDF", kLargestUpload);
  const std::string link = tool.empty() ? read_arm_facts(source, file.string()).links.front() : tool;
  const robot::ArmModel arm = robot::parse_urdf(source, file.string(), link, file.parent_path());
  const model::Scenario scenario = model::parse_scenario(text, name);
  std::string pose = "  pose: {position: [0.0, 0.0, 0.0], yaw_deg: 0.0}\n";
  const std::string before = find_block(text, "robot");
  const std::size_t at = before.find("\n  pose: {");
  const std::size_t end = at == std::string::npos ? at : before.find('\n', at + 1);
  if (end != std::string::npos && before.find('}', at) < end) pose = before.substr(at + 1, end - at);
  std::string frames = fmt::format("  tool_frame: {}\n", quoted(link));
  const double length = scenario.tool ? length_of(*scenario.tool) : 0.0;
  if (link == "E" || length <= 0.0) {
    frames += fmt::format("  flange_frame: {}\n  sensor_frame: {}\n",
                          quoted(link_or(arm, "flange", link_or(arm, "tool0", link))),
                          quoted(link_or(arm, "ft_sensor", link)));
  } else {
    frames += fmt::format("  tool_pose: {{position: [0.0, 0.0, {:.3f}]}}\n", length);
  }
  const std::vector<double> posture = choose_posture(arm, scenario);
  return replace_block(text, name, "robot",
                       fmt::format("robot:\n  urdf: {}\n{}  posture: [{}]\n{}", path_word(urdf), pose,
                                   fmt::join(posture, ", "), frames));
}

}  // namespace snug::workspace
