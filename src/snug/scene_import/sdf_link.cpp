// Shapes, surfaces and inertias of the links of SDF.
#include <algorithm>
#include <cmath>

#include "snug/core/text.hpp"
#include "snug/scene_import/internal/sdf.hpp"

namespace snug::scene_import::internal {
namespace {

/// 1 m where a shape does not say it, as SDF has it (half for the radius of a capsule).
double length_of(const Node& node, const char* tag) {
  const bool is_slim = node.tag() == "capsule" && std::string_view(tag) == "radius";
  const double value = node.number(node.child_text(tag, is_slim ? "0.5" : "1"), tag);
  if (!(value > 0.0 && value <= kLargestSize)) node.fail(std::string(tag) + " " + node.child_text(tag), "metres, > 0");
  return value;
}

Vector3 size_of(const Node& node, const char* tag) {
  const Vector3 size = node.vector(node.child_text(tag, "1 1 1"), tag);
  if (!(size.minCoeff() > 0.0 && size.maxCoeff() <= kLargestSize))
    node.fail(std::string(tag) + " " + node.child_text(tag), "metres, > 0");
  return size;
}

SdfShape read_plane(const Node& node) {
  SdfShape shape;
  Vector3 normal = Vector3::UnitZ();
  if (node.child("normal")) normal = node.vector(node.child_text("normal"), "normal");
  if (!(normal.norm() > 1e-10)) node.fail("a normal of length 0", "a direction");
  shape.X_CG.R = rotation_of_z(normal);
  shape.X_CG.p = shape.X_CG.R * Vector3(0.0, 0.0, -0.5 * kPlaneThickness);
  // The size is that of the picture: the plane touches everywhere.
  shape.solid = make_plane(0.0, 0.0);
  shape.is_plane = true;
  return shape;
}

std::optional<SdfShape> read_sdf_mesh(const Node& node, RemarkList& remarks) {
  const std::string uri = node.child_text("uri");
  if (uri.empty()) node.fail("no uri", "a mesh file");
  const auto path = find_uri(uri, node.file().folder);
  const auto remark = [&](const std::string& what) { remarks.add(node.file().name, node.line(), what); };
  if (!path) {
    remark("mesh '" + uri + "', which is not there: left out");
    return std::nullopt;
  }
  Vector3 scale = Vector3::Ones();
  if (node.child("scale")) scale = node.vector(node.child_text("scale"), "scale");
  if (node.child("submesh")) remark("submesh: the whole file is taken");
  remark("mesh: touches with its convex hull, of at most 64 corners");
  std::vector<model::MeshPart> parts = read_mesh_file(*path, node);
  for (model::MeshPart& part : parts)
    for (Vector3& point : part.points) point = scale.cwiseProduct(point);
  return SdfShape{make_mesh(parts, node), {}, false};
}

}  // namespace

std::optional<SdfShape> read_sdf_geometry(const Node& collision, RemarkList& remarks) {
  const std::optional<Node> geometry = collision.child("geometry");
  if (!geometry) collision.fail("no <geometry>", "one");
  const std::vector<Node> kinds = geometry->children();
  if (kinds.empty()) return std::nullopt;
  const Node& node = kinds.front();
  const std::string tag = node.tag();
  if (tag == "box") return SdfShape{make_solid(geometry::Box{0.5 * size_of(node, "size")}), {}, false};
  if (tag == "sphere") return SdfShape{make_solid(geometry::Capsule{0.0, length_of(node, "radius")}), {}, false};
  if (tag == "cylinder")
    return SdfShape{
        make_solid(geometry::Cylinder{0.5 * length_of(node, "length"), length_of(node, "radius")}), {}, false};
  if (tag == "capsule")
    return SdfShape{
        make_solid(geometry::Capsule{0.5 * length_of(node, "length"), length_of(node, "radius")}), {}, false};
  if (tag == "ellipsoid") {
    remarks.add(node.file().name, node.line(), "ellipsoid: touches with a hull of 64 corners on it");
    return SdfShape{make_ellipsoid(size_of(node, "radii")), {}, false};
  }
  if (tag == "plane") return read_plane(node);
  if (tag == "mesh") return read_sdf_mesh(node, remarks);
  if (tag != "empty") remarks.add(node.file().name, node.line(), "collision, " + printable(tag, 40) + ": left out");
  return std::nullopt;
}

Surface read_sdf_surface(const Node& collision, RemarkList& remarks) {
  Surface surface;
  const std::optional<Node> node = collision.child("surface");
  if (!node) return surface;
  const auto remark = [&](const Node& at, const std::string& what) { remarks.add(at.file().name, at.line(), what); };
  for (const Node& part : node->children()) {
    if (part.tag() == "friction") {
      for (const Node& engine : part.children()) {
        if (engine.tag() != "ode") {
          remark(engine, "friction, " + printable(engine.tag(), 40) + ": left out");
          continue;
        }
        const double mu = engine.number(engine.child_text("mu", "1"), "mu");
        const double mu2 = engine.number(engine.child_text("mu2", engine.child_text("mu", "1")), "mu2");
        if (mu < 0.0 || mu2 < 0.0) engine.fail("a negative mu", "coefficients >= 0");
        if (mu != mu2) remark(engine, "friction, mu2 other than mu: their mean, in all directions");
        surface.friction = 0.5 * (mu + mu2);
        for (const char* key : {"slip1", "slip2"})
          if (!engine.child_text(key).empty() && engine.number(engine.child_text(key), key) != 0.0)
            remark(engine, "friction, slip: left out");
      }
    } else if (part.tag() == "bounce") {
      const double e = part.number(part.child_text("restitution_coefficient", "0"), "restitution_coefficient");
      surface.restitution = std::clamp(e, 0.0, 1.0);
    } else if (part.tag() == "contact") {
      if (!part.children().empty()) remark(part, "surface, contact: left out, contacts are rigid here and all touch");
    } else {
      remark(part, "surface, " + printable(part.tag(), 40) + ": left out");
    }
  }
  return surface;
}

std::optional<SpatialInertia> read_sdf_inertial(const Node& link, RemarkList& remarks) {
  SpatialInertia inertia{1.0, Vector3::Zero(), Matrix3::Identity()};  // SDF's defaults
  const std::optional<Node> node = link.child("inertial");
  if (!node) return inertia;
  if (node->has("auto") && node->yes_or_no(node->attribute("auto"), "auto")) return std::nullopt;
  inertia.mass = node->number(node->child_text("mass", "1"), "mass");
  if (!(inertia.mass > 0.0)) node->fail("mass " + node->child_text("mass"), "kg, > 0");
  if (const std::optional<Node> moments = node->child("inertia")) {
    const auto value = [&](const char* key, const char* fallback) {
      return moments->number(moments->child_text(key, fallback), key);
    };
    const double xy = value("ixy", "0"), xz = value("ixz", "0"), yz = value("iyz", "0");
    inertia.inertia << value("ixx", "1"), xy, xz, xy, value("iyy", "1"), yz, xz, yz, value("izz", "1");
  }
  if (node->child("fluid_added_mass")) remarks.add(node->file().name, node->line(), "fluid_added_mass: left out");
  return moved(inertia, read_sdf_pose(*node).X);
}

}  // namespace snug::scene_import::internal
