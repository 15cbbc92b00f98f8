// propose_poses: where boxes may be that are not where they were believed to be, from flat patches of points.
#pragma once

#include "snug/box_estimation/internal/view.hpp"

namespace snug::box_estimation::internal {

/// What is known of a frame when boxes are looked for in it.
struct Known {
  const camera::Frame& frame;
  const EstimateInput& input;
  const PixelRange& range;
  const camera::Scene& surroundings_C;
  const std::vector<TrackedBox>& boxes;  ///< tracked: they stay where they are
  const ErrorModel& errors;
  double tolerance = 0.0;  ///< m, of points from the faces of a fitted box
};

/// A box that is looked for.
struct Wanted {
  Vector3 half = Vector3::Zero();
  Pose X_CP_prior;
};

/// Points before what is predicted: 1 where something stands that the prediction does not have.
[[nodiscard]] camera::Grid2<std::uint8_t> unexplained(const camera::Frame& frame, const Prediction& prediction,
                                                      double tolerance);

/// For each wanted box rough poses, some millimetres off, the likeliest first. `prediction`: of what is known.
[[nodiscard]] std::vector<std::vector<Pose>> propose_poses(const Known& known, const Prediction& prediction,
                                                           const std::vector<Wanted>& wanted,
                                                           const std::vector<camera::SceneShape>& solids_C);

/// Beyond this gap things do not touch, m.
inline constexpr double kTouch = 0.006;
/// m, between a box and the nearest of the solids, at most kTouch; negative: so deep in one of them.
[[nodiscard]] double least_gap(const Vector3& half, const Pose& X_CP, const std::vector<camera::SceneShape>& solids_C);

}  // namespace snug::box_estimation::internal
