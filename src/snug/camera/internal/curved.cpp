// Rays against capsules and cylinders: a quadratic for the mantle, then the ends.
#include "snug/camera/internal/curved.hpp"

#include <algorithm>
#include <cmath>

#include "snug/core/check.hpp"

namespace snug::camera::internal {
namespace {

struct Round {
  double half_length, radius;
  bool has_balls;  // capsule: ends are halves of balls; cylinder: flat
};

Round round_of(const geometry::Shape& shape) {
  if (const auto* capsule = std::get_if<geometry::Capsule>(&shape))
    return {capsule->half_length, capsule->radius, true};
  const auto* cylinder = std::get_if<geometry::Cylinder>(&shape);
  SNUG_CHECK(cylinder != nullptr, "a capsule or a cylinder");
  return {cylinder->half_length, cylinder->radius, false};
}

/// Smaller positive root of a s^2 + 2 b s + c = 0 with c > 0 (the start is outside), or 0.
double first_root(double a, double b, double c) {
  const double d = b * b - a * c;
  if (!(a > 0.0) || d < 0.0) return 0.0;
  const double s = (-b - std::sqrt(d)) / a;
  return s > 0.0 ? s : 0.0;
}

double hit_ball(const Vector3& o, const Vector3& d, double z, double radius) {
  const Vector3 from = o - Vector3(0.0, 0.0, z);
  return first_root(d.squaredNorm(), from.dot(d), from.squaredNorm() - radius * radius);
}

}  // namespace

Vector3 half_extent(const geometry::Shape& shape) {
  const Round r = round_of(shape);
  return {r.radius, r.radius, r.half_length + (r.has_balls ? r.radius : 0.0)};
}

bool is_inside(const geometry::Shape& shape, const Vector3& p_G) {
  const Round r = round_of(shape);
  const double beyond = std::max(0.0, std::abs(p_G.z()) - r.half_length);
  if (!r.has_balls && beyond > 0.0) return false;
  return p_G.head<2>().squaredNorm() + beyond * beyond <= r.radius * r.radius;
}

double hit(const geometry::Shape& shape, const Pose& X_CG, const Vector3& ray) {
  const Round r = round_of(shape);
  const Vector3 o = -(X_CG.R.transpose() * X_CG.p), d = X_CG.R.transpose() * ray;
  double best = 0.0;
  const auto keep = [&best](double s) {
    if (s > 0.0 && (best == 0.0 || s < best)) best = s;
  };
  const Eigen::Vector2d o2 = o.head<2>(), d2 = d.head<2>();
  const double mantle = first_root(d2.squaredNorm(), o2.dot(d2), o2.squaredNorm() - r.radius * r.radius);
  if (std::abs(o.z() + mantle * d.z()) <= r.half_length) keep(mantle);
  for (const double end : {-r.half_length, r.half_length}) {
    if (r.has_balls) {
      keep(hit_ball(o, d, end, r.radius));
    } else if (d.z() != 0.0) {
      const double s = (end - o.z()) / d.z();
      if ((o2 + s * d2).squaredNorm() <= r.radius * r.radius) keep(s);
    }
  }
  return best;
}

Vector3 curved_normal(const geometry::Shape& shape, const Vector3& p_G) {
  const Round r = round_of(shape);
  const double z = std::clamp(p_G.z(), -r.half_length, r.half_length);
  if (!r.has_balls && r.half_length - std::abs(p_G.z()) < r.radius - p_G.head<2>().norm())
    return Vector3::UnitZ() * (p_G.z() > 0.0 ? 1.0 : -1.0);
  return (p_G - Vector3(0.0, 0.0, r.has_balls ? z : p_G.z())).normalized();
}

}  // namespace snug::camera::internal
