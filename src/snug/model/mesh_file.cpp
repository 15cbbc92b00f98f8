// Mesh files as convex hulls: what a shape of a scenario or a link of a robot names.
#include "snug/model/mesh_file.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "snug/core/read_file.hpp"

namespace snug::model {
namespace {

void collect_points(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, MeshParts& mesh) {
  const aiMatrix4x4 transform = above * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    std::vector<Vector3>& points = mesh.parts.emplace_back();
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D p = transform * part.mVertices[v];
      points.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) collect_points(scene, *node.mChildren[c], transform, mesh);
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

MeshParts read_mesh_parts(const std::filesystem::path& path) {
  MeshParts mesh;
  // The library knows fifty more forms, few of them tried with files that are wrong.
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  if (ending != ".stl" && ending != ".dae" && ending != ".obj") {
    mesh.error = "not a file of these forms";
    return mesh;
  }
  check_readable(path, "a mesh (STL, DAE, OBJ)", kLargestMesh);
  Assimp::Importer importer;
  // COLLADA's own up axis is kept as ROS tools keep it: the file's numbers are the link's.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_JoinIdenticalVertices);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    mesh.error = importer.GetErrorString();
    return mesh;
  }
  collect_points(*scene, *scene->mRootNode, aiMatrix4x4(), mesh);
  return mesh;
}

Expected<geometry::ConvexHull, geometry::NoHull> make_simple_hull(const std::vector<Vector3>& points) {
  auto hull = geometry::make_convex_hull(points);
  for (int count = geometry::kMaxHullVertices; !hull && hull.error() == geometry::NoHull::TooManyVertices; count -= 4)
    hull = geometry::make_convex_hull(extreme_points(points, count));
  return hull;
}

}  // namespace snug::model
