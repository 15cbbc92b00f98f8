// Visuals: how the links of a URDF look.
#include "snug/robot/visuals.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/robot/internal/urdf.hpp"

namespace snug::robot {
namespace {

using internal::Element;

/// A URDF's text as elements, as long as this lives.
struct Document {
  tinyxml2::XMLDocument xml;
  internal::UrdfSource source;
  std::optional<Element> robot;

  Document(const std::string& text, const std::string& name, const std::filesystem::path& folder)
      : source{name, folder} {
    if (text.size() > internal::kLargestUrdf || xml.Parse(text.c_str(), text.size()) != tinyxml2::XML_SUCCESS) return;
    if (xml.RootElement() != nullptr) robot.emplace(xml.RootElement(), source, "");
  }
};

std::optional<Rgba> read_colour(const Element& material) {
  if (!material.has("color")) return std::nullopt;
  const std::vector<double> v = material.child("color").numbers("rgba", 4);
  Rgba rgba{};
  for (std::size_t i = 0; i < 4; ++i) rgba[i] = std::clamp(v[i], 0.0, 1.0);
  return rgba;
}

/// Materials of the robot by name: visuals may only refer to them.
std::map<std::string, Rgba> read_materials(const Element& robot) {
  std::map<std::string, Rgba> materials;
  for (const Element& material : robot.children("material")) {
    try {
      if (const auto rgba = read_colour(material)) materials.emplace(material.text("name"), *rgba);
    } catch (const InputError&) {  // a colour is worth no failure
    }
  }
  return materials;
}

std::optional<Rgba> colour_of(const Element& visual, const std::map<std::string, Rgba>& materials) {
  if (!visual.has("material")) return std::nullopt;
  const Element material = visual.child("material");
  if (const auto rgba = read_colour(material)) return rgba;
  const auto found = material.has_attribute("name") ? materials.find(material.text("name")) : materials.end();
  return found == materials.end() ? std::nullopt : std::optional(found->second);
}

double visual_size(const Element& element, const char* key) {
  const double value = element.number(key);
  if (!(value > 0.0 && value <= 100.0)) element.fail(key, "metres, > 0");
  return value;
}

void add_mesh(const Element& mesh, const Visual& like, bool has_colour, const std::vector<MeshFile>& meshes,
              std::vector<Visual>& visuals) {
  const std::string name = mesh.text("filename");
  const auto file = std::ranges::find(meshes, name, &MeshFile::name);
  if (file == meshes.end()) return;
  const Vector3 scale = mesh.vector3_or("scale", Vector3::Ones());
  for (model::DrawnMesh& part : model::parse_drawn_meshes(file->bytes, std::filesystem::path(name).extension())) {
    for (Vector3& vertex : part.vertices) vertex = vertex.cwiseProduct(scale);
    Visual visual = like;
    if (!has_colour && part.rgba) visual.rgba = *part.rgba;
    visual.shape = std::move(part);
    visuals.push_back(std::move(visual));
  }
}

void add_visual(const Element& element, const std::map<std::string, Rgba>& materials,
                const std::vector<MeshFile>& meshes, std::vector<Visual>& visuals) {
  Visual visual;
  visual.X_LG = internal::read_origin(element);
  const std::optional<Rgba> colour = colour_of(element, materials);
  if (colour) visual.rgba = *colour;
  const std::vector<Element> kinds = element.child("geometry").children();
  if (kinds.size() != 1) return;
  const Element& kind = kinds.front();
  if (kind.tag() == "mesh") return add_mesh(kind, visual, colour.has_value(), meshes, visuals);
  if (kind.tag() == "box") {
    const std::vector<double> size = kind.numbers("size", 3);
    visual.shape = geometry::Box{0.5 * Vector3(size[0], size[1], size[2])};
  } else if (kind.tag() == "cylinder") {
    geometry::Cylinder cylinder;
    cylinder.radius = visual_size(kind, "radius");
    cylinder.half_length = 0.5 * visual_size(kind, "length");
    visual.shape = cylinder;
  } else if (kind.tag() == "sphere" || kind.tag() == "capsule") {
    const double half_length = kind.tag() == "capsule" ? 0.5 * visual_size(kind, "length") : 0.0;
    visual.shape = geometry::Capsule{half_length, visual_size(kind, "radius")};
  } else {
    return;
  }
  visuals.push_back(std::move(visual));
}

/// Files are put into pages and exports that go to others: no file is that a stranger's URDF only calls a mesh.
bool is_mesh_name(const std::string& name) {
  std::string extension = std::filesystem::path(name).extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension == ".stl" || extension == ".dae" || extension == ".obj";
}

}  // namespace

std::vector<MeshFile> read_visual_meshes(const std::filesystem::path& urdf, std::size_t most_bytes) {
  std::vector<MeshFile> files;
  const Document document(read_file(urdf, "a URDF", internal::kLargestUrdf), urdf.string(), urdf.parent_path());
  if (!document.robot || document.robot->tag() != "robot")
    throw InputError(urdf.string(), "", "something else", "a URDF: XML with <robot>");
  std::size_t left = most_bytes;
  for (const Element& link : document.robot->children("link")) {
    for (const Element& visual : link.children("visual")) {
      try {
        const Element geometry = visual.child("geometry");
        if (!geometry.has("mesh")) continue;
        const Element mesh = geometry.child("mesh");
        const std::string name = mesh.text("filename");
        if (!is_mesh_name(name) || std::ranges::find(files, name, &MeshFile::name) != files.end()) continue;
        std::string bytes = read_file(internal::find_mesh(mesh), "a mesh", left);
        left -= bytes.size();
        files.push_back({name, std::move(bytes)});
      } catch (const InputError&) {  // not there or too large: the link is drawn from its shapes
      }
    }
  }
  return files;
}

std::vector<LinkVisuals> parse_visuals(const std::string& urdf, const std::vector<MeshFile>& meshes) {
  std::vector<LinkVisuals> links;
  const Document document(urdf, "URDF of the recording", {});
  if (!document.robot) return links;
  const std::map<std::string, Rgba> materials = read_materials(*document.robot);
  for (const Element& link : document.robot->children("link")) {
    LinkVisuals look;
    for (const Element& visual : link.children("visual")) {
      try {
        look.link = link.text("name");
        add_visual(visual, materials, meshes, look.visuals);
      } catch (const InputError&) {  // a look is worth no failure
      }
    }
    if (!look.visuals.empty()) links.push_back(std::move(look));
  }
  return links;
}

}  // namespace snug::robot
