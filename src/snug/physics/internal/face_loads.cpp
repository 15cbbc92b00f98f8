// Face loads: how a face shares what it carries among the points of its contact patch. docs/theory/contact.md,
// section 3.
#include "snug/physics/internal/face_loads.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

constexpr double kTouches = 1e-5;  ///< m, a gap at the end of the step up to which a point bears
constexpr double kEven = 1e-3;     ///< of the sum of loads: what a solver at rest leaves; less is not evened out
constexpr double kExact = 1e-7;    ///< of the sum of loads, and of it times the size: what loads may miss
constexpr double kThin = 1e-9;     ///< area over size^2 of a polygon that is a line
constexpr std::size_t kFew = 8;    ///< points, of which those that would pull are left out one by one

double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

/// Sums over the points that bear, about their weighted middle.
struct Moments {
  double weight = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
};

Moments moments_of(std::span<const FaceLoad> points) {
  Moments m;
  for (const FaceLoad& p : points) {
    if (!p.bears) continue;
    m.weight += p.weight, m.x += p.weight * p.x, m.y += p.weight * p.y;
  }
  if (!(m.weight > 0.0)) return m;
  m.x /= m.weight, m.y /= m.weight;
  for (const FaceLoad& p : points) {
    if (!p.bears) continue;
    const double x = p.x - m.x, y = p.y - m.y;
    m.xx += p.weight * x * x, m.xy += p.weight * x * y, m.yy += p.weight * y * y;
  }
  return m;
}

/// Pressure that is affine in the place: per weight at the middle, and its slopes.
struct Pressure {
  Moments about;
  double mean = 0.0, slope_x = 0.0, slope_y = 0.0;
  [[nodiscard]] double at(const FaceLoad& p) const {
    return p.bears ? p.weight * (mean + slope_x * (p.x - about.x) + slope_y * (p.y - about.y)) : 0.0;
  }
};

Pressure pressure_of(std::span<const FaceLoad> points, const FaceWrench& wrench) {
  Pressure pressure{moments_of(points)};
  const Moments& m = pressure.about;
  if (!(m.weight > 0.0)) return pressure;
  const double ridge = 1e-12 * (m.xx + m.yy);  // points on a line
  const double xx = m.xx + ridge, yy = m.yy + ridge, det = xx * yy - m.xy * m.xy;
  const double mx = wrench.x - wrench.sum * m.x, my = wrench.y - wrench.sum * m.y;
  pressure.mean = wrench.sum / m.weight;
  if (!(det > 0.0)) return pressure;
  pressure.slope_x = (yy * mx - m.xy * my) / det, pressure.slope_y = (xx * my - m.xy * mx) / det;
  return pressure;
}

/// Leaves out points that would pull: of few the worst, of many all. False: none does.
bool drop_pulling(std::span<FaceLoad> points, const Pressure& pressure) {
  FaceLoad* worst = nullptr;
  double least = 0.0;
  for (FaceLoad& p : points) {
    const double load = pressure.at(p);
    if (!(load < least)) continue;
    if (points.size() <= kFew) least = load;
    if (points.size() > kFew) p.bears = false;
    worst = &p;
  }
  if (worst != nullptr) worst->bears = false;
  return worst != nullptr;
}

using Corners = std::array<FaceLoad, geometry::kMaxManifoldPoints>;

double cross(const FaceLoad& a, const FaceLoad& b, const FaceLoad& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Counter-clockwise, about a point within.
void sort_around(std::span<FaceLoad> corners) {
  std::size_t left = 0;  // turns
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i)
    left += cross(corners[i], corners[(i + 1) % n], corners[(i + 2) % n]) > 0.0 ? 1U : 0U;
  if (n == 4 && (left == 0 || left == n)) {  // of more, corners could go round twice
    if (left == 0) std::reverse(corners.begin(), corners.end());
    return;
  }
  double x = 0.0, y = 0.0;
  for (const FaceLoad& p : corners) x += p.x / static_cast<double>(n), y += p.y / static_cast<double>(n);
  std::sort(corners.begin(), corners.end(), [x, y](const FaceLoad& p, const FaceLoad& q) {
    return std::atan2(p.y - y, p.x - x) < std::atan2(q.y - y, q.x - x);
  });
}

/// Twice the area.
double twice_area(std::span<const FaceLoad> corners) {
  double sum = 0.0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) sum += cross(corners[0], corners[i], corners[i + 1]);
  return sum;
}

/// Sorted corners of an area that is more than a line.
bool is_area(std::span<const FaceLoad> corners) {
  double size = 0.0;
  for (const FaceLoad& p : corners) size = std::max(size, length_of(p.x - corners[0].x, p.y - corners[0].y));
  return corners.size() >= 3 && twice_area(corners) > kThin * size * size;
}

void find_middle(std::span<const FaceLoad> corners, Bearing bearing, FaceSpread& spread) {
  double sum = 0.0, x = 0.0, y = 0.0;
  const FaceLoad& o = corners[0];
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const FaceLoad &p = corners[i], &q = corners[(i + 1) % corners.size()];
    const bool is_face = bearing == Bearing::Face;
    const double part = is_face ? cross(o, p, q) / 3.0 : 0.5 * length_of(q.x - p.x, q.y - p.y);
    sum += is_face ? 3.0 * part : 2.0 * part;
    x += part * (p.x + q.x - 2.0 * o.x), y += part * (p.y + q.y - 2.0 * o.y);
  }
  spread.x = o.x + x / sum, spread.y = o.y + y / sum;
}

/// log(t + r) with r^2 = t^2 + h^2, also where t is nearly -r.
double log_of(double t, double r, double h) { return t < 0.0 ? 2.0 * std::log(h) - std::log(r - t) : std::log(t + r); }

/// Mean distance from the middle: over the area in triangles from there, or along the rim.
double mean_distance(std::span<const FaceLoad> corners, Bearing bearing, const FaceSpread& middle) {
  double distance = 0.0, whole = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const FaceLoad &p = corners[i], &q = corners[(i + 1) % corners.size()];
    const double length = length_of(q.x - p.x, q.y - p.y);
    if (!(length > 0.0)) continue;
    const double ex = (q.x - p.x) / length, ey = (q.y - p.y) / length;
    const double px = p.x - middle.x, py = p.y - middle.y;
    const double height = px * ey - py * ex, from = px * ex + py * ey, to = from + length;
    const double near = length_of(height, from), far = length_of(height, to);
    // integral of the distance along the side: (t r + h^2 log(t + r))/2; over the triangle h/3 of that
    const double reach = std::abs(height);
    const bool is_line = reach <= 1e-9 * length;  // through the middle
    const double turn = is_line ? 0.0 : height * height * (log_of(to, far, reach) - log_of(from, near, reach));
    const double along = 0.5 * (to * far - from * near + turn);
    distance += bearing == Bearing::Face ? height / 3.0 * along : along;
    whole += bearing == Bearing::Face ? 0.5 * height * length : length;
  }
  return distance / whole;
}

}  // namespace

bool bears(const WorldModel& model, const Contact& contact, double load) {
  return load > 0.0 || contact.phi + model.settings.dt * contact.approach <= kTouches;
}

void weigh_by_area(std::span<FaceLoad> points) {
  Corners corners;
  std::size_t count = 0;
  double size = 0.0;
  for (const FaceLoad& p : points) {
    if (p.bears) corners[count++] = p;
  }
  const std::span<FaceLoad> bearing{corners.data(), count};
  if (count >= 3) sort_around(bearing);
  for (const FaceLoad& p : bearing) size = std::max(size, length_of(p.x - corners[0].x, p.y - corners[0].y));
  // A line still has some share, should nothing else bear.
  const double area = std::max(count >= 3 ? 0.5 * twice_area(bearing) : 0.0, 1e-6 * size * size + 1e-12);
  for (FaceLoad& p : points) p.weight = p.bears ? area / static_cast<double>(count) : 0.0;
}

FaceWrench wrench_of(std::span<const FaceLoad> points) {
  FaceWrench wrench;
  for (const FaceLoad& p : points) wrench.sum += p.load, wrench.x += p.load * p.x, wrench.y += p.load * p.y;
  return wrench;
}

bool even_loads(std::span<FaceLoad> points) { return even_loads(points, wrench_of(points)); }

bool even_loads(std::span<FaceLoad> points, const FaceWrench& wrench) {
  if (!(wrench.sum > 0.0)) return false;
  Pressure pressure = pressure_of(points, wrench);
  for (std::size_t i = 0; i < points.size() && drop_pulling(points, pressure); ++i)
    pressure = pressure_of(points, wrench);
  FaceWrench found;
  double change = 0.0, size = 0.0;
  for (const FaceLoad& p : points) {
    const double load = pressure.at(p);
    if (load < 0.0) return false;
    found.sum += load, found.x += load * p.x, found.y += load * p.y;
    change = std::max(change, std::abs(load - p.load));
    size = std::max(size, length_of(p.x - points[0].x, p.y - points[0].y));
  }
  const double missed =
      std::abs(found.sum - wrench.sum) * size + std::abs(found.x - wrench.x) + std::abs(found.y - wrench.y);
  if (change <= kEven * wrench.sum || !(missed <= kExact * wrench.sum * size)) return false;
  for (FaceLoad& p : points) p.load = pressure.at(p);
  return true;
}

FaceSpread spread_of(std::span<FaceLoad> corners, Bearing bearing) {
  const auto n = static_cast<double>(corners.size());
  FaceSpread spread;
  for (const FaceLoad& p : corners) spread.x += p.x / n, spread.y += p.y / n;
  if (corners.size() >= 3) sort_around(corners);
  if (is_area(corners)) {
    find_middle(corners, bearing, spread);
    spread.distance = mean_distance(corners, bearing, spread);
    return spread;
  }
  // A line, evenly loaded: half of what its ends are away.
  for (const FaceLoad& p : corners) spread.distance += 0.5 * length_of(p.x - spread.x, p.y - spread.y) / n;
  return spread;
}

void share_unit_load(std::span<FaceLoad> corners, const FaceSpread& middle) {
  for (FaceLoad& p : corners) p.weight = 1.0, p.bears = true;
  const Pressure pressure = pressure_of(corners, {1.0, middle.x, middle.y});
  for (FaceLoad& p : corners) p.load = pressure.at(p);
}

}  // namespace snug::physics::internal
