// CameraFile: what a file beside a frame says of the camera that took it: optics, unit, axes, pose.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "snug/model/camera_params.hpp"
#include "snug/model/scenario.hpp"

namespace snug::camera {

/// How the axes of a camera's frame lie, looking through it.
enum class Axes {
  Optical,  ///< z into the scene, x to the right, y down: frame C
  Ros,      ///< x into the scene, y to the left, z up
  OpenGl,   ///< z out of the scene, x to the right, y up
};
[[nodiscard]] const char* name_of(Axes axes);
/// Throws InputError, with `where`, for a word that is none of `name_of`.
[[nodiscard]] Axes axes_of(const std::string& word, const std::string& where);
/// Rotation of frame C in the camera's frame with those axes.
[[nodiscard]] Matrix3 rotation_of(Axes axes);

/// What is said; the rest is absent.
struct CameraFile {
  struct Size {
    int width = 0, height = 0;  ///< px
  };
  std::string name;
  std::optional<Size> size;
  std::optional<model::CameraIntrinsics> intrinsics;
  std::optional<Pose> X_WC;  ///< frame C, whatever `axes` says
  std::optional<model::CameraRange> range;
  std::optional<double> unit;  ///< m, of a step of grey or of a coordinate
  std::optional<Axes> axes;
  std::optional<bool> points_are_in_camera;
};

/// JSON or YAML: snug's own keys (docs/camera-frames.md), a ROS `camera_info` (message or calibration file), Open3D's
/// intrinsics, RealSense's. Throws InputError with line and key for what cannot be, for lenses that are not rectified
/// (a distortion that is not 0), and for keys that none of them has.
[[nodiscard]] CameraFile load_camera_file(const std::filesystem::path& path);
[[nodiscard]] CameraFile parse_camera_file(const std::string& text, const std::string& name);

/// The file that speaks for a frame: NAME.json, .yaml or .yml beside NAME.png, else camera.json, .yaml or .yml in the
/// same folder; none when there is none. Throws InputError where two could be meant.
[[nodiscard]] std::optional<std::filesystem::path> find_camera_file(const std::filesystem::path& frame);

/// The camera of a scenario that a user names; the first where none is named. Throws InputError for a scenario
/// (`source`) without cameras and for an unknown name.
[[nodiscard]] model::CameraParams choose_camera(const model::Scenario& scenario, const std::optional<std::string>& name,
                                                const std::string& source);

}  // namespace snug::camera
