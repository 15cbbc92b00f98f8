// Frame: what a depth camera gives, and, beside it, what is true.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snug/camera/grid.hpp"
#include "snug/model/camera_params.hpp"

namespace snug::camera {

struct Frame {
  model::CameraParams camera;     ///< pose and optics as they are believed to be
  Grid2<float> depth;             ///< m along the optical axis; 0: no point
  Grid2<std::uint8_t> intensity;  ///< 0 .. 255; empty where the camera gave none
  bool operator==(const Frame&) const = default;
};

/// Known of simulated frames only; no estimator reads it.
struct FrameTruth {
  Pose X_WC;                       ///< where the camera really is
  Grid2<float> depth;              ///< m, without errors; 0: nothing there
  Grid2<std::int16_t> label;       ///< index into names; -1: nothing there
  std::vector<std::string> names;  ///< of the bodies
  std::vector<Pose> X_WB;          ///< where they are
};

struct RenderedFrame {
  Frame frame;
  FrameTruth truth;
};

/// Direction of the ray through a pixel in C, with z = 1.
[[nodiscard]] inline Vector3 pixel_ray(const model::CameraIntrinsics& optics, double col, double row) {
  return {(col - optics.cx) / optics.fx, (row - optics.cy) / optics.fy, 1.0};
}

/// Column and row of a point before the camera (z > 0).
[[nodiscard]] inline Eigen::Vector2d project(const model::CameraIntrinsics& optics, const Vector3& p_C) {
  return {optics.cx + optics.fx * p_C.x() / p_C.z(), optics.cy + optics.fy * p_C.y() / p_C.z()};
}

}  // namespace snug::camera
