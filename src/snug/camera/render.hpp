// render: a frame of a scene as a depth camera with errors would give it, and what is true.
#pragma once

#include <cstdint>

#include "snug/camera/frame.hpp"
#include "snug/camera/scene.hpp"
#include "snug/core/rng.hpp"

namespace snug::camera {

/// The errors that stay the same for one camera: drawn from what its maker states.
struct CameraDraw {
  Pose X_CD;                    ///< from where the camera is believed to be to where it is
  double scale = 0.0;           ///< of lengths, as a fraction: what it says is (1 + scale) times what is
  std::uint64_t wave_seed = 0;  ///< of its global waves
};

/// The camera of a seed. A camera of the same name and seed is the same one.
[[nodiscard]] CameraDraw draw_camera(const model::CameraParams& camera, std::uint64_t seed);

/// One shot. `shot` tells the noise of one frame from that of another. Same bytes at any number of threads.
[[nodiscard]] RenderedFrame render(const Scene& scene, const model::CameraParams& camera, const CameraDraw& draw,
                                   std::uint64_t shot, int threads = 1);

}  // namespace snug::camera
