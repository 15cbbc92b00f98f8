// The cell as it is now, served by another program, for a picture of it.
#pragma once

#include "apps/snug/camera/camera.hpp"
#include "snug/camera/scene.hpp"

namespace snug::app {

/// What a camera has before it, and what it is.
struct CameraView {
  model::Scenario scenario;
  camera::Scene scene;
  double time = 0.0;       ///< s
  std::uint64_t seed = 0;  ///< of the cell
};

/// Of a cell that is served over CLICK: boxes where and as large as its sensors say, the rest as in the scenario.
/// Throws InputError where there is none.
[[nodiscard]] CameraView look_at_served(const CameraOptions& options);

}  // namespace snug::app
