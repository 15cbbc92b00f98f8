// read_mesh_hull: the convex hull of a mesh file that a URDF names, within the size that shapes may have.
#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/model/mesh_file.hpp"
#include "snug/robot/internal/urdf.hpp"

namespace snug::robot::internal {

namespace {

constexpr std::string_view kPackage = "package://";
constexpr std::size_t kLargestManifest = std::size_t{1} << 16U;

/// A path of the form package://NAME/REST.
struct PackagePath {
  std::string package, rest;
};
PackagePath split_package(const std::string& name) {
  const std::string path = name.substr(kPackage.size());
  const std::size_t slash = std::min(path.find('/'), path.size());
  return {path.substr(0, slash), path.substr(std::min(slash + 1, path.size()))};
}

/// The folders from the URDF's up; calls visit(folder) until it says true, then returns that folder, else nothing.
template <class Visit>
std::filesystem::path find_above(const Element& mesh, const Visit& visit) {
  const std::filesystem::path& folder = mesh.source().folder;  // empty: that of a bare name
  for (std::filesystem::path up = folder.empty() ? std::filesystem::current_path() : std::filesystem::absolute(folder);
       up.has_relative_path(); up = up.parent_path()) {
    if (visit(up)) return up;
  }
  return {};
}

bool is_file(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

/// The folder that stands for a package; empty: there is none.
std::filesystem::path find_package(const Element& mesh, const PackagePath& path) {
  std::filesystem::path found;
  const auto has_name = [&](const std::filesystem::path& up) {
    for (const std::filesystem::path& one : {up / path.package, up}) {
      found = one;
      if (one.filename() == path.package && is_file(one / path.rest)) return true;
    }
    return false;
  };
  if (!find_above(mesh, has_name).empty()) return found;
  if (path.rest.empty()) return {};
  return find_above(mesh, [&](const std::filesystem::path& up) { return is_file(up / path.rest); });
}

/// The name that the package.xml of a folder gives; empty without one.
std::string manifest_name(const std::filesystem::path& folder) {
  try {
    const std::string text = read_file(folder / "package.xml", "a package.xml", kLargestManifest);
    tinyxml2::XMLDocument document;
    if (document.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS || document.RootElement() == nullptr)
      return "";
    const tinyxml2::XMLElement* name = document.RootElement()->FirstChildElement("name");
    return name == nullptr || name->GetText() == nullptr ? "" : name->GetText();
  } catch (const InputError&) {
    return "";
  }
}

}  // namespace

std::filesystem::path renamed_package(const Element& mesh) {
  if (!mesh.has_attribute("filename") || mesh.is_empty("filename")) return {};
  const std::string name = mesh.text("filename");
  if (!name.starts_with(kPackage)) return {};
  const PackagePath path = split_package(name);
  std::filesystem::path folder = find_package(mesh, path);
  if (folder.filename() == path.package || manifest_name(folder) == path.package) return {};
  return folder;
}

std::filesystem::path find_mesh(const Element& mesh) {
  const std::string name = mesh.text("filename");
  std::filesystem::path path = name;
  if (name.starts_with(kPackage)) {
    const PackagePath parts = split_package(name);
    const std::filesystem::path package = find_package(mesh, parts);
    if (package.empty())
      mesh.fail("'" + name + "', and no folder '" + parts.package + "' with it beside or above the URDF",
                "a path relative to the URDF: package:// means a ROS workspace, which is not asked for here");
    return package / parts.rest;
  }
  if (name.starts_with("file://")) path = name.substr(7);
  if (path.is_relative()) path = mesh.source().folder / path;
  if (!is_file(path))
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
