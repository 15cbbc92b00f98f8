// cast: convex polyhedra by intervals of rows, capsules and cylinders by rays.
#include "snug/camera/cast.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "snug/camera/internal/curved.hpp"
#include "snug/core/parallel.hpp"

namespace snug::camera {
namespace {

constexpr int kRowsCastAtOnce = 16;
/// m: a face whose plane passes nearer to the camera than this is seen edge-on.
constexpr double kEdgeOn = 1e-9;
constexpr double kNearest = 1e-3;  // m: projections of points nearer than this bound nothing

struct Line {
  double slope = 0.0, at_zero = 0.0;  // 1/z = at_zero + slope col, in one row
};

/// A convex shape as the camera sees it.
struct Solid {
  int shape = 0;
  bool is_curved = false;
  int first_row = 0, end_row = 0;  // rows that it may be seen in
  int first_col = 0, end_col = 0;  // columns, curved ones only
  std::vector<int> front;          // surfaces
  std::vector<Vector3> back;       // 1/z >= back . (col, row, 1)
  std::vector<Vector3> edge_on;    // edge_on . (col, row, 1) <= 0
  int surface = -1;                // of a curved one
  geometry::Shape const* geometry = nullptr;
  Pose X_CG;
};

/// (col, row, 1) to the ray's direction.
Matrix3 ray_matrix(const model::CameraIntrinsics& optics) {
  Matrix3 K = Matrix3::Zero();
  K(0, 0) = 1.0 / optics.fx;
  K(0, 2) = -optics.cx / optics.fx;
  K(1, 1) = 1.0 / optics.fy;
  K(1, 2) = -optics.cy / optics.fy;
  K(2, 2) = 1.0;
  return K;
}

void bound(const CastView& view, const std::vector<Vector3>& corners_C, Solid& solid) {
  solid.first_row = 0;
  solid.end_row = view.rows;
  solid.first_col = 0;
  solid.end_col = view.cols;
  double low_row = 1e9, high_row = -1e9, low_col = 1e9, high_col = -1e9;
  for (const Vector3& p : corners_C) {
    if (!(p.z() > kNearest)) return;
    const double col = view.optics.cx + view.optics.fx * p.x() / p.z();
    const double row = view.optics.cy + view.optics.fy * p.y() / p.z();
    low_row = std::min(low_row, row);
    high_row = std::max(high_row, row);
    low_col = std::min(low_col, col);
    high_col = std::max(high_col, col);
  }
  const auto clamp = [](double value, int first, int count) {
    return static_cast<int>(std::clamp(value - first, 0.0, static_cast<double>(count)));
  };
  solid.first_row = clamp(std::ceil(low_row - 1e-6), view.first_row, view.rows);
  solid.end_row = clamp(std::floor(high_row + 1e-6) + 1.0, view.first_row, view.rows);
  solid.first_col = clamp(std::ceil(low_col - 1e-6), view.first_col, view.cols);
  solid.end_col = clamp(std::floor(high_col + 1e-6) + 1.0, view.first_col, view.cols);
}

class Caster {
 public:
  Caster(const Scene& scene, const CastView& view) : view_(view), K_(ray_matrix(view.optics)) {
    const Pose X_CW = view.X_WC.inverse();
    for (std::size_t i = 0; i < scene.shapes.size(); ++i) add(scene.shapes[i], static_cast<int>(i), X_CW);
    cast_.inverse_depth = Grid2<float>(view.rows, view.cols, 0.0F);
    cast_.surface = Grid2<std::int32_t>(view.rows, view.cols, -1);
  }

  Cast run(int threads) {
    parallel_for((view_.rows + kRowsCastAtOnce - 1) / kRowsCastAtOnce, threads, [&](int job, int) {
      const int first = job * kRowsCastAtOnce, end = std::min(view_.rows, first + kRowsCastAtOnce);
      for (const Solid& solid : solids_)
        for (int row = std::max(first, solid.first_row); row < std::min(end, solid.end_row); ++row) {
          if (solid.is_curved)
            draw_curved(solid, row);
          else
            draw_flat(solid, row);
        }
    });
    return std::move(cast_);
  }

 private:
  void add(const SceneShape& placed, int index, const Pose& X_CW) {
    Solid solid;
    solid.shape = index;
    solid.geometry = &placed.shape;
    solid.X_CG = X_CW * placed.X_WG;
    if (const auto* box = std::get_if<geometry::Box>(&placed.shape)) {
      add_box(*box, placed.body, solid);
    } else if (const auto* hull = std::get_if<geometry::ConvexHull>(&placed.shape)) {
      for (std::size_t f = 0; f < hull->faces.size(); ++f) {
        const Vector3 n_G = hull->normals[f];
        add_face(solid, placed.body, static_cast<int>(f), n_G,
                 n_G.dot(hull->vertices[static_cast<std::size_t>(hull->faces[f].front())]));
      }
      std::vector<Vector3> corners;
      for (const Vector3& p_G : hull->vertices) corners.push_back(solid.X_CG * p_G);
      finish(corners, solid);
    } else {
      add_curved(placed, solid);
    }
  }

  void add_box(const geometry::Box& box, int body, Solid& solid) {
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side)
        add_face(solid, body, 2 * axis + side, Vector3::Unit(axis) * (side == 1 ? 1.0 : -1.0), box.half(axis));
    finish(corners_of(box.half, solid.X_CG), solid);
  }

  static std::vector<Vector3> corners_of(const Vector3& half, const Pose& X_CG) {
    std::vector<Vector3> corners;
    for (int i = 0; i < 8; ++i)
      corners.push_back(X_CG * Vector3((i & 1) != 0 ? half.x() : -half.x(), (i & 2) != 0 ? half.y() : -half.y(),
                                       (i & 4) != 0 ? half.z() : -half.z()));
    return corners;
  }

  /// Plane n . p = offset in G.
  void add_face(Solid& solid, int body, int face, const Vector3& n_G, double offset) {
    const Vector3 n_C = solid.X_CG.R * n_G;
    const double h = offset + n_C.dot(solid.X_CG.p);
    const Vector3 n_ray = K_.transpose() * n_C;
    if (std::abs(h) < kEdgeOn) {
      solid.edge_on.push_back(n_ray);
    } else if (h > 0.0) {
      solid.back.push_back(n_ray / h);
    } else {
      solid.front.push_back(static_cast<int>(cast_.surfaces.size()));
      cast_.surfaces.push_back({solid.shape, body, face, n_C, h, n_ray / h});
    }
  }

  void finish(const std::vector<Vector3>& corners, Solid& solid) {
    if (solid.front.empty()) return;
    bound(view_, corners, solid);
    solids_.push_back(solid);
  }

  void add_curved(const SceneShape& placed, Solid& solid) {
    solid.is_curved = true;
    solid.surface = static_cast<int>(cast_.surfaces.size());
    if (internal::is_inside(placed.shape, solid.X_CG.inverse().p)) return;
    cast_.surfaces.push_back({solid.shape, placed.body, -1, Vector3::Zero(), 0.0, Vector3::Zero()});
    bound(view_, corners_of(internal::half_extent(placed.shape), solid.X_CG), solid);
    solids_.push_back(solid);
  }

  void draw_flat(const Solid& solid, int row) {
    const double v = row + view_.first_row;
    double low = view_.first_col, high = view_.first_col + view_.cols - 1;  // columns, in pixels of the optics
    // slope col + at_zero >= 0
    const auto restrict_to = [&](double slope, double at_zero) {
      if (slope > 0.0)
        low = std::max(low, -at_zero / slope);
      else if (slope < 0.0)
        high = std::min(high, -at_zero / slope);
      else if (at_zero < 0.0)
        low = std::numeric_limits<double>::infinity();
    };
    for (const Vector3& e : solid.edge_on) restrict_to(-e.x(), -(e.y() * v + e.z()));
    for (const int s : solid.front) {
      const Vector3& f = cast_.surfaces[static_cast<std::size_t>(s)].inverse;
      const Line front{f.x(), f.y() * v + f.z()};
      restrict_to(front.slope, front.at_zero);
      for (const Vector3& b : solid.back) restrict_to(front.slope - b.x(), front.at_zero - (b.y() * v + b.z()));
      if (!(low <= high)) return;
    }
    const int begin = static_cast<int>(std::ceil(low)) - view_.first_col;
    const int end = static_cast<int>(std::floor(high)) - view_.first_col + 1;
    if (begin < end) fill(solid, row, begin, end);
  }

  /// The nearest of a few lines wins against what was there: the loop that most time goes to.
  void fill(const Solid& solid, int row, int begin, int end) {
    float* const depth = cast_.inverse_depth.row(row);
    std::int32_t* const surface = cast_.surface.row(row);
    const double v = row + view_.first_row;
    const auto line = [&](std::size_t i) {
      const Vector3& f = cast_.surfaces[static_cast<std::size_t>(solid.front[i])].inverse;
      return Line{f.x(), f.y() * v + f.z() + f.x() * (begin + view_.first_col)};
    };
    // Three front faces at a time, those missing doubled; a polyhedron of more is cut again where its lines cross.
    const std::size_t count = solid.front.size();
    if (count <= 3) {
      const std::size_t second = std::min<std::size_t>(1, count - 1), third = count - 1;
      const Line a = line(0), b = line(second), c = line(third);
      const auto a0 = static_cast<float>(a.at_zero), a1 = static_cast<float>(a.slope);
      const auto b0 = static_cast<float>(b.at_zero), b1 = static_cast<float>(b.slope);
      const auto c0 = static_cast<float>(c.at_zero), c1 = static_cast<float>(c.slope);
      const std::int32_t ia = solid.front[0], ib = solid.front[second], ic = solid.front[third];
      for (int i = 0; i < end - begin; ++i) {
        const auto x = static_cast<float>(i);
        const float wa = a0 + a1 * x, wb = b0 + b1 * x, wc = c0 + c1 * x;
        const float wab = wb < wa ? wb : wa;
        const std::int32_t iab = wb < wa ? ib : ia;
        const float w = wc < wab ? wc : wab;
        const std::int32_t id = wc < wab ? ic : iab;
        const bool is_nearer = w > depth[begin + i];
        depth[begin + i] = is_nearer ? w : depth[begin + i];
        surface[begin + i] = is_nearer ? id : surface[begin + i];
      }
      return;
    }
    for (int i = 0; i < end - begin; ++i) {
      double w = std::numeric_limits<double>::infinity();
      std::int32_t id = -1;
      for (std::size_t f = 0; f < count; ++f) {
        const Line l = line(f);
        const double value = l.at_zero + l.slope * i;
        if (value < w) {
          w = value;
          id = solid.front[f];
        }
      }
      if (static_cast<float>(w) > depth[begin + i]) {
        depth[begin + i] = static_cast<float>(w);
        surface[begin + i] = id;
      }
    }
  }

  void draw_curved(const Solid& solid, int row) {
    for (int col = solid.first_col; col < solid.end_col; ++col) {
      const Vector3 ray = K_ * Vector3(col + view_.first_col, row + view_.first_row, 1.0);
      const double z = internal::hit(*solid.geometry, solid.X_CG, ray);
      if (!(z > 0.0)) continue;
      const auto w = static_cast<float>(1.0 / z);
      if (!(w > cast_.inverse_depth(row, col))) continue;
      cast_.inverse_depth(row, col) = w;
      cast_.surface(row, col) = solid.surface;
    }
  }

  const CastView& view_;
  Matrix3 K_;
  std::vector<Solid> solids_;
  Cast cast_;
};

}  // namespace

Cast cast(const Scene& scene, const CastView& view, int threads) { return Caster(scene, view).run(threads); }

Vector3 normal_at(const Cast& cast, const Scene& scene, const CastView& view, int row, int col) {
  const Surface& surface = cast.surfaces[static_cast<std::size_t>(cast.surface(row, col))];
  if (surface.is_flat()) return surface.n_C;
  const SceneShape& placed = scene.shapes[static_cast<std::size_t>(surface.shape)];
  const Vector3 ray = ray_matrix(view.optics) * Vector3(col + view.first_col, row + view.first_row, 1.0);
  const Pose X_CG = view.X_WC.inverse() * placed.X_WG;
  return X_CG.R * internal::curved_normal(placed.shape, X_CG.inverse() * Vector3(ray / cast.inverse_depth(row, col)));
}

}  // namespace snug::camera
