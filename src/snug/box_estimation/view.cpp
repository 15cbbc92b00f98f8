// View: a frame beside what would be seen.
#include "snug/box_estimation/internal/view.hpp"

#include <algorithm>
#include <cmath>

#include "snug/geometry/manifold.hpp"

namespace snug::box_estimation::internal {

PixelRange pixel_range(const model::CameraParams& camera, const Vector3& low, const Vector3& high) {
  const PixelRange all{0, camera.height, 0, camera.width};
  const Pose X_CW = camera.X_WC.inverse();
  double low_col = 1e9, high_col = -1e9, low_row = 1e9, high_row = -1e9;
  for (int i = 0; i < 8; ++i) {
    const Vector3 p_C = X_CW * Vector3((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                                       (i & 4) != 0 ? high.z() : low.z());
    if (!(p_C.z() > 0.01)) return all;
    const Eigen::Vector2d pixel = camera::project(camera.intrinsics, p_C);
    low_col = std::min(low_col, pixel.x());
    high_col = std::max(high_col, pixel.x());
    low_row = std::min(low_row, pixel.y());
    high_row = std::max(high_row, pixel.y());
  }
  const auto clamp = [](double value, int most) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(most)));
  };
  return {clamp(std::floor(low_row), all.end_row), clamp(std::ceil(high_row) + 1.0, all.end_row),
          clamp(std::floor(low_col), all.end_col), clamp(std::ceil(high_col) + 1.0, all.end_col)};
}

PixelRange pixels_around(const camera::Frame& frame, const PixelRange& range, const TrackedBox& box, int border) {
  model::CameraParams at_origin = frame.camera;
  at_origin.X_WC = Pose{};
  const Vector3 reach = box.X_CP.R.cwiseAbs() * box.half;
  const PixelRange own = pixel_range(at_origin, box.X_CP.p - reach, box.X_CP.p + reach);
  const auto between = [](int value, int low, int high) { return std::clamp(value, low, high); };
  return {between(own.first_row - border, range.first_row, range.end_row),
          between(own.end_row + border, range.first_row, range.end_row),
          between(own.first_col - border, range.first_col, range.end_col),
          between(own.end_col + border, range.first_col, range.end_col)};
}

camera::Scene in_camera(const camera::Scene& scene, const Pose& X_WC) {
  camera::Scene scene_C = scene;
  const Pose X_CW = X_WC.inverse();
  for (Pose& X : scene_C.X_WB) X = X_CW * X;
  for (camera::SceneShape& shape : scene_C.shapes) shape.X_WG = X_CW * shape.X_WG;
  return scene_C;
}

Prediction predict(const camera::Frame& frame, const PixelRange& range, const camera::Scene& surroundings_C,
                   const std::vector<TrackedBox>& boxes) {
  camera::Scene scene = surroundings_C;
  Prediction prediction;
  prediction.range = range;
  prediction.first_box = static_cast<int>(scene.names.size());
  for (const TrackedBox& box : boxes) camera::add_box(scene, "", box.X_CP, 2.0 * box.half);
  prediction.cast = camera::cast(
      scene, {Pose{}, frame.camera.intrinsics, range.rows(), range.cols(), range.first_row, range.first_col});
  return prediction;
}

std::vector<Agreement> compare(const camera::Frame& frame, const Prediction& prediction,
                               const std::vector<double>& tolerances) {
  std::vector<Agreement> all(tolerances.size());
  const camera::Cast& cast = prediction.cast;
  for (int r = 0; r < prediction.range.rows(); ++r) {
    const float* const depth = frame.depth.row(r + prediction.range.first_row) + prediction.range.first_col;
    const std::int32_t* const surface = cast.surface.row(r);
    const float* const w = cast.inverse_depth.row(r);
    for (int c = 0; c < prediction.range.cols(); ++c) {
      if (surface[c] < 0) continue;
      const camera::Surface& face = cast.surfaces[static_cast<std::size_t>(surface[c])];
      if (face.body < prediction.first_box) continue;
      const auto index = static_cast<std::size_t>(face.body - prediction.first_box);
      Agreement& one = all[index];
      ++one.pixels;
      if (depth[c] == 0.0F) {
        ++one.missing;
        continue;
      }
      const double off = face.offset * (static_cast<double>(depth[c]) * w[c] - 1.0);  // along the outward normal
      if (std::abs(off) <= tolerances[index]) {
        ++one.on;
        one.squares += off * off;
      } else {
        ++(depth[c] * w[c] < 1.0F ? one.nearer : one.farther);
      }
    }
  }
  return all;
}

int disagreeing(const camera::Frame& frame, const Prediction& prediction, const PixelRange& range, double tolerance) {
  int count = 0;
  for (int row = range.first_row; row < range.end_row; ++row)
    for (int col = range.first_col; col < range.end_col; ++col) {
      const double depth = frame.depth(row, col);
      if (depth == 0.0) continue;
      const int r = row - prediction.range.first_row, c = col - prediction.range.first_col;
      const std::int32_t s = prediction.cast.surface(r, c);
      if (s < 0 || std::abs(distance_outward(prediction, s, r, c, depth)) > tolerance) ++count;
    }
  return count;
}

double overlap(const TrackedBox& a, const TrackedBox& b) {
  const geometry::Shape A = geometry::Box{a.half}, B = geometry::Box{b.half};
  if ((a.X_CP.p - b.X_CP.p).norm() > a.half.norm() + b.half.norm()) return 0.0;
  geometry::PairCache cache;
  geometry::Manifold manifold;
  geometry::collide(A, a.X_CP, B, b.X_CP, 0.0, cache, manifold);
  double deepest = 0.0;
  for (int i = 0; i < manifold.count; ++i)
    deepest = std::max(deepest, -manifold.points[static_cast<std::size_t>(i)].phi);
  return deepest;
}

double distance_outward(const Prediction& prediction, std::int32_t surface, int r, int c, double depth) {
  const camera::Surface& seen = prediction.cast.surfaces[static_cast<std::size_t>(surface)];
  const double w = prediction.cast.inverse_depth(r, c), ratio = depth * w - 1.0;
  return seen.is_flat() ? seen.offset * ratio : -ratio / w;
}

}  // namespace snug::box_estimation::internal
