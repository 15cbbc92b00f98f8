// Default classes, orientations and meshes of MJCF.
#include <cmath>
#include <numbers>
#include <sstream>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/scene_import/internal/mjcf.hpp"

namespace snug::scene_import::internal {
namespace {

constexpr int kDeepestClass = 100;
constexpr std::size_t kMostClasses = 2000;

std::string nearest_of(const std::string& name, const auto& map) {
  std::vector<std::string> names;
  for (const auto& [key, value] : map) names.push_back(key);
  const std::string_view nearest = find_nearest(name, names);
  return nearest.empty() ? "a name that is defined" : "'" + std::string(nearest) + "'";
}

MeshMass read_mesh_mass(const Node& node, const Attributes& attributes) {
  const std::string* word = find_attribute(attributes, "inertia");
  if (word == nullptr || *word == "legacy") return MeshMass::Pyramids;
  if (*word == "convex") return MeshMass::Hull;
  if (*word == "exact" || *word == "shell") return MeshMass::Enclosed;
  node.fail("inertia \"" + *word + "\"", "legacy, exact, convex or shell");
}

}  // namespace

double MjcfCompiler::radians(double angle) const { return uses_degrees ? angle * std::numbers::pi / 180.0 : angle; }

const std::string* find_attribute(const Attributes& attributes, const std::string& key) {
  const auto found = attributes.find(key);
  return found == attributes.end() ? nullptr : &found->second;
}

void MjcfDefaults::read(const Node& node) {
  const std::string name = node.attribute("class", main_);
  if (classes_.empty()) main_ = name;
  const auto known = classes_.find(name);
  const ByElement inherited = known == classes_.end() ? ByElement{} : known->second;
  read_class(node, inherited, name, 0);
}

void MjcfDefaults::read_class(const Node& node, const ByElement& inherited, const std::string& name, int depth) {
  if (depth > kDeepestClass || classes_.size() > kMostClasses) node.fail("too many default classes", "fewer");
  ByElement all = inherited;
  for (const Node& element : node.children()) {
    if (element.tag() != "geom" && element.tag() != "mesh") continue;
    Attributes& attributes = all[element.tag()];
    for (const auto* one = element.element()->FirstAttribute(); one != nullptr; one = one->Next())
      attributes[one->Name()] = element.attribute(one->Name());
  }
  classes_[name] = all;
  for (const Node& element : node.children()) {
    if (element.tag() != "default") continue;
    if (!element.has("class")) element.fail("no class", "a class of its own for nested defaults");
    read_class(element, all, element.attribute("class"), depth + 1);
  }
}

Attributes MjcfDefaults::attributes_of(const Node& node, const std::string& outer) const {
  const std::string name = node.attribute("class", outer.empty() ? main_ : outer);
  const auto found = classes_.find(name);
  if (found == classes_.end() && name != main_) node.fail("class '" + name + "'", nearest_of(name, classes_));
  Attributes attributes;
  if (found != classes_.end()) {
    const auto of_element = found->second.find(node.tag());
    if (of_element != found->second.end()) attributes = of_element->second;
  }
  // Where an element says one of several forms, the class's other forms do not count.
  const std::vector<const char*> turns = {"quat", "axisangle", "euler", "xyaxes", "zaxis"};
  for (const char* own : turns) {
    if (!node.has(own)) continue;
    for (const char* other : turns) attributes.erase(other);
  }
  for (const auto* one = node.element()->FirstAttribute(); one != nullptr; one = one->Next())
    attributes[one->Name()] = node.attribute(one->Name());
  return attributes;
}

Matrix3 read_orientation(const Node& node, const Attributes& attributes, const MjcfCompiler& compiler) {
  const auto direction = [&](const Vector3& v, const char* key) {
    if (!(v.norm() > 1e-10)) node.fail(std::string(key) + " of length 0", "a direction");
    return v.normalized();
  };
  if (const std::string* text = find_attribute(attributes, "axisangle")) {
    const std::vector<double> v = node.numbers(*text, "axisangle", 4, 4);
    return exp_rotation(compiler.radians(v[3]) * direction({v[0], v[1], v[2]}, "axisangle"));
  }
  if (const std::string* text = find_attribute(attributes, "euler")) {
    Vector3 angles = node.vector(*text, "euler");
    for (double& angle : angles) angle = compiler.radians(angle);
    return euler_rotation(angles, compiler.euler_order);
  }
  if (const std::string* text = find_attribute(attributes, "xyaxes")) {
    const std::vector<double> v = node.numbers(*text, "xyaxes", 6, 6);
    Matrix3 R;
    R.col(0) = direction({v[0], v[1], v[2]}, "xyaxes");
    const Vector3 y(v[3], v[4], v[5]);
    R.col(1) = direction(y - y.dot(R.col(0)) * R.col(0), "xyaxes");
    R.col(2) = R.col(0).cross(R.col(1));
    return R;
  }
  if (const std::string* text = find_attribute(attributes, "zaxis"))
    return rotation_of_z(direction(node.vector(*text, "zaxis"), "zaxis"));
  if (const std::string* text = find_attribute(attributes, "quat")) {
    const std::vector<double> v = node.numbers(*text, "quat", 4, 4);
    const Quaternion quat(v[0], v[1], v[2], v[3]);
    if (!(quat.norm() > 1e-10)) node.fail("a quat of length 0", "a rotation: w, x, y, z");
    return quat.normalized().toRotationMatrix();
  }
  return Matrix3::Identity();
}

Pose read_pose(const Node& node, const Attributes& attributes, const MjcfCompiler& compiler) {
  Pose X{read_orientation(node, attributes, compiler), Vector3::Zero()};
  if (const std::string* text = find_attribute(attributes, "pos")) X.p = node.vector(*text, "pos");
  return X;
}

void MjcfMeshes::read(const Node& node, const MjcfCompiler& compiler, const MjcfDefaults& defaults,
                      RemarkList& remarks) {
  Asset asset{node, defaults.attributes_of(node, ""), {}, std::nullopt};
  const std::string* file = find_attribute(asset.attributes, "file");
  std::string name = node.attribute("name");
  if (file != nullptr) {
    std::filesystem::path path = *file;
    if (name.empty()) name = path.stem().string();
    if (compiler.strips_paths) path = path.filename();
    if (path.is_relative()) path = std::filesystem::path(compiler.mesh_folder) / path;
    asset.path = path.is_relative() ? node.file().folder / path : path;
  }
  if (name.empty()) return;
  if (const std::string* word = find_attribute(asset.attributes, "inertia"); word != nullptr && *word == "shell")
    remarks.add(node.file().name, node.line(), "mesh, inertia=\"shell\": weighs as a solid");
  if (!assets_.emplace(name, asset).second) node.fail("a second mesh '" + name + "'", "each name once");
}

const Solid* MjcfMeshes::find(const std::string& name, const Node& geom) {
  const auto found = assets_.find(name);
  if (found == assets_.end()) geom.fail("mesh '" + name + "'", nearest_of(name, assets_));
  const bool is_built_in = found->second.path.empty() && find_attribute(found->second.attributes, "vertex") == nullptr;
  if (is_built_in) return nullptr;
  if (!found->second.solid) found->second.solid = load(found->second);
  return &*found->second.solid;
}

Solid MjcfMeshes::load(const Asset& asset) {
  const Node& node = asset.node;
  std::vector<model::MeshPart> parts;
  if (!asset.path.empty()) {
    parts = read_mesh_file(asset.path, node);
  } else {
    const std::vector<double> v = node.numbers(*find_attribute(asset.attributes, "vertex"), "vertex", 12, 300'000);
    if (v.size() % 3 != 0) node.fail(std::to_string(v.size()) + " numbers of vertex", "three for each point");
    parts.emplace_back();
    for (std::size_t i = 0; i < v.size(); i += 3) parts[0].points.emplace_back(v[i], v[i + 1], v[i + 2]);
    if (const std::string* faces = find_attribute(asset.attributes, "face")) {
      const std::vector<double> corners = node.numbers(*faces, "face", 3, 900'000);
      const auto count = static_cast<double>(parts[0].points.size());
      for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
        std::array<int, 3> triangle{};
        for (std::size_t k = 0; k < 3; ++k) {
          if (!(corners[i + k] >= 0.0 && corners[i + k] < count)) node.fail("a face of no vertex", "their numbers");
          triangle[k] = static_cast<int>(corners[i + k]);
        }
        parts[0].triangles.push_back(triangle);
      }
    }
  }
  Vector3 scale = Vector3::Ones(), at = Vector3::Zero();
  Matrix3 R = Matrix3::Identity();
  if (const std::string* text = find_attribute(asset.attributes, "scale")) scale = node.vector(*text, "scale");
  if (const std::string* text = find_attribute(asset.attributes, "refpos")) at = node.vector(*text, "refpos");
  if (const std::string* text = find_attribute(asset.attributes, "refquat")) {
    const std::vector<double> v = node.numbers(*text, "refquat", 4, 4);
    const Quaternion quat(v[0], v[1], v[2], v[3]);
    if (!(quat.norm() > 1e-10)) node.fail("a refquat of length 0", "a rotation: w, x, y, z");
    R = quat.normalized().toRotationMatrix();
  }
  for (model::MeshPart& part : parts)
    for (Vector3& point : part.points) point = scale.cwiseProduct(R.transpose() * (point - at));
  return make_mesh(parts, node, read_mesh_mass(node, asset.attributes));
}

}  // namespace snug::scene_import::internal
