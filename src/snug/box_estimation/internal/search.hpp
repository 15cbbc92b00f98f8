// find_boxes: boxes that are not where they were believed to be, from flat patches that nothing else explains.
#pragma once

#include <optional>

#include "snug/box_estimation/internal/view.hpp"

namespace snug::box_estimation::internal {

/// A box that is looked for.
struct Wanted {
  int box = 0;  ///< index of the caller
  Vector3 half = Vector3::Zero();
  Pose X_CP_prior;
};

struct FoundBox {
  int wanted = 0;  ///< index into the list
  Pose X_CP;
  double score = 0.0;
};

/// Points before what is predicted: 1 where something stands that the prediction does not have.
[[nodiscard]] camera::Grid2<std::uint8_t> unexplained(const camera::Frame& frame, const Prediction& prediction,
                                                      double tolerance);

/// The best poses for wanted boxes, each box at most once, the surest first. Poses are rough: some millimetres. A box
/// stands on one of `solids_C` and in none of them.
[[nodiscard]] std::vector<FoundBox> find_boxes(const camera::Frame& frame, const Prediction& prediction,
                                               const camera::Grid2<std::uint8_t>& unexplained_points,
                                               const std::vector<Wanted>& wanted,
                                               const std::vector<camera::SceneShape>& solids_C,
                                               const ErrorModel& errors);

}  // namespace snug::box_estimation::internal
