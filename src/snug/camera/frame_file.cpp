// load_frame: which format a file has, and what all have in common.
#include "snug/camera/frame_file.hpp"

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

Frame load_frame(const std::filesystem::path& path, const FrameHints& hints) {
  const std::string expected = "a frame (PNG, PLY or HDF5)";
  const std::string bytes = read_file(path, expected, internal::kLargestFile);
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return internal::read_png(bytes, path.string(), hints);
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r\n"))
    return internal::read_ply(bytes, path.string(), hints);
  if (bytes.starts_with("\x89HDF\r\n\x1a\n")) return internal::read_h5(path, hints);
  throw InputError(path.string(), "", "a file that begins like none of them", expected);
}

}  // namespace snug::camera
