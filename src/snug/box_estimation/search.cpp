// propose_poses: flat patches of unexplained points, rectangles around them, boxes whose faces these can be.
#include "snug/box_estimation/internal/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "snug/geometry/bounds.hpp"
#include "snug/geometry/manifold.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::box_estimation::internal {
namespace {

struct Block {
  int count = 0;
  Vector3 sum = Vector3::Zero();
  Matrix3 squares = Matrix3::Zero();
  Vector3 n = Vector3::Zero();  // toward the camera; zero: not flat
  Vector3 mean = Vector3::Zero();
  int patch = -1;
};

struct Patch {
  Vector3 n = Vector3::Zero(), mean = Vector3::Zero();
  std::vector<Vector3> points;  // thinned, near the plane
  int count = 0;
};

/// Normal of the plane through points with these sums; false when they are not flat within `noise`.
bool fit_plane(int count, const Vector3& sum, const Matrix3& squares, double noise, Vector3& n, Vector3& mean) {
  mean = sum / count;
  const Matrix3 spread = squares / count - mean * mean.transpose();
  const Eigenpairs3 axes = symmetric_eigenpairs(spread);
  n = axes.vectors.col(0);
  if (n.dot(mean) > 0.0) n = -n;
  return axes.values(0) < noise * noise && axes.values(1) > 4.0 * axes.values(0);
}

class Patches {
 public:
  Patches(const FitContext& context, const Prediction& prediction, const camera::Grid2<std::uint8_t>& mask,
          double noise)
      : frame_(context.frame),
        s_(context.settings.search),
        block_(context.settings.search.block),
        range_(prediction.range),
        mask_(mask),
        noise_(noise),
        blocks_(range_.rows() / block_, range_.cols() / block_) {
    for (int r = 0; r < blocks_.rows(); ++r)
      for (int c = 0; c < blocks_.cols(); ++c) fill(r, c);
  }

  std::vector<Patch> grow() {
    std::vector<Patch> patches;
    for (int r = 0; r < blocks_.rows(); ++r)
      for (int c = 0; c < blocks_.cols(); ++c)
        if (is_free(r, c)) grow_from(r, c, patches);
    std::sort(patches.begin(), patches.end(), [](const Patch& a, const Patch& b) { return a.count > b.count; });
    return patches;
  }

 private:
  void fill(int r, int c) {
    Block& block = blocks_(r, c);
    for (int i = 0; i < block_; ++i)
      for (int k = 0; k < block_; ++k) {
        const int row = r * block_ + i, col = c * block_ + k;
        if (mask_(row, col) == 0) continue;
        const Vector3 p = point(row, col);
        ++block.count;
        block.sum += p;
        block.squares += p * p.transpose();
      }
    if (block.count < block_ * block_ / 2) return;
    Vector3 n;
    if (fit_plane(block.count, block.sum, block.squares, std::max(3.0 * noise_, 5e-4), n, block.mean)) block.n = n;
  }

  [[nodiscard]] Vector3 point(int row, int col) const {
    const int r = row + range_.first_row, c = col + range_.first_col;
    return static_cast<double>(frame_.depth(r, c)) * camera::pixel_ray(frame_.camera.intrinsics, c, r);
  }
  [[nodiscard]] bool is_free(int r, int c) const {
    return blocks_.is_inside(r, c) && blocks_(r, c).patch < 0 && blocks_(r, c).n != Vector3::Zero();
  }

  void grow_from(int row, int col, std::vector<Patch>& patches) {
    const int id = next_++;
    std::vector<std::pair<int, int>> open = {{row, col}};
    blocks_(row, col).patch = id;
    int count = 0;
    Vector3 sum = Vector3::Zero();
    Matrix3 squares = Matrix3::Zero();
    Vector3 n = blocks_(row, col).n, mean = blocks_(row, col).mean;
    std::vector<std::pair<int, int>> members;
    while (!open.empty()) {
      const auto [r, c] = open.back();
      open.pop_back();
      members.emplace_back(r, c);
      const Block& here = blocks_(r, c);
      count += here.count;
      sum += here.sum;
      squares += here.squares;
      if (members.size() >= 4) (void)fit_plane(count, sum, squares, 1.0, n, mean);
      for (const auto& [dr, dc] : std::array<std::pair<int, int>, 4>{{{0, 1}, {1, 0}, {0, -1}, {-1, 0}}}) {
        if (!is_free(r + dr, c + dc)) continue;
        const Block& next = blocks_(r + dr, c + dc);
        const double step = std::max(4.0 * noise_, 1.5e-3);
        if (next.n.dot(here.n) < s_.same_normal - 2.0 * noise_ / 6e-3 || std::abs(n.dot(next.mean - mean)) > step)
          continue;
        blocks_(r + dr, c + dc).patch = id;
        open.emplace_back(r + dr, c + dc);
      }
    }
    if (static_cast<int>(members.size()) < s_.least_blocks) return;
    Patch patch;
    patch.n = n;
    patch.mean = mean;
    // Its points, and those of the blocks around it that lie in its plane: faces do not end where blocks do.
    camera::Grid2<std::uint8_t> around(blocks_.rows(), blocks_.cols());
    for (const auto& [r, c] : members)
      for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc)
          if (around.is_inside(r + dr, c + dc)) around(r + dr, c + dc) = 1;
    const double tolerance = std::max(3.5 * noise_, 1e-3);
    const int stride = members.size() > 60 ? 2 : 1;
    for (int r = 0; r < blocks_.rows(); ++r)
      for (int c = 0; c < blocks_.cols(); ++c) {
        if (around(r, c) == 0) continue;
        for (int i = 0; i < block_; i += stride)
          for (int k = 0; k < block_; k += stride) {
            if (mask_(r * block_ + i, c * block_ + k) == 0) continue;
            const Vector3 p = point(r * block_ + i, c * block_ + k);
            if (std::abs(n.dot(p - mean)) < tolerance) patch.points.push_back(p);
          }
      }
    patch.count = count;
    patches.push_back(std::move(patch));
  }

  const camera::Frame& frame_;
  const SearchSettings& s_;
  int block_;
  PixelRange range_;
  const camera::Grid2<std::uint8_t>& mask_;
  double noise_;
  camera::Grid2<Block> blocks_;
  int next_ = 0;
};

/// Smallest rectangle around most points of a patch, in its plane.
struct Rectangle {
  Vector3 centre, u, v;              // in C
  double width = 0.0, height = 0.0;  // m, along u and v
};

Rectangle rectangle_of(const Patch& patch) {
  const Vector3 e1 = patch.n.unitOrthogonal(), e2 = patch.n.cross(e1);
  Rectangle best;
  double least = 1e9;
  std::vector<double> a(patch.points.size()), b(patch.points.size());
  const auto ends = [](std::vector<double>& values) {
    // Half a percent of strays on each side.
    const std::size_t k = values.size() / 200;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(k), values.end());
    const double low = values[k];
    std::nth_element(values.begin(), values.end() - 1 - static_cast<std::ptrdiff_t>(k), values.end());
    return std::pair(low, values[values.size() - 1 - k]);
  };
  for (int degrees = 0; degrees < 90; degrees += 2) {
    const double angle = degrees * std::numbers::pi / 180.0;
    const Vector3 u = std::cos(angle) * e1 + std::sin(angle) * e2, v = patch.n.cross(u);
    for (std::size_t i = 0; i < patch.points.size(); ++i) {
      a[i] = u.dot(patch.points[i] - patch.mean);
      b[i] = v.dot(patch.points[i] - patch.mean);
    }
    const auto [low_a, high_a] = ends(a);
    const auto [low_b, high_b] = ends(b);
    const double area = (high_a - low_a) * (high_b - low_b);
    if (!(area < least)) continue;
    least = area;
    best.u = u;
    best.v = v;
    best.width = high_a - low_a;
    best.height = high_b - low_b;
    best.centre = patch.mean + 0.5 * (low_a + high_a) * u + 0.5 * (low_b + high_b) * v;
  }
  return best;
}

/// How well a box at a pose agrees with the frame, over the faces that the camera sees.
class Judge {
 public:
  Judge(const FitContext& context, const Prediction& prediction, const camera::Grid2<std::uint8_t>& mask, double noise)
      : frame_(context.frame),
        samples_(context.settings.search.samples),
        range_(prediction.range),
        mask_(mask),
        tolerance_(std::max(4.0 * noise, 4e-3)) {}

  /// Area of it that is seen where it should be, m^2, less three times what is seen through, less what other things
  /// explain.
  [[nodiscard]] double score(const Vector3& half, const Pose& X_CP, double& part_on) const {
    double on = 0.0, through = 0.0, taken = 0.0;
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2, a = (axis + 1) % 3, b = (axis + 2) % 3;
      const Vector3 n = X_CP.R.col(axis) * (face % 2 == 1 ? 1.0 : -1.0);
      const Vector3 centre = X_CP.p + half(axis) * n;
      const double facing = -n.dot(centre) / centre.norm();
      if (facing < 0.1) continue;
      const double area = 4.0 * half(a) * half(b) * facing / (samples_ * samples_);
      for (int i = 0; i < samples_; ++i)
        for (int k = 0; k < samples_; ++k) {
          const Vector3 p = centre + half(a) * ((2 * i + 1.0) / samples_ - 1.0) * 0.96 * X_CP.R.col(a) +
                            half(b) * ((2 * k + 1.0) / samples_ - 1.0) * 0.96 * X_CP.R.col(b);
          add(p, area, facing, on, through, taken);
        }
    }
    const double seen = on + through + taken;
    part_on = seen > 0.0 ? on / seen : 0.0;
    return on - 3.0 * through - 1.5 * taken;
  }

 private:
  void add(const Vector3& p, double area, double facing, double& on, double& through, double& taken) const {
    const Eigen::Vector2d pixel = camera::project(frame_.camera.intrinsics, p);
    const int col = static_cast<int>(std::lround(pixel.x())), row = static_cast<int>(std::lround(pixel.y()));
    if (!frame_.depth.is_inside(row, col)) return;
    const double depth = frame_.depth(row, col);
    if (depth == 0.0) return;
    const double off = (depth - p.z()) * facing;
    if (off > tolerance_) {
      through += area;
    } else if (off > -tolerance_) {
      const int r = row - range_.first_row, c = col - range_.first_col;
      const bool is_unexplained = mask_.is_inside(r, c) && mask_(r, c) != 0;
      (is_unexplained ? on : taken) += area;
    }
  }

  const camera::Frame& frame_;
  int samples_;
  PixelRange range_;
  const camera::Grid2<std::uint8_t>& mask_;
  double tolerance_;
};

/// Whether a point is in the region, over it, or at its rim.
bool is_about(const EstimateInput& input, const Vector3& p_W, double rim) {
  return (p_W.array() > input.region_low.array() - rim).all() &&
         (p_W.head<2>().array() < input.region_high.head<2>().array() + rim).all();
}

struct Scored {
  double score = 0.0;
  Pose X_CP;
};

/// Calls visit(pose, likeliness) for each way in which a face of the box can be the rectangle, or a part of it seen.
template <class Visit>
void each_pose(const Wanted& wanted, const Rectangle& rectangle, const Vector3& n, double shrink,
               const SearchSettings& settings, const Visit& visit) {
  for (int axis = 0; axis < 3; ++axis)
    for (int turn = 0; turn < 2; ++turn) {
      const int a = (axis + 1 + turn) % 3, b = 3 - axis - a;  // P axes along u and v
      const double slack_u = 2.0 * wanted.half(a) - rectangle.width, slack_v = 2.0 * wanted.half(b) - rectangle.height;
      if (slack_u < -settings.fit || slack_v < -settings.fit) continue;
      // A face that is seen whole is as large as the box says, less the points that edges lose.
      double likeliness = 1.0;
      for (const double slack : {slack_u, slack_v})
        if (slack <= settings.fit)
          likeliness *= 0.3 + 0.7 * std::exp(-0.5 * std::pow((slack - shrink) / settings.size_error, 2));
      Matrix3 R_CP;
      R_CP.col(a) = rectangle.u;
      R_CP.col(b) = rectangle.v;
      R_CP.col(axis) = R_CP.col(b).cross(R_CP.col(a)) * ((a + 1) % 3 == b ? -1.0 : 1.0);
      const Matrix3 R = nearest_equal_rotation(R_CP, wanted.X_CP_prior.R);
      const Vector3 middle = rectangle.centre - wanted.half(axis) * n;
      // Where the patch is smaller than the face, it may be any of its corners.
      for (const double su : {-0.5, 0.0, 0.5})
        for (const double sv : {-0.5, 0.0, 0.5}) {
          if ((su != 0.0) != (slack_u > settings.fit) || (sv != 0.0) != (slack_v > settings.fit)) continue;
          visit(Pose{R, middle + su * slack_u * rectangle.u + sv * slack_v * rectangle.v}, likeliness);
        }
    }
}

/// How likely it is to find a box there, 0 .. 1: less where it would be in one of the solids, or touch none. Rough
/// poses are off by a few millimetres.
double likely_place(const Vector3& half, const Pose& X_CP, const std::vector<camera::SceneShape>& solids_C,
                    const SearchSettings& settings) {
  const double touch = settings.touch, gap = least_gap(half, X_CP, solids_C, touch);
  if (gap >= touch) return settings.in_the_air;
  return gap > -touch ? 1.0 : std::max(0.1, 1.0 + 40.0 * (gap + touch));
}

}  // namespace

camera::Grid2<std::uint8_t> unexplained(const camera::Frame& frame, const Prediction& prediction, double tolerance) {
  const PixelRange& range = prediction.range;
  camera::Grid2<std::uint8_t> mask(range.rows(), range.cols());
  for (int r = 0; r < range.rows(); ++r)
    for (int c = 0; c < range.cols(); ++c) {
      const float depth = frame.depth(r + range.first_row, c + range.first_col);
      if (depth == 0.0F) continue;
      const std::int32_t s = prediction.cast.surface(r, c);
      if (s < 0) {
        mask(r, c) = 1;
        continue;
      }
      if (distance_outward(prediction, s, r, c, depth) > tolerance) mask(r, c) = 1;
    }
  return mask;
}

double least_gap(const Vector3& half, const Pose& X_CP, const std::vector<camera::SceneShape>& solids_C, double touch) {
  const geometry::Shape box = geometry::Box{half};
  double least = touch;
  for (const camera::SceneShape& solid : solids_C) {
    if ((X_CP.p - solid.X_WG.p).norm() >
        geometry::bounding_radius(box) + geometry::bounding_radius(solid.shape) + touch)
      continue;
    geometry::PairCache cache;
    geometry::Manifold manifold;
    geometry::collide(box, X_CP, solid.shape, solid.X_WG, touch, cache, manifold);
    for (int i = 0; i < manifold.count; ++i) least = std::min(least, manifold.points[static_cast<std::size_t>(i)].phi);
  }
  return least;
}

std::vector<std::vector<Pose>> propose_poses(const Known& known, const Prediction& prediction,
                                             const std::vector<Wanted>& wanted,
                                             const std::vector<camera::SceneShape>& solids_C) {
  const camera::Frame& frame = known.context.frame;
  const ErrorModel& errors = known.context.errors;
  const SearchSettings& settings = known.context.settings.search;
  const double noise = errors.point_error(frame.camera.range.focus);
  const auto points = unexplained(frame, prediction, known.tolerance + settings.unexplained);
  const Judge judge(known.context, prediction, points, noise);
  std::vector<std::vector<Scored>> all(wanted.size());
  for (const Patch& patch : Patches(known.context, prediction, points, noise).grow()) {
    if (patch.points.size() < 40 || !is_about(known.input, frame.camera.X_WC * patch.mean, settings.rim)) continue;
    const Rectangle rectangle = rectangle_of(patch);
    const double shrink = 2.0 * errors.edge_shift() * patch.mean.z() / frame.camera.intrinsics.fx;
    for (std::size_t i = 0; i < wanted.size(); ++i)
      each_pose(wanted[i], rectangle, patch.n, shrink, settings, [&](const Pose& X_CP, double likeliness) {
        double part_on = 0.0;
        double score = judge.score(wanted[i].half, X_CP, part_on);
        if (part_on < settings.least_part) return;
        score *= likeliness * likely_place(wanted[i].half, X_CP, solids_C, settings);
        if (score > settings.least_score) all[i].push_back({score, X_CP});
      });
  }
  std::vector<std::vector<Pose>> poses(wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    std::stable_sort(all[i].begin(), all[i].end(), [](const Scored& a, const Scored& b) { return a.score > b.score; });
    for (const Scored& one : all[i]) {
      const bool is_known = std::any_of(poses[i].begin(), poses[i].end(), [&](const Pose& other) {
        return (other.p - one.X_CP.p).norm() < settings.same_place &&
               angle_between(nearest_equal_rotation(one.X_CP.R, other.R), other.R) < settings.same_turn;
      });
      if (!is_known) poses[i].push_back(one.X_CP);
      if (static_cast<int>(poses[i].size()) == settings.most_poses) break;
    }
  }
  return poses;
}

}  // namespace snug::box_estimation::internal
