// find_edges: where a face ends, line of pixels by line of pixels.
#include <algorithm>
#include <cmath>
#include <optional>

#include "snug/box_estimation/internal/features.hpp"
#include "snug/camera/loss.hpp"

namespace snug::box_estimation::internal {
namespace {

enum class Kind : std::uint8_t { Outside, On, Before, Behind, None };  // None: no point

struct Sample {
  double s = 0.0;  // m, from the edge, outward, in the face's plane
  Kind kind = Kind::Outside;
};

/// Samples across the edge along one row or column, from inside to outside.
struct Line {
  double t = 0.0;  // m, along the edge from its middle
  std::vector<Sample> samples;
  Kind beyond = Kind::Outside;  // of the first point behind the samples
  bool is_covered = false;      // the face should end where something before it begins, not at its edge
};

struct Edge {
  Vector3 middle, along, outward, n;  // in C; n the face's normal
  double length = 0.0, width = 0.0;   // m, of the face along the edge and across it
  /// Behind a ridge the box's next face is seen: how much more it looks away from the camera than this one, as the
  /// tangent; 0: no ridge, what is seen behind the edge lies deeper.
  double ridge = 0.0;
  int body = -1;  // of the prediction
};

/// One edge as the frame shows it.
class EdgeSearch {
 public:
  EdgeSearch(const FitContext& context, const Edge& edge, double tolerance, const FitStep& step,
             const Prediction& prediction)
      : frame_(context.frame),
        s_(context.settings.edges),
        edge_(edge),
        offset_(edge.n.dot(edge.middle)),
        tolerance_(tolerance),
        reach_(step.reach),
        prediction_(prediction),
        ignores_neighbours_(step.ignores_neighbours) {}

  /// False when the edge is not in the picture, or across the lines of pixels.
  bool gather() {
    const Vector3 a = edge_.middle - (0.5 - s_.inset) * edge_.length * edge_.along;
    const Vector3 b = edge_.middle + (0.5 - s_.inset) * edge_.length * edge_.along;
    if (!(a.z() > 0.05 && b.z() > 0.05)) return false;
    const Eigen::Vector2d pa = camera::project(frame_.camera.intrinsics, a),
                          pb = camera::project(frame_.camera.intrinsics, b);
    const Eigen::Vector2d out = camera::project(frame_.camera.intrinsics, edge_.middle + 0.01 * edge_.outward) -
                                camera::project(frame_.camera.intrinsics, edge_.middle);
    is_steep_ = std::abs(pb.y() - pa.y()) > std::abs(pb.x() - pa.x());
    const int major = is_steep_ ? 1 : 0, minor = 1 - major;
    const int sign = out(minor) >= 0.0 ? 1 : -1;
    const double span = pb(major) - pa(major);
    if (std::abs(span) < s_.least_lines) return false;
    drift_ = std::abs(pb(minor) - pa(minor));
    const int from = static_cast<int>(std::ceil(std::min(pa(major), pb(major))));
    const int to = static_cast<int>(std::floor(std::max(pa(major), pb(major))));
    for (int k = from; k <= to; ++k) {
      const double at = pa(minor) + (pb(minor) - pa(minor)) * (k - pa(major)) / span;
      const int middle = static_cast<int>(std::lround(at));
      Line line;
      for (int d = -reach_; d <= reach_; ++d) line.samples.push_back(sample(k, middle + sign * d, line));
      line.is_covered = is_covered(k, middle, sign);
      line.beyond = line.samples.back().kind;
      Line ignored;
      for (int d = reach_ + 1; d <= reach_ + s_.widest_shadow && line.beyond == Kind::None; ++d)
        line.beyond = sample(k, middle + sign * d, ignored).kind;
      lines_.push_back(std::move(line));
    }
    const Vector3& p_CL = frame_.camera.p_CL;
    is_lit_from_outside_ = p_CL != Vector3::Zero() && edge_.outward.dot(p_CL - edge_.middle) > 0.0;
    spacing_ = mean_spacing();
    return static_cast<int>(lines_.size()) >= s_.least_lines && spacing_ > 0.2 * pixel();
  }

  /// Where most lines agree that the face ends: the offset that leaves the fewest points of the face outside and the
  /// fewest others inside. Points before the face tell nothing.
  [[nodiscard]] double rough_offset() const {
    constexpr double kBin = 0.4e-3;
    const double far = reach_ * spacing_ + kBin;
    const auto count = static_cast<std::size_t>(2.0 * far / kBin) + 1;
    std::vector<double> gain(count, 0.0);
    for (const Line& line : lines_)
      for (const Sample& sample : line.samples) {
        if (sample.kind == Kind::Outside || sample.kind == Kind::Before) continue;
        const auto bin =
            static_cast<std::size_t>(std::clamp((sample.s + far) / kBin, 0.0, static_cast<double>(count - 1)));
        gain[bin] += sample.kind == Kind::On ? 1.0 : sample.kind == Kind::Behind ? -1.0 : -0.5;
      }
    double sum = 0.0, best = 0.0;
    std::size_t best_bin = 0;
    for (std::size_t i = 0; i < count; ++i) {
      sum += gain[i];
      if (sum > best) {
        best = sum;
        best_bin = i + 1;
      }
    }
    return static_cast<double>(best_bin) * kBin - far;
  }

  struct Found {
    double offset = 0.0, slope = 0.0;  // m, rad
    double lines = 0.0;                // used
    double length = 0.0;               // m, standard deviation of where along the edge they are
    bool is_drop = true;               // an edge of depth that loses points
    double spread = 0.0;               // m, of single lines
  };

  /// Counts the points of the face in a window around the rough end, on each line.
  [[nodiscard]] std::optional<Found> refine(double rough) const {
    const double step = spacing_;
    std::vector<Eigen::Vector2d> ends;  // t, s
    int drops = 0, steps = 0;
    for (const Line& line : lines_) {
      int on = 0, outer_on = 0, inner_off = 0, inside = 0;
      bool is_blocked = false;
      double first = 1e9;
      for (const Sample& sample : line.samples) {
        const double d = (sample.s - rough) / step;  // samples
        if (sample.kind == Kind::Outside) continue;
        if (d > -s_.window - 2.5 && d < s_.window + 1.5 && sample.kind == Kind::Before) is_blocked = true;
        if (d >= -s_.window - 2.5 && d < -s_.window && sample.kind != Kind::On) ++inner_off;
        if (d < -s_.window || d >= s_.window) continue;
        first = std::min(first, sample.s);
        ++inside;
        on += sample.kind == Kind::On ? 1 : 0;
        outer_on += sample.kind == Kind::On && d > s_.window - 1.5 ? 1 : 0;
      }
      if (is_blocked || ends_in_shadow(line, rough + (s_.window - 1) * step) || outer_on > 0 || inner_off > 1 ||
          inside < 2 * s_.window - 1)
        continue;
      for (const Sample& sample : line.samples) {
        const double d = (sample.s - rough) / step;
        if (d < 0.5 || d > 4.0) continue;
        drops += sample.kind == Kind::Behind || sample.kind == Kind::None ? 1 : 0;
        ++steps;
      }
      ends.emplace_back(line.t, first + (on - 0.5) * step);
    }
    if (static_cast<double>(ends.size()) <
        std::max<double>(s_.least_lines, s_.least_part * static_cast<double>(lines_.size())))
      return std::nullopt;
    return straight_line(ends, drops > steps / 2);
  }

  /// m, outward from sample to sample. A line of pixels crosses an edge that is turned against the grid obliquely: its
  /// samples are nearer to each other than pixels are.
  [[nodiscard]] double spacing() const { return spacing_; }
  [[nodiscard]] double drift() const { return drift_; }

 private:
  [[nodiscard]] double pixel() const {
    return std::abs(edge_.middle.z()) / (is_steep_ ? frame_.camera.intrinsics.fx : frame_.camera.intrinsics.fy);
  }

  [[nodiscard]] double mean_spacing() const {
    double sum = 0.0, count = 0.0;
    for (const Line& line : lines_)
      for (std::size_t i = 1; i < line.samples.size(); ++i) {
        if (line.samples[i - 1].kind == Kind::Outside || line.samples[i].kind == Kind::Outside) continue;
        sum += line.samples[i].s - line.samples[i - 1].s;
        count += 1.0;
      }
    return count > 0.0 ? sum / count : 0.0;
  }

  Sample sample(int major, int minor, Line& line) const {
    const int row = is_steep_ ? major : minor, col = is_steep_ ? minor : major;
    if (!frame_.depth.is_inside(row, col)) return {};
    const Vector3 ray = camera::pixel_ray(frame_.camera.intrinsics, col, row);
    const double z = offset_ / edge_.n.dot(ray);
    if (!(z > 0.05)) return {};
    const Vector3 from_middle = z * ray - edge_.middle;
    line.t = edge_.along.dot(from_middle);
    Sample result{edge_.outward.dot(from_middle), Kind::None};
    const double depth = frame_.depth(row, col);
    if (depth == 0.0) return result;
    const double off = offset_ * (depth / z - 1.0);
    result.kind = std::abs(off) <= tolerance_ ? Kind::On : depth < z ? Kind::Before : Kind::Behind;
    if (result.kind == Kind::On && result.s > 0.0 && is_neighbour(row, col)) result.kind = Kind::Before;
    return result;
  }

  /// Whether another box should be seen in a pixel.
  [[nodiscard]] bool is_neighbour(int row, int col) const {
    if (!ignores_neighbours_) return false;
    const int r = row - prediction_.range.first_row, c = col - prediction_.range.first_col;
    if (!prediction_.cast.surface.is_inside(r, c)) return false;
    const std::int32_t s = prediction_.cast.surface(r, c);
    if (s < 0) return false;
    const int body = prediction_.cast.surfaces[static_cast<std::size_t>(s)].body;
    return body >= prediction_.first_box && body != edge_.body;
  }

  /// Whether the face is predicted to end, near its edge, where something before it begins.
  [[nodiscard]] bool is_covered(int major, int middle, int sign) const {
    bool was_own = false;
    for (int d = -reach_; d <= reach_; ++d) {
      const int row = is_steep_ ? major : middle + sign * d, col = is_steep_ ? middle + sign * d : major;
      const int r = row - prediction_.range.first_row, c = col - prediction_.range.first_col;
      if (!prediction_.cast.surface.is_inside(r, c)) return false;
      const std::int32_t s = prediction_.cast.surface(r, c);
      const bool is_own = s >= 0 && prediction_.cast.surfaces[static_cast<std::size_t>(s)].body == edge_.body;
      if (was_own && !is_own) {
        const double z = offset_ / edge_.n.dot(camera::pixel_ray(frame_.camera.intrinsics, col, row));
        return s >= 0 && z * prediction_.cast.inverse_depth(r, c) > 1.0;
      }
      was_own = is_own;
    }
    return false;
  }

  /// Whether something before the face is what comes next behind `s`: the face may go on below, covered or unlit.
  [[nodiscard]] bool ends_in_shadow(const Line& line, double s) const {
    if (!line.is_covered && !is_lit_from_outside_) return false;
    for (const Sample& sample : line.samples)
      if (sample.s > s && sample.kind != Kind::None && sample.kind != Kind::Outside) return sample.kind == Kind::Before;
    return line.beyond == Kind::Before;
  }

  /// Through the ends by least squares, twice: those beyond three standard deviations are left out the second time.
  [[nodiscard]] std::optional<Found> straight_line(const std::vector<Eigen::Vector2d>& ends, bool is_drop) const {
    Found found;
    found.is_drop = is_drop;
    double limit = 1e9;
    for (int pass = 0; pass < 3; ++pass) {
      double n = 0, t = 0, tt = 0, s = 0, ts = 0, squares = 0;
      for (const Eigen::Vector2d& end : ends) {
        const double residual = end.y() - found.offset - found.slope * end.x();
        if (std::abs(residual) > limit) continue;
        n += 1.0;
        t += end.x();
        tt += end.x() * end.x();
        s += end.y();
        ts += end.x() * end.y();
      }
      const double determinant = n * tt - t * t;
      if (n < s_.least_lines || !(determinant > 0.0)) return std::nullopt;
      found.slope = (n * ts - t * s) / determinant;
      found.offset = (s - found.slope * t) / n;
      found.lines = n;
      found.length = std::sqrt(determinant) / n;
      for (const Eigen::Vector2d& end : ends) {
        const double residual = end.y() - found.offset - found.slope * end.x();
        if (std::abs(residual) <= limit) squares += residual * residual;
      }
      found.spread = std::sqrt(squares / n);
      limit = std::max(3.0 * found.spread, 1e-4);
    }
    return found;
  }

  const camera::Frame& frame_;
  const EdgeSettings& s_;
  Edge edge_;
  double offset_, tolerance_;
  int reach_;
  const Prediction& prediction_;
  bool ignores_neighbours_;
  bool is_steep_ = false;
  bool is_lit_from_outside_ = false;  // shadows fall inward: what is before the face behind its edge casts them on it
  double drift_ = 0.0;                // px, by which the edge crosses the grid of pixels
  double spacing_ = 0.0;
  std::vector<Line> lines_;
};

/// Rows of the fit from offset and slope.
Rows make_rows(const Edge& edge, const Vector3& middle_of_box, double offset, double slope) {
  Rows rows;
  rows.count = 2;
  const Vector3 arm = edge.middle - middle_of_box;
  rows.J.row(0) << edge.outward.transpose(), arm.cross(edge.outward).transpose();
  rows.J.row(1) << Vector3::Zero().transpose(), edge.along.cross(edge.outward).transpose();
  rows.measured = Vector3(offset, slope, 0.0);
  return rows;
}

std::optional<Rows> measure(const FitContext& context, const TrackedBox& box, const Edge& edge, const FitStep& how,
                            const Prediction& prediction, bool& is_coarse) {
  const ErrorModel& errors = context.errors;
  const EdgeSettings& settings = context.settings.edges;
  const double depth = edge.middle.z();
  const double tolerance = std::max(3.5 * errors.point_error(depth), 0.5e-3);
  EdgeSearch search(context, edge, tolerance, how, prediction);
  if (!search.gather()) return std::nullopt;
  const double rough = search.rough_offset(), step = search.spacing();
  is_coarse = std::abs(rough) > (how.reach - settings.window - 2) * step;
  if (is_coarse) {
    // Too near the end of the band to be counted. At its very end all of the band is face, or none: the end lies
    // beyond.
    const bool is_beyond = std::abs(rough) > (how.reach - 1.5) * step;
    Rows rows = make_rows(edge, box.X_CP.p, rough, 0.0);
    rows.count = 1;
    rows.covariance = Matrix3::Identity() * std::pow((is_beyond ? 0.3 * how.reach : 2.0) * step, 2);
    return rows;
  }
  const auto found = search.refine(rough);
  if (!found) return std::nullopt;
  const double part_lost = found->is_drop ? camera::edge_loss_at_ridge(edge.ridge, step) : 0.0;
  // Over a ridge points count as the face's own until the next face is a tolerance lower.
  const double beyond = (1.0 - part_lost) * tolerance * edge.ridge;
  const double lost = part_lost * errors.edge_shift() * step;
  Rows rows = make_rows(edge, box.X_CP.p, found->offset + lost - beyond, found->slope);
  // Where between two pixels the edge lies decides what is rounded, and whether points are lost at a ridge: alike on
  // all lines of an edge along the grid; it evens out where the edge crosses the grid.
  const double of_place = step * step * (1.0 / 12.0 + part_lost * (1.0 - part_lost) * std::pow(errors.edge_shift(), 2));
  const double drift = search.drift();
  const double alike = std::pow(std::max(0.0, 1.0 - drift), 2);  // of the mean over `drift` pixels
  const double likely = std::hypot(drift, settings.drift_error);
  const double tilting = likely < 1.0 ? likely * (1.2 - likely) : 0.2 / (likely * likely);
  const double of_lines = found->spread * found->spread / found->lines;
  const double offset = of_place * alike + of_lines + std::pow(settings.offset_error * step, 2) +
                        std::pow(errors.length_error(0.5 * edge.width), 2) + std::pow(settings.ridge_error * beyond, 2);
  const double slope = (of_place * tilting + of_lines) / (found->length * found->length);
  rows.covariance = Vector3(offset, slope, 1.0).asDiagonal();
  return rows;
}

}  // namespace

std::vector<EdgeFeature> find_edges(const FitContext& context, const Prediction& prediction,
                                    const std::vector<TrackedBox>& boxes, const FitStep& step) {
  const EdgeSettings& settings = context.settings.edges;
  std::vector<int> seen(prediction.cast.surfaces.size(), 0);
  for (const std::int32_t s : prediction.cast.surface.values())
    if (s >= 0) ++seen[static_cast<std::size_t>(s)];
  const auto shows = [&](int body, int face) {
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (prediction.cast.surfaces[i].body == body && prediction.cast.surfaces[i].face == face)
        return seen[i] >= settings.least_pixels_of_face;
    return false;
  };
  std::vector<EdgeFeature> features;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const camera::Surface& surface = prediction.cast.surfaces[i];
    if (surface.body < prediction.first_box + step.first_box || seen[i] < settings.least_pixels_of_face) continue;
    const int index = surface.body - prediction.first_box;
    const TrackedBox& box = boxes[static_cast<std::size_t>(index)];
    const int axis = surface.face / 2;
    const double facing = std::abs(surface.offset) / (box.X_CP.p + box.half(axis) * surface.n_C).norm();
    if (facing < settings.least_facing) continue;  // seen too flat: its pixels are long
    for (int k = 1; k <= 2; ++k)
      for (int side = 0; side < 2; ++side) {
        const int across = (axis + k) % 3, along = 3 - axis - across;
        Edge edge;
        edge.body = surface.body;
        edge.n = surface.n_C;
        edge.outward = box.X_CP.R.col(across) * (side == 1 ? 1.0 : -1.0);
        edge.along = box.X_CP.R.col(along);
        edge.length = 2.0 * box.half(along);
        edge.width = 2.0 * box.half(across);
        edge.middle = box.X_CP.p + box.half(axis) * surface.n_C + box.half(across) * edge.outward;
        if (shows(surface.body, 2 * across + side))
          edge.ridge = std::max(0.0, edge.outward.dot(edge.middle) / edge.n.dot(edge.middle));
        EdgeFeature feature;
        const auto rows = measure(context, box, edge, step, prediction, feature.is_coarse);
        if (!rows) continue;
        feature.box = index;
        feature.axis = across;
        feature.side = side;
        feature.rows = *rows;
        features.push_back(feature);
      }
  }
  return features;
}

}  // namespace snug::box_estimation::internal
