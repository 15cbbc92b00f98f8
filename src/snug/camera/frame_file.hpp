// Files of frames: PNG (16 bit, a tenth of a millimetre each), PLY (points), HDF5 (everything, with the truth); and PCD
// of others.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "snug/camera/camera_file.hpp"
#include "snug/camera/frame.hpp"
#include "snug/core/output_file.hpp"

namespace snug::camera {

/// m, of a step of the grey values in PNGs written here.
inline constexpr double kPngUnit = 1e-4;

/// Depth as 16-bit grey; camera (pose, optics) as JSON in the text chunk "snug-camera".
[[nodiscard]] std::string format_png(const Frame& frame);
/// Intensity as 8-bit grey, and labels (index + 1; 0: nothing) as 16-bit grey.
[[nodiscard]] std::string format_intensity_png(const Frame& frame);
[[nodiscard]] std::string format_label_png(const FrameTruth& truth);
/// Points in W (double precision would be false: float), intensity, and, with the truth, the label; binary, little
/// endian. Row and column stand beside each point, so that the frame can be read back.
[[nodiscard]] std::string format_ply(const Frame& frame, const FrameTruth* truth);
/// Datasets depth, intensity, truth/depth, truth/label, truth/poses; camera as JSON in the attribute "camera". Writes
/// to the draft of `file`; the caller publishes.
void write_h5(OutputFile& file, const Frame& frame, const FrameTruth* truth);

/// How to read a picture that does not say it itself.
struct FrameHints {
  model::CameraParams camera;         ///< pose and optics; their size must be that of the picture
  std::optional<double> depth_unit;   ///< m, of a step of grey; absent: what the file says, else 1 mm
  bool camera_is_given = false;       ///< use `camera` even where the file says another
  bool points_are_in_camera = false;  ///< PLY, PCD: points in the camera's frame instead of W
  Axes axes = Axes::Optical;          ///< of the camera's frame in which such points are
  bool has_any_size = false;          ///< the picture says how large it is
  /// What is said there of the camera (camera_file.hpp) stands for `camera`, whatever the frame says.
  std::optional<std::filesystem::path> camera_file = {};
};

/// Reads PNG, PLY, PCD or HDF5, by the file's first bytes. A frame that does not say its camera itself is taken with
/// what a file beside it says (find_camera_file), else with `hints`. Points outside the camera's working range are left
/// out. Throws InputError for anything that cannot be: truncated, absurd sizes, numbers that are not finite where they
/// must be; and, with what would help, where next to no point is one that the camera can have seen: another unit,
/// other axes, points of another frame, too near, too far.
[[nodiscard]] Frame load_frame(const std::filesystem::path& path, const FrameHints& hints);

/// Pose, optics and size as one line of JSON, and back.
[[nodiscard]] std::string format_camera(const model::CameraParams& camera);
/// Takes what the text says into `camera`. Throws InputError with `name`.
void parse_camera(const std::string& text, const std::string& name, model::CameraParams& camera);

}  // namespace snug::camera
