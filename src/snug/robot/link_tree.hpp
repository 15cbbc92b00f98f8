// LinkTree: how the links of a URDF hang on each other, for those who draw them: fixed joints and branches, too.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/robot/arm.hpp"
#include "snug/robot/visuals.hpp"

namespace snug::robot {

/// One joint of the file and the links that it joins.
struct LinkJoint {
  std::string name, parent, child;
  std::optional<JointKind> kind;    ///< none: fixed
  Pose X_PC;                        ///< child in parent at q = 0
  Vector3 axis = Vector3::UnitX();  ///< unit, in the child
  bool operator==(const LinkJoint&) const = default;
};

/// X_PC at q [rad or m]; q does not matter for a fixed joint.
[[nodiscard]] Pose pose_at(const LinkJoint& joint, double q);

/// All joints whose links hang on one root, a parent always before its children. Empty for a text that is no such tree:
/// two roots, two parents of a link, a joint that cannot be read.
[[nodiscard]] std::vector<LinkJoint> parse_link_tree(const std::string& urdf);

/// The URDF with each mesh that is among `meshes` as a `data:` URL in place of its name, so that it needs no files.
/// Unchanged for a text that is no URDF.
[[nodiscard]] std::string embed_meshes(const std::string& urdf, const std::vector<MeshFile>& meshes);

}  // namespace snug::robot
