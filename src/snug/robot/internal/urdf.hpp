// Elements of a URDF with the file and line they stand in, and the shapes that their geometry becomes.
#pragma once

#include <tinyxml2.h>

#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "snug/robot/arm.hpp"

namespace snug::robot::internal {

/// Bytes of a URDF and of a mesh that it names: far above those of any arm, and little enough to be held whole.
inline constexpr std::size_t kLargestUrdf = std::size_t{4} << 20U;

/// rad/s, of a continuous joint whose <limit> the file leaves out, as the format allows, and where it says 0, as
/// exporters of CAD write what they do not know: 180 degrees a second, what the wrists of collaborative arms reach.
inline constexpr double kAssumedSpeed = std::numbers::pi;
/// m/s, of a sliding joint with velocity 0.
inline constexpr double kAssumedSlide = 1.0;

/// What is known about the text being read.
struct UrdfSource {
  std::string name;              ///< file or label, for messages
  std::filesystem::path folder;  ///< where relative mesh paths start
};

/// One XML element that can complain about itself.
class Element {
 public:
  Element(const tinyxml2::XMLElement* node, const UrdfSource& source, std::string path)
      : node_(node), source_(&source), path_(std::move(path)) {}

  [[nodiscard]] std::string where() const;
  /// The path of the element, such as "link 'forearm_link'/collision/geometry".
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const UrdfSource& source() const { return *source_; }
  [[nodiscard]] std::string tag() const { return node_->Name(); }
  [[noreturn]] void fail(const std::string& got, const std::string& expected) const;

  /// Children with this tag.
  [[nodiscard]] std::vector<Element> children(const char* tag) const;
  [[nodiscard]] std::vector<Element> children() const;
  [[nodiscard]] bool has(const char* tag) const { return node_->FirstChildElement(tag) != nullptr; }
  /// The one child with this tag; fails when there is none or more than one.
  [[nodiscard]] Element child(const char* tag) const;
  /// Fails when a child's tag is none of these but looks like one of them: a slip would drop it in silence.
  void check_tags(const std::vector<std::string>& known) const;

  [[nodiscard]] bool has_attribute(const char* key) const { return node_->Attribute(key) != nullptr; }
  /// Is the attribute there without a word?
  [[nodiscard]] bool is_empty(const char* key) const { return has_attribute(key) && *node_->Attribute(key) == '\0'; }
  [[nodiscard]] std::string text(const char* key) const;
  /// Finite; fails when absent.
  [[nodiscard]] double number(const char* key) const;
  [[nodiscard]] double number_or(const char* key, double fallback) const;
  [[nodiscard]] std::vector<double> numbers(const char* key, std::size_t count) const;
  [[nodiscard]] Vector3 vector3_or(const char* key, const Vector3& fallback) const;

 private:
  const tinyxml2::XMLElement* node_;
  const UrdfSource* source_;
  std::string path_;
};

/// The <origin> of an element, identity without: rpy about the fixed axes x, y, z.
[[nodiscard]] Pose read_origin(const Element& element);
/// Collision shapes of a link, in its frame.
[[nodiscard]] std::vector<model::PlacedShape> read_shapes(const Element& link);
/// Points of a mesh file's hull, m, at most geometry::kMaxHullVertices of them; scaled.
[[nodiscard]] geometry::ConvexHull read_mesh_hull(const Element& mesh);
/// kAssumedSpeed, or kAssumedSlide of a prismatic joint.
[[nodiscard]] double assumed_speed(const Element& joint);
/// The file that a <mesh> names, which is there. A package is a folder of its name beside or above the URDF; where
/// there is none, one above the URDF in which the rest of the path is found: folders are renamed when they are copied.
[[nodiscard]] std::filesystem::path find_mesh(const Element& mesh);
/// What find_mesh took for the package of a `package://` path, if that folder has another name and its package.xml, if
/// any, too; empty otherwise, and where the mesh is not there.
[[nodiscard]] std::filesystem::path renamed_package(const Element& mesh);
/// R = Rz(yaw) Ry(pitch) Rx(roll).
[[nodiscard]] Matrix3 rpy_rotation(const Vector3& rpy);

}  // namespace snug::robot::internal
