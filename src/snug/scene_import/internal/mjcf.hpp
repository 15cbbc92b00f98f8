// What the parts of the MJCF reader share: settings of the compiler, default classes, geoms.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "snug/scene_import/internal/raw_scene.hpp"
#include "snug/scene_import/internal/shapes.hpp"
#include "snug/scene_import/internal/xml.hpp"

namespace snug::scene_import::internal {

using Attributes = std::map<std::string, std::string>;

/// <compiler>: how numbers are meant.
struct MjcfCompiler {
  bool uses_degrees = true;
  std::string euler_order = "xyz";
  std::string mesh_folder;
  bool strips_paths = false;
  std::optional<bool> inertia_from_geoms;  ///< absent: where a body has no <inertial>
  int first_group = 0, last_group = 5;     ///< geoms that count for inertias
  double least_mass = 0.0, least_inertia = 0.0, total_mass = -1.0;
  bool balances = false;

  [[nodiscard]] double radians(double angle) const;
};

/// Classes of attributes, by element.
class MjcfDefaults {
 public:
  /// Reads a top-level <default>.
  void read(const Node& node);
  /// The attributes of an element: its own, else those of its class, else of `outer` (childclass).
  [[nodiscard]] Attributes attributes_of(const Node& node, const std::string& outer) const;
  [[nodiscard]] bool has_class(const std::string& name) const { return classes_.contains(name); }
  [[nodiscard]] const std::string& main_class() const { return main_; }

 private:
  using ByElement = std::map<std::string, Attributes>;
  void read_class(const Node& node, const ByElement& inherited, const std::string& name, int depth);

  std::map<std::string, ByElement> classes_;
  std::string main_ = "main";
};

/// <mesh> of <asset>: read when a geom asks for it.
class MjcfMeshes {
 public:
  void read(const Node& node, const MjcfCompiler& compiler, const MjcfDefaults& defaults, RemarkList& remarks);
  /// Null for a mesh that is built in, which no reader makes here. Fails at `geom` for a name that is none.
  [[nodiscard]] const Solid* find(const std::string& name, const Node& geom);

 private:
  struct Asset {
    Node node;
    Attributes attributes;
    std::filesystem::path path;  ///< empty: points in the file itself
    std::optional<Solid> solid;
  };
  [[nodiscard]] static Solid load(const Asset& asset);
  std::map<std::string, Asset> assets_;
};

/// A geom, read.
struct MjcfGeom {
  Solid solid;
  Pose X_BG;
  SpatialInertia inertia;  ///< in the frame that the geom's pose is in
  Surface surface;
  bool touches = true;  ///< else it is looked at only
  bool counts = true;   ///< for the body's inertia
  bool is_plane = false;
};
/// Nothing for kinds that are left out, which is remarked.
[[nodiscard]] std::optional<MjcfGeom> read_geom(const Node& node, const Attributes& attributes,
                                                const MjcfCompiler& compiler, MjcfMeshes& meshes, RemarkList& remarks);

[[nodiscard]] const std::string* find_attribute(const Attributes& attributes, const std::string& key);
/// The rotation that one of quat, axisangle, euler, xyaxes and zaxis gives.
[[nodiscard]] Matrix3 read_orientation(const Node& node, const Attributes& attributes, const MjcfCompiler& compiler);
[[nodiscard]] Pose read_pose(const Node& node, const Attributes& attributes, const MjcfCompiler& compiler);

}  // namespace snug::scene_import::internal
