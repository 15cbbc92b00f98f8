// What part of the points near edges of depth and on grazing faces is lost: for the renderer, and for who reads frames.
#pragma once

#include <vector>

#include "snug/model/camera_params.hpp"

namespace snug::camera {

/// Probability that a point 1, 2, ... pixels from an edge of depth is lost (1: beside it); ends where it is below 0.5 %.
[[nodiscard]] std::vector<float> edge_loss(const model::PointLoss& loss);

/// Probability that a point is lost whose surface is seen under this cosine between normal and ray.
[[nodiscard]] float grazing_loss(const model::PointLoss& loss, float cosine);

}  // namespace snug::camera
