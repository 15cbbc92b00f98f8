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

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// The library knows fifty more forms, few of them tried with files that are wrong.
bool is_known(const std::string& ending) { return ending == ".stl" || ending == ".dae" || ending == ".obj"; }

std::optional<std::array<double, 4>> colour_of(const aiScene& scene, const aiMesh& part) {
  aiColor4D colour;
  if (part.mMaterialIndex >= scene.mNumMaterials ||
      scene.mMaterials[part.mMaterialIndex]->Get(AI_MATKEY_COLOR_DIFFUSE, colour) != AI_SUCCESS)
    return std::nullopt;
  const auto within = [](float x) { return std::isfinite(x) ? std::clamp(static_cast<double>(x), 0.0, 1.0) : 1.0; };
  return std::array<double, 4>{within(colour.r), within(colour.g), within(colour.b), within(colour.a)};
}

void collect_drawn(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, std::vector<DrawnMesh>& meshes) {
  const aiMatrix4x4 transform = above * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    DrawnMesh mesh;
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D p = transform * part.mVertices[v];
      mesh.vertices.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
      if (!mesh.vertices.back().allFinite()) return;
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // lines and points
      mesh.triangles.push_back(
          {static_cast<int>(face.mIndices[0]), static_cast<int>(face.mIndices[1]), static_cast<int>(face.mIndices[2])});
    }
    mesh.rgba = colour_of(scene, part);
    if (!mesh.triangles.empty()) meshes.push_back(std::move(mesh));
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) collect_drawn(scene, *node.mChildren[c], transform, meshes);
}

}  // namespace

std::vector<DrawnMesh> parse_drawn_meshes(std::string_view bytes, const std::string& ending) {
  std::vector<DrawnMesh> meshes;
  const std::string known = lower(ending);
  if (!is_known(known) || bytes.size() > kLargestMesh) return meshes;
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFileFromMemory(
      bytes.data(), bytes.size(), aiProcess_JoinIdenticalVertices | aiProcess_Triangulate, known.c_str() + 1);
  if (scene != nullptr && scene->mRootNode != nullptr) collect_drawn(*scene, *scene->mRootNode, aiMatrix4x4(), meshes);
  return meshes;
}

MeshParts read_mesh_parts(const std::filesystem::path& path) {
  MeshParts mesh;
  if (!is_known(lower(path.extension().string()))) {
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
