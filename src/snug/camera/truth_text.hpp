// What is true of a rendered frame, as JSON: where the camera and the bodies are, and what is seen of each.
#pragma once

#include <string>

#include "snug/camera/render.hpp"

namespace snug::camera {

/// Pixels that have a depth.
[[nodiscard]] int count_points(const Frame& frame);
/// `time`: s, of the scene; `indent`: blanks of a level. The keys are those of docs/camera.md.
[[nodiscard]] std::string format_truth(const RenderedFrame& shot, double time, int indent);

}  // namespace snug::camera
