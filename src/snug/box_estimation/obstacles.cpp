// Obstacles: clusters in the picture, heights over a level grid.
#include "snug/box_estimation/internal/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace snug::box_estimation::internal {
namespace {

constexpr int kCell = 4;                     // px, side of the cells that clusters are made of
constexpr int kLeastPointsOfObstacle = 250;  // of an obstacle: at 1 mm a pixel 16 mm x 16 mm
constexpr int kLargestMap = 2000;            // cells a side

Vector3 point_at(const camera::Frame& frame, int row, int col) {
  return frame.camera.X_WC *
         Vector3(static_cast<double>(frame.depth(row, col)) * camera::pixel_ray(frame.camera.intrinsics, col, row));
}

bool is_inside(const EstimateInput& input, const Vector3& p) {
  return (p.array() >= input.region_low.array()).all() && (p.array() <= input.region_high.array()).all();
}

}  // namespace

std::vector<Obstacle> find_obstacles(const camera::Frame& frame, const EstimateInput& input, const PixelRange& range,
                                     const camera::Grid2<std::uint8_t>& mask) {
  camera::Grid2<int> cells(mask.rows() / kCell, mask.cols() / kCell);
  for (int r = 0; r < cells.rows() * kCell; ++r)
    for (int c = 0; c < cells.cols() * kCell; ++c) cells(r / kCell, c / kCell) += mask(r, c);
  std::vector<Obstacle> obstacles;
  for (int r = 0; r < cells.rows(); ++r)
    for (int c = 0; c < cells.cols(); ++c) {
      // Three quarters of a cell: edges that a fit leaves over are thinner.
      const auto is_full = [&](int a, int b) { return cells.is_inside(a, b) && cells(a, b) >= 3 * kCell * kCell / 4; };
      if (!is_full(r, c)) continue;
      Obstacle obstacle{Vector3::Constant(1e9), Vector3::Constant(-1e9), 0};
      std::vector<std::pair<int, int>> open = {{r, c}};
      cells(r, c) = 0;
      while (!open.empty()) {
        const auto [a, b] = open.back();
        open.pop_back();
        for (int i = 0; i < kCell * kCell; ++i) {
          const int row = a * kCell + i / kCell, col = b * kCell + i % kCell;
          if (mask(row, col) == 0) continue;
          const Vector3 p = point_at(frame, row + range.first_row, col + range.first_col);
          if (!is_inside(input, p)) continue;
          obstacle.low = obstacle.low.cwiseMin(p);
          obstacle.high = obstacle.high.cwiseMax(p);
          ++obstacle.points;
        }
        for (const auto& [da, db] : {std::pair(0, 1), std::pair(1, 0), std::pair(0, -1), std::pair(-1, 0)})
          if (is_full(a + da, b + db)) {
            cells(a + da, b + db) = 0;
            open.emplace_back(a + da, b + db);
          }
      }
      if (obstacle.points >= kLeastPointsOfObstacle) obstacles.push_back(obstacle);
    }
  std::stable_sort(obstacles.begin(), obstacles.end(),
                   [](const Obstacle& a, const Obstacle& b) { return a.points > b.points; });
  return obstacles;
}

HeightMap make_height_map(const camera::Frame& frame, const EstimateInput& input, const PixelRange& range) {
  HeightMap map;
  const Vector3 size = input.region_high - input.region_low;
  if (!(size.head<2>().maxCoeff() < kLargestMap * map.cell)) return map;  // no region was given
  map.origin = input.region_low.head<2>();
  const auto cells = [&map](double length) { return std::max(1, static_cast<int>(std::ceil(length / map.cell))); };
  map.height = camera::Grid2<float>(cells(size.y()), cells(size.x()), std::numeric_limits<float>::quiet_NaN());
  for (int r = range.first_row; r < range.end_row; ++r)
    for (int c = range.first_col; c < range.end_col; ++c) {
      if (frame.depth(r, c) == 0.0F) continue;
      const Vector3 p = point_at(frame, r, c);
      if (!is_inside(input, p)) continue;
      const int row = static_cast<int>((p.y() - map.origin.y()) / map.cell),
                col = static_cast<int>((p.x() - map.origin.x()) / map.cell);
      if (!map.height.is_inside(row, col)) continue;
      float& height = map.height(row, col);
      if (!(height > static_cast<float>(p.z()))) height = static_cast<float>(p.z());
    }
  return map;
}

}  // namespace snug::box_estimation::internal
