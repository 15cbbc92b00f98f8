// Edges of depth and corners of a cast.
#include "snug/camera/internal/edges.hpp"

#include <algorithm>
#include <cmath>

#include "snug/camera/loss.hpp"
#include "snug/core/parallel.hpp"

namespace snug::camera::internal {
namespace {

constexpr int kRowsSearchedAtOnce = 32;
// m: the same where a surface is curved. Pixels of 1.0 mm (0.9 m, 902 px) differ by so much where it is 79 degrees from
// square to the ray.
constexpr double kRoundJump = 5e-3;
constexpr double kMeet = 1e-7;  // 1/m: rounding of single precision, 6e-8 of the inverse depth at 1 m

std::uint8_t border_between(const Cast& cast, int row, int col, int row_b, int col_b, std::uint8_t jump,
                            std::uint8_t corner) {
  const std::int32_t sa = cast.surface(row, col), sb = cast.surface(row_b, col_b);
  if (sa == sb && (sa < 0 || cast.surfaces[static_cast<std::size_t>(sa)].is_flat())) return 0;
  if (sa < 0 || sb < 0) return jump;
  const double wa = cast.inverse_depth(row, col), wb = cast.inverse_depth(row_b, col_b);
  const double za = 1.0 / wa, zb = 1.0 / wb;
  const Surface &a = cast.surfaces[static_cast<std::size_t>(sa)], &b = cast.surfaces[static_cast<std::size_t>(sb)];
  if (!a.is_flat() || !b.is_flat()) return std::abs(za - zb) > kRoundJump ? jump : 0;
  // Each plane at the other pixel. The grid's first pixel does not matter: only differences are used.
  const double dc = col_b - col, dr = row_b - row;
  const double wa_at_b = wa + a.inverse.x() * dc + a.inverse.y() * dr;
  const double wb_at_a = wb - b.inverse.x() * dc - b.inverse.y() * dr;
  const double far = 1e3;
  const double za_at_b = wa_at_b > 1e-3 ? 1.0 / wa_at_b : far, zb_at_a = wb_at_a > 1e-3 ? 1.0 / wb_at_a : far;
  if (std::min(std::abs(za_at_b - zb), std::abs(zb_at_a - za)) > kEdgeOfDepth) return jump;
  return wb > wa_at_b + kMeet && wa > wb_at_a + kMeet ? corner : 0;
}

/// Distance along one line of pixels, forth and back. `step` leads from a pixel to the next, `is_source` and `stops`
/// tell of the border behind a pixel (toward the next).
template <class IsSource, class Stops>
void spread(std::uint8_t* line, int count, std::ptrdiff_t step, int most, const IsSource& is_source,
            const Stops& stops) {
  const auto limit = static_cast<std::uint8_t>(most + 1);
  for (int pass = 0; pass < 2; ++pass) {
    std::uint8_t d = limit;
    for (int k = 0; k < count; ++k) {
      const int i = pass == 0 ? k : count - 1 - k;
      const int border = pass == 0 ? i - 1 : i;  // crossed on the way to pixel i
      if (k > 0) {
        if (is_source(border))
          d = 1;
        else if (stops(border))
          d = limit;
        else
          d = std::min<std::uint8_t>(limit, static_cast<std::uint8_t>(d + 1));
      }
      std::uint8_t& here = line[i * step];
      d = std::min(d, here);
      here = d;
    }
  }
}

}  // namespace

Grid2<std::uint8_t> find_borders(const Cast& cast, int threads) {
  const int rows = cast.surface.rows(), cols = cast.surface.cols();
  Grid2<std::uint8_t> borders(rows, cols);
  parallel_for((rows + kRowsSearchedAtOnce - 1) / kRowsSearchedAtOnce, threads, [&](int job, int) {
    for (int r = job * kRowsSearchedAtOnce; r < std::min(rows, (job + 1) * kRowsSearchedAtOnce); ++r) {
      const std::int32_t* const here = cast.surface.row(r);
      const std::int32_t* const below = r + 1 < rows ? cast.surface.row(r + 1) : nullptr;
      for (int c = 0; c < cols; ++c) {
        std::uint8_t border = 0;
        const bool is_round = here[c] >= 0 && !cast.surfaces[static_cast<std::size_t>(here[c])].is_flat();
        if (c + 1 < cols && (is_round || here[c] != here[c + 1]))
          border |= border_between(cast, r, c, r, c + 1, kJumpRight, kCornerRight);
        if (below != nullptr && (is_round || here[c] != below[c]))
          border |= border_between(cast, r, c, r + 1, c, kJumpBelow, kCornerBelow);
        borders(r, c) = border;
      }
    }
  });
  return borders;
}

Grid2<std::uint8_t> edge_distance(const Grid2<std::uint8_t>& borders, int most, int threads) {
  const int rows = borders.rows(), cols = borders.cols();
  const auto limit = static_cast<std::uint8_t>(most + 1);
  Grid2<std::uint8_t> distance(rows, cols, limit);
  const auto lower = [&](int r, int c, int d) {
    if (borders.is_inside(r, c)) distance(r, c) = std::min(distance(r, c), static_cast<std::uint8_t>(d));
  };
  // From each edge outward; edges are few. Blocks of rows do not write into each other's rows: each looks a little
  // beyond.
  parallel_for((rows + kRowsSearchedAtOnce - 1) / kRowsSearchedAtOnce, threads, [&](int job, int) {
    const int first = job * kRowsSearchedAtOnce, end = std::min(rows, first + kRowsSearchedAtOnce);
    for (int r = std::max(0, first - most); r < std::min(rows, end + most); ++r) {
      const std::uint8_t* const line = borders.row(r);
      for (int c = 0; c < cols; ++c) {
        if ((line[c] & (kJumpRight | kJumpBelow)) == 0) continue;
        for (int d = 1; d <= most; ++d) {
          if ((line[c] & kJumpRight) != 0 && r >= first && r < end) {
            lower(r, c - d + 1, d);
            lower(r, c + d, d);
          }
          if ((line[c] & kJumpBelow) == 0) continue;
          if (r - d + 1 >= first && r - d + 1 < end) lower(r - d + 1, c, d);
          if (r + d >= first && r + d < end) lower(r + d, c, d);
        }
      }
    }
  });
  return distance;
}

Grid2<std::uint8_t> corner_distance(const Grid2<std::uint8_t>& borders, int most, int threads) {
  const int rows = borders.rows(), cols = borders.cols();
  Grid2<std::uint8_t> distance(rows, cols, static_cast<std::uint8_t>(most + 1));
  parallel_for((rows + kRowsSearchedAtOnce - 1) / kRowsSearchedAtOnce, threads, [&](int job, int) {
    for (int r = job * kRowsSearchedAtOnce; r < std::min(rows, (job + 1) * kRowsSearchedAtOnce); ++r) {
      const std::uint8_t* const line = borders.row(r);
      spread(
          distance.row(r), cols, 1, most, [line](int c) { return (line[c] & kCornerRight) != 0; },
          [line](int c) { return (line[c] & kJumpRight) != 0; });
    }
  });
  parallel_for((cols + kRowsSearchedAtOnce - 1) / kRowsSearchedAtOnce, threads, [&](int job, int) {
    for (int c = job * kRowsSearchedAtOnce; c < std::min(cols, (job + 1) * kRowsSearchedAtOnce); ++c)
      spread(
          distance.row(0) + c, rows, cols, most, [&](int r) { return (borders(r, c) & kCornerBelow) != 0; },
          [&](int r) { return (borders(r, c) & kJumpBelow) != 0; });
  });
  return distance;
}

}  // namespace snug::camera::internal
