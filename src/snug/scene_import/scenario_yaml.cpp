// format_scenario: a raw scene as the text of a scenario.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "snug/core/text.hpp"
#include "snug/scene_import/internal/raw_scene.hpp"

namespace snug::scene_import::internal {
namespace {

/// YAML takes any text between double quotes that is JSON.
std::string quoted(const std::string& text) { return nlohmann::json(text).dump(); }

std::string list(const Vector3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

std::string pose_text(const Pose& X) {
  std::string text = fmt::format("{{position: {}", list(X.p));
  if (X.R != Matrix3::Identity()) {
    const Quaternion quat = Quaternion(X.R).normalized();
    text += fmt::format(", quat_wxyz: [{}, {}, {}, {}]", quat.w(), quat.x(), quat.y(), quat.z());
  }
  return text + "}";
}

std::string shape_text(const model::PlacedShape& placed) {
  struct Writer {
    std::string operator()(const geometry::Box& box) const { return "box: " + list(2.0 * box.half); }
    std::string operator()(const geometry::Capsule& capsule) const {
      return fmt::format("capsule: {{length: {}, radius: {}}}", 2.0 * capsule.half_length, capsule.radius);
    }
    std::string operator()(const geometry::Cylinder& cylinder) const {
      return fmt::format("cylinder: {{length: {}, radius: {}}}", 2.0 * cylinder.half_length, cylinder.radius);
    }
    std::string operator()(const geometry::ConvexHull& hull) const {
      std::string text = "hull: [";
      for (std::size_t i = 0; i < hull.vertices.size(); ++i) text += (i == 0 ? "" : ", ") + list(hull.vertices[i]);
      return text + "]";
    }
  };
  return fmt::format("{{{}, pose: {}}}", std::visit(Writer{}, placed.shape), pose_text(placed.X_BG));
}

/// Contact of two surfaces, as the simulator that the scene is of has it.
std::string contact_text(const Surface& a, const Surface& b, Combination combination) {
  Surface one = a;
  if (combination == Combination::Smaller) {
    one.friction = std::min(a.friction, b.friction);
    one.restitution = std::min(a.restitution, b.restitution);
    one.torsional = one.rolling = 0.0;
  } else if (a.priority != b.priority) {
    one = a.priority > b.priority ? a : b;
  } else {
    one.friction = std::max(a.friction, b.friction);
    one.torsional = std::max(a.torsional, b.torsional);
    one.rolling = std::max(a.rolling, b.rolling);
    one.dimensions = std::max(a.dimensions, b.dimensions);
  }
  if (combination == Combination::Larger) {
    if (one.dimensions < 6) one.rolling = 0.0;
    if (one.dimensions < 4) one.torsional = 0.0;
    if (one.dimensions < 3) one.friction = 0.0;
  }
  std::string text = fmt::format("friction: {}, restitution: {}", one.friction, one.restitution);
  if (one.torsional > 0.0) text += fmt::format(", torsional_friction: {}", one.torsional);
  if (one.rolling > 0.0) text += fmt::format(", rolling_resistance: {}", one.rolling);
  return text;
}

std::string inertia_text(const SpatialInertia& inertia) {
  const Matrix3& I = inertia.inertia;
  return fmt::format("    mass: {}\n    com: {}\n    inertia: [{}, {}, {}, {}, {}, {}]\n", inertia.mass,
                     list(inertia.com), I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
}

}  // namespace

std::string format_scenario(RawScene& scene, const std::string& source) {
  merge_statics(scene);
  name_bodies(scene);
  std::vector<Surface> surfaces;
  for (const RawBody& body : scene.bodies) surfaces.push_back(body.shapes.front().surface);
  std::sort(surfaces.begin(), surfaces.end());
  surfaces.erase(std::unique(surfaces.begin(), surfaces.end()), surfaces.end());
  const auto material_of = [&](const Surface& surface) {
    return "surface " +
           std::to_string(std::lower_bound(surfaces.begin(), surfaces.end(), surface) - surfaces.begin() + 1);
  };
  std::string text = "# made of " + printable(source, 100) + " by `snug convert`\n";
  text += fmt::format("name: {}\ngravity: {}\ntime_step: {}\n", quoted(printable(scene.name, 60)), list(scene.gravity),
                      scene.time_step);
  text += "materials:\n";
  for (const Surface& surface : surfaces) text += fmt::format("  - {{name: {}}}\n", material_of(surface));
  text += "contacts:\n  pairs:\n";
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    for (std::size_t j = i; j < surfaces.size(); ++j)
      text += fmt::format("    - {{between: [{}, {}], {}}}\n", material_of(surfaces[i]), material_of(surfaces[j]),
                          contact_text(surfaces[i], surfaces[j], scene.combination));
  text += "bodies:\n";
  for (const RawBody& body : scene.bodies) {
    text += fmt::format("  - name: {}\n    kind: {}\n    material: {}\n    pose: {}\n", quoted(body.name),
                        body.is_static ? "static" : "dynamic", material_of(body.shapes.front().surface),
                        pose_text(body.X_WB));
    if (!body.is_static) text += inertia_text(body.inertia);
    text += "    shapes:\n";
    for (const RawShape& shape : body.shapes) text += "      - " + shape_text(shape.placed) + "\n";
  }
  return text;
}

}  // namespace snug::scene_import::internal
