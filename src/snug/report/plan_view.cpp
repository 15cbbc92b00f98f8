// PlanView: what lies in a container, from above.
#include "snug/report/plan_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "snug/report/escape.hpp"
#include "snug/report/internal/raw.hpp"
#include "snug/report/internal/svg.hpp"

namespace snug::report {
namespace {

double cross(const Eigen::Vector2d& o, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

/// What is seen of points from above: the corners of their convex hull (Andrew's chains).
std::vector<Eigen::Vector2d> hull_of(std::vector<Eigen::Vector2d> points) {
  std::ranges::sort(points, [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  std::vector<Eigen::Vector2d> hull;
  const auto walk = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= start + 2 && cross(hull[hull.size() - 2], hull.back(), *first) <= 0.0) hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back();
  };
  walk(points.begin(), points.end());
  walk(points.rbegin(), points.rend());
  return hull;
}

}  // namespace

BoxOutline outline_of(const std::string& name, const Vector3& size, const Pose& X_TP) {
  BoxOutline outline{name, {}, -std::numeric_limits<double>::infinity()};
  std::vector<Eigen::Vector2d> corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3 sign((i & 1) != 0 ? 0.5 : -0.5, (i & 2) != 0 ? 0.5 : -0.5, (i & 4) != 0 ? 0.5 : -0.5);
    const Vector3 p_T = X_TP * Vector3(sign.cwiseProduct(size));
    corners.emplace_back(p_T.x(), p_T.y());
    outline.top = std::max(outline.top, p_T.z());
  }
  outline.corners_T = hull_of(std::move(corners));
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
