// Obstacles: clusters in the picture, heights over a level grid.
#include "snug/box_estimation/internal/obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace snug::box_estimation::internal {
namespace {

Vector3 point_at(const camera::Frame& frame, int row, int col) {
  return frame.camera.X_WC *
         Vector3(static_cast<double>(frame.depth(row, col)) * camera::pixel_ray(frame.camera.intrinsics, col, row));
}

bool is_inside(const EstimateInput& input, const Vector3& p) {
  return (p.array() >= input.region_low.array()).all() && (p.array() <= input.region_high.array()).all();
}

/// Most points around are as deep: no point of an edge of depth, between what is before and what is behind.
bool is_of_a_surface(const camera::Frame& frame, int row, int col, const ObstacleSettings& settings) {
  const float depth = frame.depth(row, col);
  const auto limit = static_cast<float>(settings.alike);
  int alike = 0;
  for (int i = 0; i < 9; ++i) {
    const int r = row + i / 3 - 1, c = col + i % 3 - 1;
    if (i == 4 || !frame.depth.is_inside(r, c)) continue;
    alike += std::abs(frame.depth(r, c) - depth) < limit ? 1 : 0;
  }
  return alike >= settings.least_alike;
}

/// In the region, or over it: what stands out over a rim is in the way, too.
bool is_inside_or_over(const EstimateInput& input, const Vector3& p) {
  return is_inside(input, {p.x(), p.y(), std::min(p.z(), input.region_high.z())});
}

/// Blocks of pixels in which most points are unexplained, and which of them hang together.
class Clusters {
 public:
  Clusters(const camera::Grid2<std::uint8_t>& mask, int cell)
      : cell_(cell), counts_(mask.rows() / cell, mask.cols() / cell) {
    for (int r = 0; r < counts_.rows() * cell_; ++r)
      for (int c = 0; c < counts_.cols() * cell_; ++c) counts_(r / cell_, c / cell_) += mask(r, c);
  }
  [[nodiscard]] int rows() const { return counts_.rows(); }
  [[nodiscard]] int cols() const { return counts_.cols(); }
  /// The blocks that hang together with this one; none when it is not full, or was taken before.
  std::vector<std::pair<int, int>> take(int row, int col) {
    std::vector<std::pair<int, int>> blocks;
    if (!is_full(row, col)) return blocks;
    blocks.emplace_back(row, col);
    counts_(row, col) = 0;
    for (std::size_t next = 0; next < blocks.size(); ++next) {
      const auto [a, b] = blocks[next];
      for (const auto& [da, db] : {std::pair(0, 1), std::pair(1, 0), std::pair(0, -1), std::pair(-1, 0)}) {
        if (!is_full(a + da, b + db)) continue;
        counts_(a + da, b + db) = 0;
        blocks.emplace_back(a + da, b + db);
      }
    }
    return blocks;
  }

 private:
  /// Three quarters of a block: edges that a fit leaves over are thinner.
  [[nodiscard]] bool is_full(int row, int col) const {
    return counts_.is_inside(row, col) && counts_(row, col) >= 3 * cell_ * cell_ / 4;
  }
  int cell_;
  camera::Grid2<int> counts_;
};

/// Points in W gathered into extent and columns.
class Gathering {
 public:
  void add(const Vector3& p) {
    obstacle_.low = obstacle_.low.cwiseMin(p);
    obstacle_.high = obstacle_.high.cwiseMax(p);
    const auto [at, is_new] = tops_.try_emplace({geometry::column_of(p.y()), geometry::column_of(p.x())}, p.z());
    if (!is_new) at->second = std::max(at->second, p.z());
  }
  [[nodiscard]] bool is_empty() const { return tops_.empty(); }
  [[nodiscard]] double top() const { return obstacle_.high.z(); }
  [[nodiscard]] Obstacle finish(int points) {
    obstacle_.points = points;
    for (const auto& [yx, top] : tops_) obstacle_.columns.push_back({yx.second, yx.first, top});
    return std::move(obstacle_);
  }

 private:
  Obstacle obstacle_{Vector3::Constant(1e9), Vector3::Constant(-1e9), 0, {}, 0.0};
  std::map<std::pair<int, int>, double> tops_;  ///< by y, then x
};

/// The blocks around: fewer of their points are unexplained. They belong to it but do not make an obstacle, and what is
/// higher there are points between it and something higher beside it.
std::set<std::pair<int, int>> rim_of(const std::vector<std::pair<int, int>>& blocks) {
  std::set<std::pair<int, int>> rim;
  for (const auto& [a, b] : blocks)
    for (int i = 0; i < 9; ++i) rim.emplace(a + i / 3 - 1, b + i % 3 - 1);
  for (const auto& block : blocks) rim.erase(block);
  return rim;
}

}  // namespace

std::vector<Obstacle> find_obstacles(const FitContext& context, const EstimateInput& input,
                                     const camera::Grid2<std::uint8_t>& mask) {
  const camera::Frame& frame = context.frame;
  const PixelRange& range = context.range;
  const ObstacleSettings& settings = context.settings.obstacles;
  const int cell = settings.cell;
  Clusters clusters(mask, cell);
  std::vector<Obstacle> obstacles;
  for (int r = 0; r < clusters.rows(); ++r)
    for (int c = 0; c < clusters.cols(); ++c) {
      const std::vector<std::pair<int, int>> blocks = clusters.take(r, c);
      if (blocks.empty()) continue;
      Gathering gathering;
      const auto gather = [&](const std::pair<int, int>& block, double highest) {
        int points = 0;
        for (int i = 0; i < cell * cell; ++i) {
          const int row = block.first * cell + i / cell, col = block.second * cell + i % cell;
          if (!mask.is_inside(row, col) || mask(row, col) == 0) continue;
          const Vector3 p = point_at(frame, row + range.first_row, col + range.first_col);
          if (!is_inside_or_over(input, p) || p.z() > highest) continue;
          ++points;
          if (is_of_a_surface(frame, row + range.first_row, col + range.first_col, settings)) gathering.add(p);
        }
        return points;
      };
      int points = 0;
      for (const auto& block : blocks) points += gather(block, std::numeric_limits<double>::max());
      if (points < settings.least_points) continue;
      for (const auto& block : rim_of(blocks)) (void)gather(block, gathering.top());
      if (!gathering.is_empty()) obstacles.push_back(gathering.finish(points));
    }
  std::stable_sort(obstacles.begin(), obstacles.end(),
                   [](const Obstacle& a, const Obstacle& b) { return a.points > b.points; });
  return obstacles;
}

HeightMap make_height_map(const FitContext& context, const EstimateInput& input) {
  const camera::Frame& frame = context.frame;
  const PixelRange& range = context.range;
  HeightMap map;
  const Vector3 size = input.region_high - input.region_low;
  if (!(size.head<2>().maxCoeff() < context.settings.obstacles.largest_map * map.cell))
    return map;  // no region was given
  const int x = geometry::column_of(input.region_low.x()), y = geometry::column_of(input.region_low.y());
  map.origin = {x * map.cell, y * map.cell};
  map.height =
      camera::Grid2<float>(geometry::column_of(input.region_high.y()) - y + 1,
                           geometry::column_of(input.region_high.x()) - x + 1, std::numeric_limits<float>::quiet_NaN());
  for (int r = range.first_row; r < range.end_row; ++r)
    for (int c = range.first_col; c < range.end_col; ++c) {
      if (frame.depth(r, c) == 0.0F) continue;
      const Vector3 p = point_at(frame, r, c);
      if (!is_inside(input, p)) continue;
      const int row = geometry::column_of(p.y()) - y, col = geometry::column_of(p.x()) - x;
      if (!map.height.is_inside(row, col)) continue;
      float& height = map.height(row, col);
      if (!(height > static_cast<float>(p.z()))) height = static_cast<float>(p.z());
    }
  return map;
}

}  // namespace snug::box_estimation::internal
