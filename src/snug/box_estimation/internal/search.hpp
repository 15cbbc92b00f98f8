// propose_poses: where boxes may be that are not where they were believed to be, from flat patches of points.
#pragma once

#include "snug/box_estimation/internal/view.hpp"

namespace snug::box_estimation::internal {

/// What is known of a frame when boxes are searched in it.
struct Known {
  FitContext context;
  const EstimateInput& input;
  const std::vector<TrackedBox>& boxes;  ///< tracked: they stay where they are
  double tolerance = 0.0;                ///< m, of points from the faces of a fitted box
};

/// A box that is searched.
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

/// m, between a box and the nearest of the solids, at most `touch`; negative: so deep in one of them.
[[nodiscard]] double least_gap(const Vector3& half, const Pose& X_CP, const std::vector<camera::SceneShape>& solids_C,
                               double touch);

}  // namespace snug::box_estimation::internal
