#include "snug/spatial/plane_hull.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace snug {
namespace {

double cross(const Eigen::Vector2d& o, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

}  // namespace

std::vector<std::size_t> plane_hull(std::span<const Eigen::Vector2d> points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return std::pair(points[i].x(), points[i].y()); });
  if (order.size() < 2) return order;
  std::vector<std::size_t> hull;
  const auto walk = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= start + 2 &&
             cross(points[hull[hull.size() - 2]], points[hull.back()], points[*first]) <= 0.0)
        hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back();
  };
  walk(order.begin(), order.end());
  walk(order.rbegin(), order.rend());
  return hull;
}

}  // namespace snug
