// What the parts of the SDF reader share: frames, shapes of collisions, inertias of links, paths of models.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "snug/scene_import/internal/raw_scene.hpp"
#include "snug/scene_import/internal/shapes.hpp"
#include "snug/scene_import/internal/xml.hpp"

namespace snug::scene_import::internal {

/// A pose as written, and what it is relative to; nothing: not said.
struct SdfPose {
  Pose X;
  std::optional<std::string> relative_to;
};
/// The <pose> of an element; identity without.
[[nodiscard]] SdfPose read_sdf_pose(const Node& node);

/// Frames by their whole names, "" is the world.
class SdfFrames {
 public:
  void add(const std::string& key, const Pose& X, const std::string& relative_to, const Node& node,
           const std::string& placement = "");
  [[nodiscard]] bool has(const std::string& key) const { return key.empty() || frames_.contains(key); }
  /// Fails at `node` for a name that is none, and for frames relative to each other.
  [[nodiscard]] Pose in_world(const std::string& key, const Node& node) { return in(key, "", node); }

 private:
  struct Frame {
    Pose X;
    std::string relative_to;
    Node node;
    std::string placement;                     ///< frame of the model that X places; empty: its own
    std::optional<Pose> local = std::nullopt;  ///< in what it is relative to
    bool is_being_found = false;
  };
  [[nodiscard]] Pose in(const std::string& key, const std::string& base, const Node& node);
  [[nodiscard]] const Pose& local(Frame& frame, const std::string& key);
  [[nodiscard]] Frame& find(const std::string& key, const Node& node);

  std::map<std::string, Frame> frames_;
};

struct SdfShape {
  Solid solid;
  Pose X_CG;  ///< in the collision's frame
  bool is_plane = false;
};
/// <geometry>; nothing for kinds that are left out, which is remarked.
[[nodiscard]] std::optional<SdfShape> read_sdf_geometry(const Node& collision, RemarkList& remarks);
[[nodiscard]] Surface read_sdf_surface(const Node& collision, RemarkList& remarks);
/// <inertial> of a link, in its frame; nothing where it asks to be computed.
[[nodiscard]] std::optional<SpatialInertia> read_sdf_inertial(const Node& link, RemarkList& remarks);

/// The file or folder that a URI names: beside the file, or in a folder above it, with or without `models` between.
/// Nothing: it is not there, or would have to be downloaded.
[[nodiscard]] std::optional<std::filesystem::path> find_uri(const std::string& uri,
                                                            const std::filesystem::path& folder);

}  // namespace snug::scene_import::internal
