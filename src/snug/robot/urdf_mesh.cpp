// read_mesh_hull: the convex hull of a mesh file that a URDF names, within the size that shapes may have.
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "snug/core/read_file.hpp"
#include "snug/geometry/convex_hull.hpp"
#include "snug/robot/internal/urdf.hpp"

namespace snug::robot::internal {
namespace {

std::filesystem::path find_mesh(const Element& mesh) {
  const std::string name = mesh.text("filename");
  std::filesystem::path path = name;
  if (name.starts_with("package://")) {
    // Without a ROS workspace a package is the folder of its name above the URDF, if there is one.
    const std::string rest = name.substr(10);
    const std::string package = rest.substr(0, rest.find('/'));
    for (std::filesystem::path up = std::filesystem::absolute(mesh.source().folder); up.has_relative_path();
         up = up.parent_path()) {
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

void collect_points(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, std::vector<Vector3>& points) {
  const aiMatrix4x4 transform = above * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D p = transform * part.mVertices[v];
      points.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) collect_points(scene, *node.mChildren[c], transform, points);
}

/// The points farthest in `count` directions spread evenly over the sphere (Fibonacci lattice).
std::vector<Vector3> extreme_points(const std::vector<Vector3>& points, int count) {
  std::vector<Vector3> chosen;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double r = std::sqrt(1.0 - z * z);
    const Vector3 direction(r * std::cos(golden * i), r * std::sin(golden * i), z);
    const auto farthest = std::max_element(points.begin(), points.end(), [&](const Vector3& a, const Vector3& b) {
      return a.dot(direction) < b.dot(direction);
    });
    if (std::find(chosen.begin(), chosen.end(), *farthest) == chosen.end()) chosen.push_back(*farthest);
  }
  return chosen;
}

}  // namespace

geometry::ConvexHull read_mesh_hull(const Element& mesh) {
  const std::filesystem::path path = find_mesh(mesh);
  // The library knows fifty more forms, few of them tried with files that are wrong.
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending != ".stl" && ending != ".dae" && ending != ".obj")
    mesh.fail("'" + path.string() + "'", "a mesh (STL, DAE, OBJ)");
  check_readable(path, "a mesh (STL, DAE, OBJ)", kLargestMesh);
  Assimp::Importer importer;
  // COLLADA's own up axis is kept as ROS tools keep it: the file's numbers are the link's.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_JoinIdenticalVertices);
  if (scene == nullptr || scene->mRootNode == nullptr)
    mesh.fail("'" + path.string() + "': " + importer.GetErrorString(), "a mesh (STL, DAE, OBJ)");
  std::vector<Vector3> points;
  collect_points(*scene, *scene->mRootNode, aiMatrix4x4(), points);
  const Vector3 scale = mesh.vector3_or("scale", Vector3::Ones());
  for (Vector3& point : points) point = point.cwiseProduct(scale);
  auto hull = geometry::make_convex_hull(points);
  // Too many corners: those farthest in fewer and fewer directions, which cuts a little off (docs/theory/robot.md).
  for (int count = geometry::kMaxHullVertices; !hull && hull.error() == geometry::NoHull::TooManyVertices; count -= 4)
    hull = geometry::make_convex_hull(extreme_points(points, count));
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
