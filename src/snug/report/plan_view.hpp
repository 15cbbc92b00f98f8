// PlanView: what lies in a container, from above.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "snug/report/markup.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::report {

/// A box as it is seen from above.
struct BoxOutline {
  std::string name;
  std::vector<Eigen::Vector2d> corners_T;  ///< m, x and y in the container, in the order of a walk around it
  double top = 0.0;                        ///< m over the container's floor
};

/// `size`: edge lengths, m; X_TP: of its middle, in the container.
[[nodiscard]] BoxOutline outline_of(const std::string& name, const Vector3& size, const Pose& X_TP);

/// `inner_size`: of the container, m; y of T upwards. Higher boxes are lighter and drawn over lower ones.
[[nodiscard]] Markup plan_view(const Vector3& inner_size, std::vector<BoxOutline> boxes);

}  // namespace snug::report
