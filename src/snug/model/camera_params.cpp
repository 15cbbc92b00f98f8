// Camera presets: two classes of depth cameras, with errors of the size that makers of such cameras state.
#include "snug/model/camera_params.hpp"

#include <numbers>

#include "snug/core/check.hpp"

namespace snug::model {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Estimates of the class of a structured-light camera with 754 mm x 449 mm in view at 0.7 m, every second point: point
/// precision, planarity and dimension trueness in the middle of what such makers state (docs/camera.md).
CameraParams make_structured_light() {
  CameraParams camera;
  camera.range = {0.3, 1.5, 0.9};
  camera.p_CL = Vector3(-0.11, 0.0, 0.0);
  camera.errors.noise = {0.15e-3, 0.6};
  camera.errors.planarity = {0.08e-3, 12.0, 0.15e-3, 180.0};
  camera.errors.trueness = {0.8e-3, 0.15e-3};
  camera.errors.loss = {0.002, 0.7, 1.0, 75.0 * kDegree, 86.0 * kDegree};
  camera.errors.mixed_pixels = {0.15};
  camera.errors.interreflection = {0.5e-3, 0.015};
  camera.errors.hand_eye = {0.25e-3, 0.02 * kDegree};
  return camera;
}

/// Estimates of an active stereo camera of a tenth of the price: noise of 2 to 3 mm at 0.9 m that is alike over several
/// pixels, blurred edges, a wide field of view.
CameraParams make_active_stereo() {
  CameraParams camera;
  camera.width = 848;
  camera.height = 480;
  camera.intrinsics = {600.0, 600.0, 423.5, 239.5};
  camera.range = {0.3, 3.0, 0.9};
  camera.p_CL = Vector3(-0.05, 0.0, 0.0);
  camera.errors.noise = {2.0e-3, 1.5};
  camera.errors.planarity = {1.0e-3, 16.0, 1.2e-3, 120.0};
  camera.errors.trueness = {4.0e-3, 1.0e-3};
  camera.errors.loss = {0.01, 0.5, 2.0, 65.0 * kDegree, 82.0 * kDegree};
  camera.errors.mixed_pixels = {0.5};
  camera.errors.interreflection = {1.0e-3, 0.015};
  camera.errors.hand_eye = {1.0e-3, 0.05 * kDegree};
  return camera;
}

}  // namespace

std::vector<std::string> camera_presets() { return {"structured_light", "active_stereo", "ideal"}; }

CameraParams make_camera(const std::string& preset) {
  if (preset == "structured_light") return make_structured_light();
  if (preset == "active_stereo") return make_active_stereo();
  SNUG_CHECK(preset == "ideal", "a preset of camera_presets()");
  CameraParams camera;
  camera.errors.loss.grazing_onset = camera.errors.loss.grazing_full = 89.9 * kDegree;
  return camera;
}

}  // namespace snug::model
