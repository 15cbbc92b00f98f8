// Solids: shapes that touch, and the mass that stands behind them.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/core/text.hpp"
#include "snug/geometry/convex_hull.hpp"
#include "snug/model/mass_properties.hpp"
#include "snug/model/mesh_file.hpp"
#include "snug/scene_import/internal/shapes.hpp"

namespace snug::scene_import::internal {
namespace {

constexpr int kEllipsoidCorners = 64;

/// Tetrahedra between an origin and the triangles, by their signs (as of hulls in model/mass_properties.cpp).
SpatialInertia enclosed(const std::vector<model::MeshPart>& parts) {
  double volume = 0.0;
  Vector3 first = Vector3::Zero();
  Matrix3 second = Matrix3::Zero();
  const Vector3 origin = parts.front().points.front();
  for (const model::MeshPart& part : parts) {
    for (const auto& triangle : part.triangles) {
      const Vector3 a = part.points[static_cast<std::size_t>(triangle[0])] - origin;
      const Vector3 b = part.points[static_cast<std::size_t>(triangle[1])] - origin;
      const Vector3 c = part.points[static_cast<std::size_t>(triangle[2])] - origin;
      const double v = a.cross(b).dot(c) / 6.0;
      const Vector3 sum = a + b + c;
      volume += v;
      first += v / 4.0 * sum;
      second += v / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
  }
  const double sign = volume < 0.0 ? -1.0 : 1.0;  // triangles that face inwards
  volume *= sign;
  if (!(volume > 0.0)) return {0.0, origin, Matrix3::Zero()};
  const Vector3 centre = sign * first / volume;
  const Matrix3 about_centre = sign * second - volume * centre * centre.transpose();
  return {volume, origin + centre, about_centre.trace() * Matrix3::Identity() - about_centre};
}

/// Pyramids from the centre of the faces, then from the centre of mass that these give: as MuJoCo's legacy.
SpatialInertia pyramids(const std::vector<model::MeshPart>& parts) {
  struct Triangle {
    Vector3 a, b, c;
  };
  std::vector<Triangle> triangles;
  for (const model::MeshPart& part : parts)
    for (const auto& t : part.triangles)
      triangles.push_back({part.points[static_cast<std::size_t>(t[0])], part.points[static_cast<std::size_t>(t[1])],
                           part.points[static_cast<std::size_t>(t[2])]});
  Vector3 centre = Vector3::Zero();
  double area = 0.0;
  for (const Triangle& t : triangles) {
    const double one = 0.5 * (t.b - t.a).cross(t.c - t.a).norm();
    centre += one / 3.0 * (t.a + t.b + t.c);
    area += one;
  }
  if (!(area > 0.0)) return {0.0, Vector3::Zero(), Matrix3::Zero()};
  centre /= area;
  const auto volume_from = [](const Triangle& t, const Vector3& apex) {
    return std::abs((t.a - apex).cross(t.b - apex).dot(t.c - apex)) / 6.0;
  };
  Vector3 com = Vector3::Zero();
  double volume = 0.0;
  for (const Triangle& t : triangles) {
    const double one = volume_from(t, centre);
    com += one / 4.0 * (t.a + t.b + t.c + centre);
    volume += one;
  }
  if (!(volume > 0.0)) return {0.0, centre, Matrix3::Zero()};
  com /= volume;
  Matrix3 second = Matrix3::Zero();
  volume = 0.0;
  for (const Triangle& t : triangles) {
    const double one = volume_from(t, com);
    const Vector3 a = t.a - com, b = t.b - com, c = t.c - com, sum = a + b + c;
    second += one / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    volume += one;
  }
  return {volume, com, second.trace() * Matrix3::Identity() - second};
}

/// Of something that has this mass distribution at all: no principal moment is larger than the others together.
bool is_possible(const SpatialInertia& unit) {
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(unit.inertia);
  const Vector3 moments = solver.eigenvalues();
  return unit.mass > 0.0 && unit.inertia.allFinite() && moments[0] > 0.0 &&
         moments[2] <= (moments[0] + moments[1]) * (1.0 + 1e-6);
}

}  // namespace

Solid make_solid(const geometry::Shape& shape) { return {shape, model::unit_density_inertia({shape, Pose{}})}; }

Solid make_ellipsoid(const Vector3& semi_axes) {
  std::vector<Vector3> points;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < kEllipsoidCorners; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / kEllipsoidCorners;
    const Vector3 across = exp_rotation(i * golden * Vector3::UnitZ()) * Vector3(std::sqrt(1.0 - z * z), 0.0, 0.0);
    points.push_back(semi_axes.cwiseProduct(across + z * Vector3::UnitZ()));
  }
  const auto hull = geometry::make_convex_hull(points);
  const Vector3 s = semi_axes.cwiseAbs2();
  const double volume = 4.0 / 3.0 * std::numbers::pi * semi_axes.prod();
  Matrix3 inertia = Matrix3::Zero();
  inertia.diagonal() << s.y() + s.z(), s.x() + s.z(), s.x() + s.y();
  const SpatialInertia unit{volume, Vector3::Zero(), volume / 5.0 * inertia};
  if (!hull) return {geometry::Box{semi_axes}, unit};  // flatter than a hull can be
  return {*hull, unit};
}

Solid make_plane(double half_x, double half_y) {
  const auto half = [](double given) {
    return given > 0.0 ? std::clamp(given, kSmallestSize, kPlaneHalf) : kPlaneHalf;
  };
  return {geometry::Box{Vector3(half(half_x), half(half_y), 0.5 * kPlaneThickness)},
          {0.0, Vector3::Zero(), Matrix3::Zero()}};
}

Solid make_mesh(const std::vector<model::MeshPart>& parts, const Node& node, MeshMass mass) {
  std::vector<Vector3> points;
  for (const model::MeshPart& part : parts) points.insert(points.end(), part.points.begin(), part.points.end());
  const auto hull = model::make_simple_hull(points);
  if (!hull) node.fail(std::to_string(points.size()) + " points that span no volume", "a mesh with a volume");
  double extent = 0.0;
  for (const Vector3& point : hull->vertices) extent = std::max(extent, point.norm());
  if (!(extent <= kLargestSize))
    node.fail("a mesh that reaches " + std::to_string(extent) + " m", "metres; for millimetres give a scale of 0.001");
  if (mass == MeshMass::Hull) return make_solid(*hull);
  const SpatialInertia unit = mass == MeshMass::Enclosed ? enclosed(parts) : pyramids(parts);
  if (is_possible(unit)) return {*hull, unit};
  return make_solid(*hull);  // a surface that is not closed
}

std::vector<model::MeshPart> read_mesh_file(const std::filesystem::path& path, const Node& node) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    node.fail("'" + path.string() + "', which is not there", "a mesh file (STL, OBJ, DAE)");
  model::MeshParts mesh = model::read_mesh_parts(path);
  if (!mesh.error.empty() || mesh.parts.empty())
    node.fail("'" + path.string() + "': " + (mesh.error.empty() ? "no parts" : mesh.error), "a mesh (STL, OBJ, DAE)");
  std::erase_if(mesh.parts, [](const model::MeshPart& part) { return part.points.empty(); });
  if (mesh.parts.empty()) node.fail("'" + path.string() + "' without points", "a mesh (STL, OBJ, DAE)");
  return mesh.parts;
}

SpatialInertia moved(const SpatialInertia& inertia, const Pose& X_AB) {
  return {inertia.mass, X_AB * inertia.com, X_AB.R * inertia.inertia * X_AB.R.transpose()};
}

SpatialInertia scaled(const SpatialInertia& inertia, double factor) {
  return {factor * inertia.mass, inertia.com, factor * inertia.inertia};
}

}  // namespace snug::scene_import::internal
