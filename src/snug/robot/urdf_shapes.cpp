// Shapes of a URDF as convex shapes that can collide: boxes, capsules, prisms around cylinders, hulls of meshes.
#include <cmath>
#include <numbers>
#include <optional>

#include "snug/core/check.hpp"
#include "snug/geometry/convex_hull.hpp"
#include "snug/robot/internal/urdf.hpp"

namespace snug::robot::internal {
namespace {

/// Corners of the prism around a cylinder: it stands out by 1 / cos(pi / 24) - 1 = 0.9 % of the radius at most.
constexpr int kCylinderCorners = 24;

struct Cylinder {
  double radius = 0.0;
  double length = 0.0;
  Pose X_LG;
  bool is_capsule_part = false;
};

struct Ball {
  double radius = 0.0;
  Pose X_LG;
  bool is_capsule_part = false;
};

double positive(const Element& element, const char* key) {
  const double value = element.number(key);
  if (!(value > 0.0 && value <= 100.0))
    element.fail(std::string(key) + "=\"" + element.text(key) + "\"", "metres, > 0");
  return value;
}

/// A shape whose every number is 0, or a mesh without a name: exporters write them for links without shape.
bool has_no_extent(const Element& kind) {
  const auto is_zero = [&](const char* key) { return !kind.has_attribute(key) || kind.number(key) == 0.0; };
  if (kind.tag() == "box" && kind.has_attribute("size")) {
    const std::vector<double> size = kind.numbers("size", 3);
    return size[0] == 0.0 && size[1] == 0.0 && size[2] == 0.0;
  }
  if (kind.tag() == "sphere") return kind.has_attribute("radius") && is_zero("radius");
  if (kind.tag() == "cylinder" || kind.tag() == "capsule")
    return kind.has_attribute("radius") && is_zero("radius") && is_zero("length");
  return kind.tag() == "mesh" && kind.has_attribute("filename") && kind.is_empty("filename");
}

geometry::ConvexHull make_prism(double radius, double length) {
  std::vector<Vector3> points;
  const double outer = radius / std::cos(std::numbers::pi / kCylinderCorners);
  for (int i = 0; i < kCylinderCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCylinderCorners;
    for (const double z : {-0.5 * length, 0.5 * length})
      points.emplace_back(outer * std::cos(angle), outer * std::sin(angle), z);
  }
  auto hull = geometry::make_convex_hull(points);
  SNUG_CHECK(hull.has_value(), "a prism has a hull");
  return *hull;
}

/// Finds the ball of the cylinder's radius at the middle of its end face and takes it.
bool take_ball(std::vector<Ball>& balls, const Cylinder& cylinder, double side) {
  const Vector3 end = cylinder.X_LG * Vector3(0.0, 0.0, side * 0.5 * cylinder.length);
  for (Ball& ball : balls) {
    // 10 um: what a person rounds to when writing the file.
    if (ball.is_capsule_part || std::abs(ball.radius - cylinder.radius) > 1e-5 || (ball.X_LG.p - end).norm() > 1e-5)
      continue;
    ball.is_capsule_part = true;
    return true;
  }
  return false;
}

}  // namespace

std::vector<model::PlacedShape> read_shapes(const Element& link) {
  std::vector<model::PlacedShape> shapes;
  std::vector<Cylinder> cylinders;
  std::vector<Ball> balls;
  for (const Element& collision : link.children("collision")) {
    collision.check_tags({"origin", "geometry", "verbose"});
    const Pose X_LG = read_origin(collision);
    if (!collision.has("geometry")) continue;  // empty, as exporters write for links without shape
    const Element geometry = collision.child("geometry");
    const std::vector<Element> kinds = geometry.children();
    if (kinds.empty() || has_no_extent(kinds.front())) continue;
    if (kinds.size() != 1)
      geometry.fail(std::to_string(kinds.size()) + " elements", "one of <box>, <cylinder>, <sphere>, <mesh>");
    const Element& kind = kinds.front();
    if (kind.tag() == "box") {
      const std::vector<double> size = kind.numbers("size", 3);
      const Vector3 half = 0.5 * Vector3(size[0], size[1], size[2]);
      if (!(half.minCoeff() > 0.0 && half.maxCoeff() <= 100.0))
        kind.fail("size=\"" + kind.text("size") + "\"", "metres, > 0");
      shapes.push_back({geometry::Box{half}, X_LG});
    } else if (kind.tag() == "cylinder") {
      cylinders.push_back({positive(kind, "radius"), positive(kind, "length"), X_LG});
    } else if (kind.tag() == "sphere") {
      balls.push_back({positive(kind, "radius"), X_LG});
    } else if (kind.tag() == "capsule") {
      shapes.push_back({geometry::Capsule{0.5 * positive(kind, "length"), positive(kind, "radius")}, X_LG});
    } else if (kind.tag() == "mesh") {
      shapes.push_back({read_mesh_hull(kind), X_LG});
    } else {
      kind.fail("<" + kind.tag() + ">", "<box>, <cylinder>, <sphere>, <capsule> or <mesh>");
    }
  }
  for (Cylinder& cylinder : cylinders) {
    std::vector<Ball> left = balls;
    cylinder.is_capsule_part = take_ball(left, cylinder, -1.0) && take_ball(left, cylinder, 1.0);
    if (cylinder.is_capsule_part) balls = left;
    if (cylinder.is_capsule_part)
      shapes.push_back({geometry::Capsule{0.5 * cylinder.length, cylinder.radius}, cylinder.X_LG});
    else
      shapes.push_back({make_prism(cylinder.radius, cylinder.length), cylinder.X_LG});
  }
  for (const Ball& ball : balls)
    if (!ball.is_capsule_part) shapes.push_back({geometry::Capsule{0.0, ball.radius}, ball.X_LG});
  return shapes;
}

}  // namespace snug::robot::internal
