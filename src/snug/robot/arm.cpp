// ArmModel: looking things up in it, and what hangs behind a frame.
#include "snug/robot/arm.hpp"

#include "snug/core/check.hpp"
#include "snug/robot/internal/inertia.hpp"

namespace snug::robot {

int find_link(const ArmModel& arm, std::string_view name) noexcept {
  for (std::size_t i = 0; i < arm.links.size(); ++i)
    if (arm.links[i].name == name) return static_cast<int>(i);
  return -1;
}

int find_joint(const ArmModel& arm, std::string_view name) noexcept {
  for (std::size_t i = 0; i < arm.joints.size(); ++i)
    if (arm.joints[i].name == name) return static_cast<int>(i);
  return -1;
}

SpatialInertia distal_inertia(const ArmModel& arm, int link) {
  const auto first = static_cast<std::size_t>(link);
  SNUG_CHECK(first < arm.links.size(), "no such link");
  const Pose X_LS = arm.links[first].X_SL.inverse();
  SpatialInertia sum{0.0, Vector3::Zero(), Matrix3::Zero()};
  for (std::size_t i = first; i < arm.links.size(); ++i) {
    const Link& other = arm.links[i];
    if (other.segment == arm.links[first].segment && is_behind(arm, static_cast<int>(i), link))
      internal::add_inertia(other.inertia, X_LS * other.X_SL, sum);
  }
  return sum;
}

bool is_behind(const ArmModel& arm, int link, int ancestor) noexcept {
  for (int at = link; at >= 0; at = arm.links[static_cast<std::size_t>(at)].parent)
    if (at == ancestor) return true;
  return false;
}

namespace internal {

void add_inertia(const SpatialInertia& part, const Pose& X_SL, SpatialInertia& sum) {
  const Matrix3 turned = X_SL.R * part.inertia * X_SL.R.transpose();
  const double mass = sum.mass + part.mass;
  if (!(mass > 0.0)) {
    sum.inertia += turned;
    return;
  }
  const Vector3 com = X_SL * part.com;
  const Vector3 centre = (sum.mass * sum.com + part.mass * com) / mass;
  const auto parallel = [](double m, const Vector3& d) -> Matrix3 {
    return m * (d.squaredNorm() * Matrix3::Identity() - d * d.transpose());
  };
  sum.inertia += parallel(sum.mass, sum.com - centre) + parallel(part.mass, com - centre) + turned;
  sum.mass = mass;
  sum.com = centre;
}

}  // namespace internal

}  // namespace snug::robot
