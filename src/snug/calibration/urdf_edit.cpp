// Calibrated arms as URDF: the nominal file with other origins, another tool or another load.
#include <tinyxml2.h>

#include <cmath>
#include <string_view>

#include "snug/calibration/exact_arm.hpp"
#include "snug/calibration/internal/frames.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"

namespace snug::calibration {
namespace {

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

/// A URDF that is being changed.
class UrdfEdit {
 public:
  explicit UrdfEdit(const std::filesystem::path& path) : path_(path) {
    const std::string text = read_file(path, "a URDF");
    document_.Parse(text.c_str(), text.size());
    SNUG_CHECK(document_.RootElement() != nullptr, "the file has been read before");
  }

  tinyxml2::XMLDocument& document() { return document_; }
  tinyxml2::XMLElement& root() { return *document_.RootElement(); }

  /// The joint whose child is this link.
  tinyxml2::XMLElement& joint_above(const std::string& link) {
    auto* joint = root().FirstChildElement("joint");
    while (joint != nullptr && link != child_link(*joint)) joint = joint->NextSiblingElement("joint");
    if (joint == nullptr) throw InputError(path_.string(), link, "the root link", "a link behind a joint");
    return *joint;
  }
  tinyxml2::XMLElement& link(const std::string& name) {
    auto* link = root().FirstChildElement("link");
    while (link != nullptr && name != link->Attribute("name")) link = link->NextSiblingElement("link");
    SNUG_CHECK(link != nullptr, "a link of the arm that was read from this file");
    return *link;
  }

  std::string finish(const std::string& note, const std::filesystem::path& out_folder) {
    move_meshes(root(), std::filesystem::absolute(path_).parent_path(),
                std::filesystem::absolute(out_folder.empty() ? "." : out_folder));
    document_.InsertAfterChild(document_.FirstChild(), document_.NewComment((" " + note + " ").c_str()));
    tinyxml2::XMLPrinter printer;
    document_.Print(&printer);
    return printer.CStr();
  }

 private:
  std::filesystem::path path_;
  tinyxml2::XMLDocument document_;
};

}  // namespace

std::string format_urdf(const std::filesystem::path& nominal_path, const robot::ArmModel& nominal,
                        const robot::ArmModel& arm, const std::string& note, const std::filesystem::path& out_folder) {
  UrdfEdit edit(nominal_path);
  const int end = internal::last_link(arm);
  for (auto* joint = edit.root().FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    const int moving = robot::find_joint(arm, joint->Attribute("name"));
    if (moving >= 0) {
      set_origin(edit.document(), *joint, internal::joint_origin(arm, static_cast<std::size_t>(moving)));
      continue;
    }
    const int child = robot::find_link(arm, child_link(*joint));
    const auto k = static_cast<std::size_t>(child);
    if (child >= 0 && arm.links[k].parent == end && !(arm.links[k].X_SL == nominal.links[k].X_SL))
      set_origin(edit.document(), *joint, arm.links[k].X_SL);
  }
  return edit.finish(note, out_folder);
}

std::string format_urdf_with_tip(const std::filesystem::path& path, const robot::ArmModel& arm, int flange,
                                 const Vector3& p_FQ, const std::string& note,
                                 const std::filesystem::path& out_folder) {
  UrdfEdit edit(path);
  const robot::Link& tool = arm.links[static_cast<std::size_t>(arm.tool_link)];
  const Pose& X_SF = arm.links[static_cast<std::size_t>(flange)].X_SL;
  const Pose& X_SP = arm.links[static_cast<std::size_t>(tool.parent)].X_SL;
  Pose X_PE = X_SP.inverse() * tool.X_SL;
  X_PE.p = X_SP.inverse() * (X_SF * p_FQ);
  set_origin(edit.document(), edit.joint_above(tool.name), X_PE);
  return edit.finish(note, out_folder);
}

std::string format_urdf_with_load(const std::filesystem::path& path, const robot::ArmModel& arm, int sensor,
                                  double mass, const Vector3& com_L, const std::string& note,
                                  const std::filesystem::path& out_folder) {
  // The first link behind the sensor that has a mass takes up the difference.
  std::size_t changed = arm.links.size();
  SpatialInertia rest = robot::distal_inertia(arm, sensor);
  for (std::size_t i = 0; i < arm.links.size() && changed == arm.links.size(); ++i)
    if (robot::is_behind(arm, static_cast<int>(i), sensor) && arm.links[i].inertia.mass > 0.0) changed = i;
  if (changed == arm.links.size())
    throw InputError(path.string(), arm.links[static_cast<std::size_t>(sensor)].name, "no link with a mass behind it",
                     "the sensor's frame before the gripper, and the gripper with an <inertial>");
  const robot::Link& link = arm.links[changed];
  const Pose X_LC = arm.links[static_cast<std::size_t>(sensor)].X_SL.inverse() * link.X_SL;
  const double other_mass = rest.mass - link.inertia.mass;
  const Vector3 other_moment = rest.mass * rest.com - link.inertia.mass * (X_LC * link.inertia.com);
  const double new_mass = mass - other_mass;
  if (!(new_mass > 0.0))
    throw InputError(
        path.string(), link.name,
        "a load of " + internal::to_text(mass) + " kg, of which other links weigh " + internal::to_text(other_mass),
        "a load heavier than those");
  const Vector3 new_com = X_LC.inverse() * ((mass * com_L - other_moment) / new_mass);
  UrdfEdit edit(path);
  tinyxml2::XMLElement& inertial = *edit.link(link.name).FirstChildElement("inertial");
  tinyxml2::XMLElement* origin = inertial.FirstChildElement("origin");
  if (origin == nullptr) {
    origin = edit.document().NewElement("origin");
    inertial.InsertFirstChild(origin);
  }
  origin->SetAttribute("xyz", three(new_com).c_str());
  inertial.FirstChildElement("mass")->SetAttribute("value", internal::to_text(new_mass).c_str());
  // Shape unknown: moments grow with the mass.
  tinyxml2::XMLElement& tensor = *inertial.FirstChildElement("inertia");
  for (const char* key : {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"})
    if (tensor.Attribute(key) != nullptr)
      tensor.SetAttribute(key, internal::to_text(tensor.DoubleAttribute(key) * new_mass / link.inertia.mass).c_str());
  return edit.finish(note, out_folder);
}

}  // namespace snug::calibration
