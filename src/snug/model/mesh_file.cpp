// Mesh files as convex hulls: what a shape of a scenario or a link of a robot names.
#include "snug/model/mesh_file.hpp"

#include <assimp/DefaultIOSystem.h>
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

/// Takes what it adds off `left`; false when that is not enough: a mesh may have any number of instances.
bool collect_parts(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, std::size_t& left,
                   MeshParts& mesh) {
  const aiMatrix4x4 transform = above * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    if (part.mNumVertices > left) return false;
    left -= part.mNumVertices;
    auto& [points, triangles] = mesh.parts.emplace_back();
    points.reserve(part.mNumVertices);
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D p = transform * part.mVertices[v];
      points.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      for (unsigned k = 1; k + 1 < face.mNumIndices; ++k)
        triangles.push_back({static_cast<int>(face.mIndices[0]), static_cast<int>(face.mIndices[k]),
                             static_cast<int>(face.mIndices[k + 1])});
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    if (!collect_parts(scene, *node.mChildren[c], transform, left, mesh)) return false;
  }
  return true;
}

/// The points farthest in `count` directions spread evenly over the sphere (Fibonacci lattice).
std::vector<Vector3> extreme_points(const std::vector<Vector3>& points, int count) {
  std::vector<Vector3> chosen;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count;
    const double r = std::sqrt(1.0 - z * z);
    const Vector3 direction(r * std::cos(golden * i), r * std::sin(golden * i), z);
    const Vector3* farthest = points.data();
    double most = farthest->dot(direction);
    for (const Vector3& p : points) {
      const double along = p.dot(direction);
      if (!(most < along)) continue;
      most = along;
      farthest = &p;
    }
    if (std::find(chosen.begin(), chosen.end(), *farthest) == chosen.end()) chosen.push_back(*farthest);
  }
  return chosen;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// Files above this are not searched for equal points by the library, which takes 40 times their size: bytes.
constexpr std::size_t kLargestJoined = std::size_t{1} << 20U;

constexpr const char* kTooMuch = "more faces, objects, elements or instances of nodes than its size allows";

/// Bytes that the library takes for what a text says, at most about: measured with files of nothing else.
constexpr double kPerWord = 60.0, kPerFace = 150.0, kPerObject = 40'000.0, kPerElement = 2000.0;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

double count_words(std::string_view text) {
  double words = 0.0;
  for (std::size_t i = 0; i < text.size(); ++i)
    words += !is_blank(text[i]) && (i == 0 || is_blank(text[i - 1])) ? 1 : 0;
  return words;
}

double obj_memory(std::string_view text) {
  double bytes = 0.0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (line.empty() || line.front() == 'v' || line.front() == '#') continue;
    bytes += kPerWord * count_words(line);
    if (line.front() == 'f' || line.front() == 'l' || line.front() == 'p') bytes += kPerFace;
    if (line.front() == 'o' || line.front() == 'g' || line.starts_with("usemtl")) bytes += kPerObject;
  }
  return bytes;
}

double dae_memory(std::string_view text) {
  const auto elements = static_cast<double>(std::count(text.begin(), text.end(), '<'));
  int instances = 0;
  for (std::size_t at = 0; (at = text.find("<instance_node", at)) != std::string_view::npos; ++at) ++instances;
  // Nodes of instances of nodes: n of them multiply what they hold by 3^(n / 3) at most.
  return kPerWord * count_words(text) + kPerElement * elements * std::pow(3.0, instances / 3.0);
}

/// Would the library take much more than 20 times the size? STL never does.
bool takes_too_much(std::string_view text, const std::string& ending) {
  const double allowed = 20.0 * static_cast<double>(text.size()) + 60e6;
  return (ending == ".obj" && obj_memory(text) > allowed) || (ending == ".dae" && dae_memory(text) > allowed);
}

/// Opens the mesh and nothing that it names: materials mean nothing for hulls, and may be anything.
class OneFile : public Assimp::DefaultIOSystem {
 public:
  explicit OneFile(std::string path) : path_(std::move(path)) {}
  bool Exists(const char* file) const override { return file == path_ && DefaultIOSystem::Exists(file); }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    return file == path_ ? DefaultIOSystem::Open(file, mode) : nullptr;
  }

 private:
  std::string path_;
};

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
  if (!is_known(known) || bytes.size() > kLargestDrawn || takes_too_much(bytes, known)) return meshes;
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFileFromMemory(
      bytes.data(), bytes.size(), aiProcess_JoinIdenticalVertices | aiProcess_Triangulate, known.c_str() + 1);
  if (scene != nullptr && scene->mRootNode != nullptr) collect_drawn(*scene, *scene->mRootNode, aiMatrix4x4(), meshes);
  return meshes;
}

MeshParts read_mesh_parts(const std::filesystem::path& path) {
  MeshParts mesh;
  const std::string ending = lower(path.extension().string());
  if (!is_known(ending)) {
    mesh.error = "not a file of these forms";
    return mesh;
  }
  std::size_t size = 0;
  {
    const std::string text = read_file(path, "a mesh (STL, DAE, OBJ)", kLargestMesh);
    size = text.size();
    if (takes_too_much(text, ending)) {
      mesh.error = kTooMuch;
      return mesh;
    }
  }
  Assimp::Importer importer;
  importer.SetIOHandler(new OneFile(path.string()));  // the importer's from here on
  // COLLADA's own up axis is kept as ROS tools keep it: the file's numbers are the link's.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path.string(), size > kLargestJoined ? 0U : aiProcess_JoinIdenticalVertices);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    mesh.error = importer.GetErrorString();
    return mesh;
  }
  std::size_t left = 1'000'000 + size / 2;
  if (!collect_parts(*scene, *scene->mRootNode, aiMatrix4x4(), left, mesh)) return {{}, kTooMuch};
  return mesh;
}

Expected<geometry::ConvexHull, geometry::NoHull> make_simple_hull(const std::vector<Vector3>& points) {
  auto hull = geometry::make_convex_hull(points);
  for (int count = geometry::kMaxHullVertices; !hull && hull.error() == geometry::NoHull::TooManyVertices; count -= 4)
    hull = geometry::make_convex_hull(extreme_points(points, count));
  return hull;
}

}  // namespace snug::model
