// load_frame: which format a file has, and what all have in common.
#include "snug/camera/frame_file.hpp"

#include <string_view>

#include "snug/camera/internal/file_parts.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"

namespace snug::camera {
namespace internal {

void expect_size(const model::CameraParams& camera, int cols, int rows, const std::string& name) {
  if (cols == camera.width && rows == camera.height) return;
  throw InputError(name, "size", std::to_string(cols) + " x " + std::to_string(rows) + " pixels",
                   std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                       ", the camera's; give the scenario's camera that `resolution` and its intrinsics");
}

float usable(const model::CameraParams& camera, double depth) {
  return depth >= camera.range.near && depth <= camera.range.far ? static_cast<float>(depth) : 0.0F;
}

}  // namespace internal

namespace {

/// Does the file tell of its camera itself, as those of snug do? They say so before their points.
bool says_camera(const std::string& bytes) {
  constexpr std::size_t kBegin = 8192;
  return bytes.starts_with("\x89HDF") ||
         std::string_view(bytes).substr(0, kBegin).find("snug-camera") != std::string_view::npos;
}

void apply(const CameraFile& file, FrameHints& hints) {
  if (!file.name.empty()) hints.camera.name = file.name;
  if (file.intrinsics) hints.camera.intrinsics = *file.intrinsics;
  if (file.size) {
    hints.camera.width = file.size->width;
    hints.camera.height = file.size->height;
  }
  hints.has_any_size = file.intrinsics && !file.size;
  if (file.X_WC) hints.camera.X_WC = *file.X_WC;
  if (file.range) hints.camera.range = *file.range;
  if (file.unit && !hints.depth_unit) hints.depth_unit = file.unit;
  if (file.axes) hints.axes = *file.axes;
  if (file.points_are_in_camera) hints.points_are_in_camera = *file.points_are_in_camera;
}

FrameHints complete(const FrameHints& given, const std::filesystem::path& path, const std::string& bytes) {
  FrameHints hints = given;
  std::optional<std::filesystem::path> file = given.camera_file;
  if (!file && !given.camera_is_given && !says_camera(bytes)) file = find_camera_file(path);
  if (!file) return hints;
  apply(load_camera_file(*file), hints);
  hints.camera_is_given = true;
  return hints;
}

}  // namespace

Frame load_frame(const std::filesystem::path& path, const FrameHints& given) {
  const std::string expected = "a frame (PNG, PLY, PCD or HDF5)";
  const std::string bytes = read_file(path, expected, internal::kLargestFile);
  const bool is_png = bytes.starts_with("\x89PNG\r\n\x1a\n"), is_h5 = bytes.starts_with("\x89HDF\r\n\x1a\n");
  const bool is_ply = bytes.starts_with("ply\n") || bytes.starts_with("ply\r\n");
  const bool is_pcd = bytes.starts_with("# .PCD") || bytes.starts_with("VERSION");
  if (!is_png && !is_h5 && !is_ply && !is_pcd)
    throw InputError(path.string(), "", "a file that begins like none of them", expected);
  const FrameHints hints = complete(given, path, bytes);
  if (is_png) return internal::read_png(bytes, path.string(), hints);
  if (is_ply) return internal::read_ply(bytes, path.string(), hints);
  if (is_pcd) return internal::read_pcd(bytes, path.string(), hints);
  return internal::read_h5(path, hints);
}

}  // namespace snug::camera
