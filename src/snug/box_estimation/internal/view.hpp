// View: a frame beside what would be seen if the boxes were where they are thought to be.
#pragma once

#include <optional>
#include <vector>

#include "snug/box_estimation/estimate.hpp"
#include "snug/box_estimation/internal/error_model.hpp"
#include "snug/camera/cast.hpp"

namespace snug::box_estimation::internal {

/// A box that takes part in the fit.
struct TrackedBox {
  Vector3 half = Vector3::Zero();  ///< m
  Pose X_CP;
  Pose X_CP_prior;
  Matrix6 prior_information = Matrix6::Zero();  ///< in C, translation first
};

/// Rectangle of pixels.
struct PixelRange {
  int first_row = 0, end_row = 0, first_col = 0, end_col = 0;
  [[nodiscard]] int rows() const { return end_row - first_row; }
  [[nodiscard]] int cols() const { return end_col - first_col; }
};

/// What a fit is made in.
struct FitContext {
  const camera::Frame& frame;
  const PixelRange& range;
  const camera::Scene& surroundings_C;  ///< with poses in C
  const ErrorModel& errors;
  const EstimatorSettings& settings;
};

/// The pixels in which points of a box in W (corners low and high) can be seen.
[[nodiscard]] PixelRange pixel_range(const model::CameraParams& camera, const Vector3& low, const Vector3& high);
/// Those in which a box can be seen, with `border` pixels around, within `range`.
[[nodiscard]] PixelRange pixels_around(const camera::Frame& frame, const PixelRange& range, const TrackedBox& box,
                                       int border);

/// What is seen of surroundings and tracked boxes. Bodies: first the surroundings', then the boxes in their order.
struct Prediction {
  camera::Cast cast;  ///< of the pixels of `range`
  PixelRange range;
  int first_box = 0;  ///< body of box 0
};
[[nodiscard]] Prediction predict(const camera::Frame& frame, const PixelRange& range,
                                 const camera::Scene& surroundings_C, const std::vector<TrackedBox>& boxes);
/// The surroundings with poses in C.
[[nodiscard]] camera::Scene in_camera(const camera::Scene& scene, const Pose& X_WC);

/// How the points in the pixels of one box compare with it.
struct Agreement {
  int pixels = 0;        ///< where it should be seen
  int on = 0;            ///< points that lie on it
  int nearer = 0;        ///< points before it
  int farther = 0;       ///< points behind it: seen through
  int missing = 0;       ///< no point
  double squares = 0.0;  ///< m^2, of the distances of points that lie on it
  /// Of the points that tell whether it is there: what is before it may be anything.
  [[nodiscard]] double part_on() const { return on > 0 ? static_cast<double>(on) / (on + farther) : 0.0; }
};
/// `tolerances`: m, of each box's points from its faces.
[[nodiscard]] std::vector<Agreement> compare(const camera::Frame& frame, const Prediction& prediction,
                                             const std::vector<double>& tolerances);

/// m, how deep two boxes are in each other, along the direction of least depth; 0: apart.
[[nodiscard]] double overlap(const TrackedBox& a, const TrackedBox& b);

/// m, by which a point of this depth is before the surface that is predicted in cell (r, c) of the prediction, along
/// its outward normal; negative: behind it.
[[nodiscard]] double distance_outward(const Prediction& prediction, std::int32_t surface, int r, int c, double depth);

/// Points in `range` that are not where they should be: farther than `tolerance` from what is predicted there, along
/// its normal. `range`: within that of the prediction.
[[nodiscard]] int disagreeing(const camera::Frame& frame, const Prediction& prediction, const PixelRange& range,
                              double tolerance);

}  // namespace snug::box_estimation::internal
