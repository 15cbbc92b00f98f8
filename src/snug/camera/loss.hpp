// What part of the points near edges of depth and on grazing faces is lost: for the renderer, and for who reads frames.
#pragma once

#include <vector>

#include "snug/model/camera_params.hpp"

namespace snug::camera {

/// Probability that a point 1, 2, ... pixels from an edge of depth is lost (1: beside it); ends where it is below 0.5
/// %.
[[nodiscard]] std::vector<float> edge_loss(const model::PointLoss& loss);

/// Two pixels that are farther apart along the optical axis than their surfaces explain, m: an edge of depth. Chosen,
/// not measured on a camera. With half of it corners of boxes count as edges and do not bend (render_test), with twice
/// of it steps and steep ridges are none (borders_test).
inline constexpr double kEdgeOfDepth = 2.5e-3;

/// For which part of the places that a ridge can have between two pixels it is an edge of depth. The face behind it
/// is seen, `ridge` times less than from before (a tangent; 0: not at all); `step`: m between pixels.
[[nodiscard]] double edge_loss_at_ridge(double ridge, double step);

/// How many points are lost on faces that are seen from the side.
class GrazingLoss {
 public:
  explicit GrazingLoss(const model::PointLoss& loss);
  /// Probability under this cosine between normal and ray: none up to the onset, linear in the cosine from there.
  [[nodiscard]] float operator()(float cosine) const {
    if (cosine >= onset_) return 0.0F;
    return cosine <= full_ ? 1.0F : (onset_ - cosine) / (onset_ - full_);
  }

 private:
  float onset_, full_;  ///< cosines
};

}  // namespace snug::camera
