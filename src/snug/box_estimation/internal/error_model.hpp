// ErrorModel: what the camera's stated errors mean for planes and edges that are fitted to its points.
#pragma once

#include "snug/camera/common_error.hpp"
#include "snug/model/camera_params.hpp"

namespace snug::box_estimation::internal {

class ErrorModel {
 public:
  explicit ErrorModel(const model::CameraParams& camera);

  /// Standard deviation of one point along the optical axis at this depth, without what its neighbours share, m.
  [[nodiscard]] double point_noise(double depth) const;
  /// The same with waves: how far a point may be from where it should be, m.
  [[nodiscard]] double point_error(double depth) const;
  /// By how much the variance of a mean of many neighbouring points is larger than if they were independent.
  [[nodiscard]] double likeness() const { return likeness_; }
  /// Covariance of the waves at two pixels, m^2.
  [[nodiscard]] double wave_covariance(double dcol, double drow) const;
  /// Standard deviation of a length, m.
  [[nodiscard]] double length_error(double length) const { return camera_.errors.trueness.dimension * length; }
  /// How many pixels of a face are missing, on average, at each crossing of an edge of depth.
  [[nodiscard]] double edge_shift() const { return edge_shift_; }
  /// Error [translation; rotation] in C of a pose at p_CP that comes from the camera's own place and scale: times seven
  /// standard normals, the same for all poses.
  [[nodiscard]] camera::CommonError common_error(const Vector3& p_CP) const;

 private:
  model::CameraParams camera_;
  double likeness_ = 1.0, edge_shift_ = 0.0;
};

}  // namespace snug::box_estimation::internal
