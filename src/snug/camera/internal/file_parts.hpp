// Readers and writers of the single formats.
#pragma once

#include <string>
#include <vector>

#include "snug/camera/frame_file.hpp"

namespace snug::camera::internal {

inline constexpr int kLargestSide = 8192;  ///< px
inline constexpr std::size_t kLargestFile = std::size_t{1} << 30U;

[[nodiscard]] Frame read_png(const std::string& bytes, const std::string& name, const FrameHints& hints);
[[nodiscard]] Frame read_ply(const std::string& bytes, const std::string& name, const FrameHints& hints);
[[nodiscard]] Frame read_pcd(const std::string& bytes, const std::string& name, const FrameHints& hints);
[[nodiscard]] Frame read_h5(const std::filesystem::path& path, const FrameHints& hints);

/// Throws unless the picture has the size that the camera says.
void expect_size(const model::CameraParams& camera, int cols, int rows, const std::string& name);
/// May a frame of a file of so many bytes have so many pixels? A picture of nothing is packed a thousandfold.
[[nodiscard]] constexpr bool has_room(std::size_t pixels, std::size_t file_bytes) {
  constexpr std::size_t kPixelBytes = 6;  // as they are read, and as a frame has them
  return pixels * kPixelBytes <= 16 * file_bytes + 32'000'000;
}
/// `depth` where it is a point within the working range, else 0.
[[nodiscard]] float usable(const model::CameraParams& camera, double depth);

/// Throws unless a fair part of the depths of a picture, m, can be of the camera. `unit`: m, of its steps.
void expect_in_range(const model::CameraParams& camera, std::vector<double> depths, double unit,
                     const std::string& name);

}  // namespace snug::camera::internal
