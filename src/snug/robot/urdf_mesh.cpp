// read_mesh_hull: the convex hull of a mesh file that a URDF names, within the size that shapes may have.
#include <algorithm>
#include <filesystem>

#include "snug/model/mesh_file.hpp"
#include "snug/robot/internal/urdf.hpp"

namespace snug::robot::internal {

std::filesystem::path find_mesh(const Element& mesh) {
  const std::string name = mesh.text("filename");
  std::filesystem::path path = name;
  if (name.starts_with("package://")) {
    // Without a ROS workspace a package is the folder of its name above the URDF, if there is one.
    const std::string rest = name.substr(10);
    const std::string package = rest.substr(0, rest.find('/'));
    const std::filesystem::path& folder = mesh.source().folder;  // empty: that of a bare name
    for (std::filesystem::path up = folder.empty() ? std::filesystem::current_path()
                                                   : std::filesystem::absolute(folder);
         up.has_relative_path(); up = up.parent_path()) {
      if (std::filesystem::exists(up / rest)) return up / rest;
      if (up.filename() == package && std::filesystem::exists(up.parent_path() / rest)) return up.parent_path() / rest;
    }
    mesh.fail("'" + name + "', and no folder '" + package + "' with it beside or above the URDF",
              "a path relative to the URDF: package:// means a ROS workspace, which is not asked for here");
  }
  if (name.starts_with("file://")) path = name.substr(7);
  if (path.is_relative()) path = mesh.source().folder / path;
  if (!std::filesystem::is_regular_file(path))
    mesh.fail("'" + name + "', which is not there (looked for " + path.string() + ")",
              "a mesh file, path relative to the URDF");
  return path;
}

geometry::ConvexHull read_mesh_hull(const Element& mesh) {
  const std::filesystem::path path = find_mesh(mesh);
  const model::MeshParts parts = model::read_mesh_parts(path);
  if (!parts.error.empty()) mesh.fail("'" + path.string() + "': " + parts.error, "a mesh (STL, DAE, OBJ)");
  std::vector<Vector3> points;
  for (const model::MeshPart& part : parts.parts) points.insert(points.end(), part.points.begin(), part.points.end());
  const Vector3 scale = mesh.vector3_or("scale", Vector3::Ones());
  for (Vector3& point : points) point = point.cwiseProduct(scale);
  const auto hull = model::make_simple_hull(points);
  if (!hull) {
    if (hull.error() == geometry::NoHull::NotFinite)
      mesh.fail("'" + path.string() + "' with points that are not finite", "numbers");
    mesh.fail("'" + path.string() + "' with " + std::to_string(points.size()) + " points that span no volume",
              "a mesh with a volume");
  }
  // A hull of metres is no part of an arm: such files are in millimetres.
  double extent = 0.0;
  for (const Vector3& point : points) extent = std::max(extent, point.norm());
  if (extent > 10.0)
    mesh.fail("'" + path.string() + "' reaching " + std::to_string(extent) + " m",
              "metres; for millimetres write scale=\"0.001 0.001 0.001\"");
  return *hull;
}

}  // namespace snug::robot::internal
