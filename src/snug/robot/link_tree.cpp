// LinkTree: how the links of a URDF hang on each other.
#include "snug/robot/link_tree.hpp"

#include <algorithm>
#include <filesystem>

#include "snug/core/base64.hpp"
#include "snug/core/input_error.hpp"
#include "snug/robot/internal/urdf.hpp"

namespace snug::robot {
namespace {

using internal::Element;

LinkJoint read_link_joint(const Element& element) {
  LinkJoint joint;
  joint.name = element.text("name");
  joint.parent = element.child("parent").text("link");
  joint.child = element.child("child").text("link");
  joint.X_PC = internal::read_origin(element);
  const std::string type = element.text("type");
  if (type == "prismatic") joint.kind = JointKind::Prismatic;
  if (type == "revolute" || type == "continuous") joint.kind = JointKind::Revolute;
  if (!joint.kind) return joint;
  if (element.has("axis")) joint.axis = element.child("axis").vector3_or("xyz", Vector3::UnitX());
  const double length = joint.axis.norm();
  if (!(length > 1e-6)) element.fail("an axis of length 0", "a direction");
  joint.axis /= length;
  return joint;
}

/// Parents first. What hangs on no root (a circle) is not reached.
std::vector<LinkJoint> in_order(const std::vector<LinkJoint>& joints, const std::string& root) {
  std::vector<LinkJoint> ordered;
  std::vector<std::string> reached = {root};
  for (std::size_t i = 0; i < reached.size(); ++i) {
    for (const LinkJoint& joint : joints) {
      if (joint.parent != reached[i]) continue;
      ordered.push_back(joint);
      reached.push_back(joint.child);
    }
  }
  return ordered;
}

bool parse(const std::string& urdf, tinyxml2::XMLDocument& xml) {
  return urdf.size() <= internal::kLargestUrdf && xml.Parse(urdf.c_str(), urdf.size()) == tinyxml2::XML_SUCCESS &&
         xml.RootElement() != nullptr;
}

std::string media_type(const std::string& mesh_name) {
  std::string ending = std::filesystem::path(mesh_name).extension();
  std::ranges::transform(ending, ending.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return ending == ".dae" ? "model/vnd.collada+xml" : ending == ".obj" ? "model/obj" : "model/stl";
}

}  // namespace

Pose pose_at(const LinkJoint& joint, double q) {
  if (!joint.kind) return joint.X_PC;
  Pose X_CM;  // what the joint adds
  if (*joint.kind == JointKind::Prismatic)
    X_CM.p = q * joint.axis;
  else
    X_CM.R = exp_rotation(q * joint.axis);
  return joint.X_PC * X_CM;
}

std::vector<LinkJoint> parse_link_tree(const std::string& urdf) {
  tinyxml2::XMLDocument xml;
  if (!parse(urdf, xml)) return {};
  const internal::UrdfSource source{"URDF of the recording", {}};
  std::vector<LinkJoint> joints;
  try {
    for (const Element& joint : Element(xml.RootElement(), source, "").children("joint")) {
      joints.push_back(read_link_joint(joint));
    }
  } catch (const InputError&) {
    return {};
  }
  const auto count_of = [&](const std::string& name, std::string LinkJoint::*side) {
    return std::ranges::count(joints, name, side);
  };
  std::optional<std::string> root;
  for (const LinkJoint& joint : joints) {
    if (count_of(joint.child, &LinkJoint::child) > 1) return {};
    if (count_of(joint.parent, &LinkJoint::child) > 0) continue;
    if (root && *root != joint.parent) return {};
    root = joint.parent;
  }
  return root ? in_order(joints, *root) : std::vector<LinkJoint>();
}

std::string embed_meshes(const std::string& urdf, const std::vector<MeshFile>& meshes) {
  tinyxml2::XMLDocument xml;
  if (meshes.empty() || !parse(urdf, xml)) return urdf;
  const auto embed = [&](tinyxml2::XMLElement* place) {
    tinyxml2::XMLElement* geometry = place->FirstChildElement("geometry");
    tinyxml2::XMLElement* mesh = geometry != nullptr ? geometry->FirstChildElement("mesh") : nullptr;
    const char* name = mesh != nullptr ? mesh->Attribute("filename") : nullptr;
    if (name == nullptr) return;
    const auto file = std::ranges::find(meshes, name, &MeshFile::name);
    if (file == meshes.end()) return;
    mesh->SetAttribute("filename", ("data:" + media_type(file->name) + ";base64," + base64(file->bytes)).c_str());
  };
  for (auto* link = xml.RootElement()->FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    for (auto* part = link->FirstChildElement("visual"); part != nullptr; part = part->NextSiblingElement("visual")) {
      embed(part);
    }
  }
  tinyxml2::XMLPrinter printer;
  xml.Print(&printer);
  return printer.CStr();
}

}  // namespace snug::robot
