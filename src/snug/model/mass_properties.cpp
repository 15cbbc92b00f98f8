// Mass properties: cuboids, capsules, cylinders, hulls, and layered boxes (report eqs 12-14).
#include "snug/model/mass_properties.hpp"

#include <cmath>
#include <numbers>
#include <variant>

#include "snug/model/parcel.hpp"

namespace snug::model {
namespace {

/// m (d^2 I - d d^T).
Matrix3 parallel_axis(double mass, const Vector3& d) {
  return mass * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
}

SpatialInertia of_shape(const geometry::Box& box) {
  const Vector3 size = 2.0 * box.half;
  const double volume = size.prod();
  return {volume, Vector3::Zero(), cuboid_inertia(size, volume)};
}

/// Cylinder of length 2 h along z and two half balls.
SpatialInertia of_shape(const geometry::Capsule& capsule) {
  const double h = capsule.half_length;
  const double r = capsule.radius;
  const double cylinder = std::numbers::pi * r * r * 2.0 * h;
  const double ball = std::numbers::pi * r * r * r * 4.0 / 3.0;
  // A half ball's centre lies 3/8 r from its flat face: 2/5 r^2 about the ball's centre moves to the capsule's.
  const double axial = cylinder * r * r / 2.0 + ball * 0.4 * r * r;
  const double across = cylinder * (r * r / 4.0 + h * h / 3.0) + ball * (0.4 * r * r + h * h + 0.75 * h * r);
  Matrix3 inertia = Matrix3::Zero();
  inertia.diagonal() << across, across, axial;
  return {cylinder + ball, Vector3::Zero(), inertia};
}

SpatialInertia of_shape(const geometry::Cylinder& cylinder) {
  const double r = cylinder.radius;
  const double length = 2.0 * cylinder.half_length;
  const double volume = std::numbers::pi * r * r * length;
  const double across = volume * (3.0 * r * r + length * length) / 12.0;
  Matrix3 inertia = Matrix3::Zero();
  inertia.diagonal() << across, across, volume * r * r / 2.0;
  return {volume, Vector3::Zero(), inertia};
}

/// Signed tetrahedra from the first vertex; covariance of a tetrahedron (a, b, c, 0) is V/20 (sum x x^T + s s^T).
SpatialInertia of_shape(const geometry::ConvexHull& hull) {
  if (hull.vertices.empty()) return {0.0, Vector3::Zero(), Matrix3::Zero()};
  const Vector3 origin = hull.vertices.front();
  double volume = 0.0;
  Vector3 first = Vector3::Zero();
  Matrix3 second = Matrix3::Zero();
  for (const std::vector<int>& face : hull.faces) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const Vector3 a = hull.vertices[static_cast<std::size_t>(face[0])] - origin;
      const Vector3 b = hull.vertices[static_cast<std::size_t>(face[i])] - origin;
      const Vector3 c = hull.vertices[static_cast<std::size_t>(face[i + 1])] - origin;
      const double v = a.cross(b).dot(c) / 6.0;
      const Vector3 sum = a + b + c;
      volume += v;
      first += v / 4.0 * sum;
      second += v / 20.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
    }
  }
  if (!(volume > 0.0)) return {0.0, origin, Matrix3::Zero()};
  const Vector3 centre = first / volume;
  const Matrix3 about_centre = second - volume * centre * centre.transpose();
  return {volume, origin + centre, about_centre.trace() * Matrix3::Identity() - about_centre};
}

}  // namespace

Matrix3 cuboid_inertia(const Vector3& size, double mass) {
  const Vector3 s = size.cwiseAbs2();
  Matrix3 inertia = Matrix3::Zero();
  inertia.diagonal() << s.y() + s.z(), s.x() + s.z(), s.x() + s.y();
  return inertia * (mass / 12.0);
}

SpatialInertia unit_density_inertia(const PlacedShape& placed) {
  const SpatialInertia own = std::visit([](const auto& shape) { return of_shape(shape); }, placed.shape);
  const Matrix3& R = placed.X_BG.R;
  return {own.mass, placed.X_BG * own.com, R * own.inertia * R.transpose()};
}

SpatialInertia sum_inertias(const std::vector<SpatialInertia>& parts) {
  SpatialInertia total{0.0, Vector3::Zero(), Matrix3::Zero()};
  Vector3 moment = Vector3::Zero();
  for (const SpatialInertia& part : parts) {
    total.mass += part.mass;
    moment += part.mass * part.com;
  }
  if (total.mass > 0.0) total.com = moment / total.mass;
  for (const SpatialInertia& part : parts)
    total.inertia += part.inertia + parallel_axis(part.mass, part.com - total.com);
  return total;
}

SpatialInertia scaled_to_mass(const SpatialInertia& inertia, double mass) {
  return {mass, inertia.com, inertia.inertia * (mass / inertia.mass)};
}

SpatialInertia uniform_inertia(const std::vector<PlacedShape>& shapes, double mass) {
  std::vector<SpatialInertia> parts;
  for (const PlacedShape& shape : shapes) parts.push_back(unit_density_inertia(shape));
  return scaled_to_mass(sum_inertias(parts), mass);
}

SpatialInertia compute_layered_inertia(const Vector3& size, const std::optional<Shell>& shell,
                                       const std::vector<Layer>& layers) {
  std::vector<SpatialInertia> parts;
  if (shell) {
    const Vector3 inner = size - Vector3::Constant(2.0 * shell->thickness);
    const double density = shell->mass / (size.prod() - inner.prod());
    parts.push_back({shell->mass, Vector3::Zero(),
                     cuboid_inertia(size, density * size.prod()) - cuboid_inertia(inner, density * inner.prod())});
  }
  for (const Layer& layer : layers) {
    const double mass = layer.density * layer.size.prod();  // eq. 12
    parts.push_back({mass, layer.centre, cuboid_inertia(layer.size, mass)});
  }
  return sum_inertias(parts);  // eq. 14
}

}  // namespace snug::model
