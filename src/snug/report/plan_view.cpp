// PlanView: what lies in a container, from above.
#include "snug/report/plan_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "snug/report/escape.hpp"
#include "snug/report/internal/raw.hpp"
#include "snug/report/internal/svg.hpp"
#include "snug/spatial/plane_hull.hpp"

namespace snug::report {

BoxOutline outline_of(const std::string& name, const Vector3& size, const Pose& X_TP) {
  BoxOutline outline{name, {}, -std::numeric_limits<double>::infinity()};
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3 sign((i & 1) != 0 ? 0.5 : -0.5, (i & 2) != 0 ? 0.5 : -0.5, (i & 4) != 0 ? 0.5 : -0.5);
    const Vector3 p_T = X_TP * Vector3(sign.cwiseProduct(size));
    corners.emplace_back(p_T.x(), p_T.y());
    outline.top = std::max(outline.top, p_T.z());
  }
  for (const std::size_t i : plane_hull(corners)) outline.corners_T.push_back(corners[i]);
  return outline;
}

Markup plan_view(const Vector3& inner_size, std::vector<BoxOutline> boxes) {
  constexpr double kWidth = 210.0, kEdge = 2.0;
  const double scale = kWidth / inner_size.x(), height = scale * inner_size.y();
  std::ranges::stable_sort(boxes, {}, &BoxOutline::top);
  std::string svg = internal::svg_rect(kEdge, kEdge, kWidth, height, "class=\"floor\"");
  for (const BoxOutline& box : boxes) {
    std::string points;
    for (const Eigen::Vector2d& p : box.corners_T) {
      points +=
          fmt::format("{:.1f},{:.1f} ", kEdge + 0.5 * kWidth + scale * p.x(), kEdge + 0.5 * height - scale * p.y());
    }
    svg +=
        fmt::format("<polygon points=\"{}\" class=\"packed\" style=\"--height:{:.2f}\"><title>{}</title></polygon>\n",
                    points, std::clamp(box.top / inner_size.z(), 0.0, 1.0),
                    escape(fmt::format("{}, top at {:.0f} mm", box.name, 1e3 * box.top)));
  }
  const std::string about = fmt::format("container from above, {} boxes", boxes.size());
  return internal::Raw::of(internal::svg_drawing(kWidth + 2.0 * kEdge, height + 2.0 * kEdge, about, svg));
}

}  // namespace snug::report
