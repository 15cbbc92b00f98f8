// cast: which surface each pixel of a pinhole camera sees, and how deep, exactly.
#pragma once

#include <cstdint>
#include <vector>

#include "snug/camera/grid.hpp"
#include "snug/camera/scene.hpp"
#include "snug/model/camera_params.hpp"

namespace snug::camera {

/// A flat or curved piece of a shape's surface, in the camera's frame.
struct Surface {
  int shape = 0;  ///< index into Scene::shapes
  int body = 0;
  int face = -1;                  ///< box: 2 axis + (outward normal along +axis ? 1 : 0); hull: its face; curved: -1
  Vector3 n_C = Vector3::Zero();  ///< outward unit normal; zero when curved
  double offset = 0.0;            ///< flat: n_C . p_C of its points, m; negative
  Vector3 inverse = Vector3::Zero();  ///< flat: 1/z = inverse . (col, row, 1)
  [[nodiscard]] bool is_flat() const { return face >= 0; }
};

/// What is seen. A picture of cols x rows pixels whose first column is `first_col`, first row `first_row`.
struct Cast {
  Grid2<float> inverse_depth;   ///< 1/m; 0: nothing
  Grid2<std::int32_t> surface;  ///< index into surfaces; -1: nothing
  std::vector<Surface> surfaces;
};

struct CastView {
  Pose X_WC;
  model::CameraIntrinsics optics;
  int rows = 0, cols = 0;
  int first_row = 0, first_col = 0;  ///< of the grid, in pixels of the optics
};

/// Flat faces are cut exactly: along a row 1/z of a plane is an affine function of the column, so a convex polyhedron
/// is seen from the lowest back face to the lowest front face. Capsules and cylinders are cut pixel by pixel. Where two
/// surfaces are equally deep the shape with the lower index is seen. Shapes that the camera is in are not seen. Same
/// bytes at any number of threads.
[[nodiscard]] Cast cast(const Scene& scene, const CastView& view, int threads = 1);

/// Outward unit normal of what a pixel sees, in C; the pixel must see something.
[[nodiscard]] Vector3 normal_at(const Cast& cast, const Scene& scene, const CastView& view, int row, int col);

}  // namespace snug::camera
