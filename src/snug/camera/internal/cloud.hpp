// Cloud: points of a file on their way into a camera's picture, and what may be wrong where they are not in it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snug/camera/frame_file.hpp"

namespace snug::camera::internal {

/// A pixel that a file says for a point, or none.
struct Pixel {
  double row = -1.0, col = -1.0;
  [[nodiscard]] bool is_said() const { return row >= 0.0; }
};

/// Of the point at that place of an organised cloud, row by row.
[[nodiscard]] inline Pixel pixel_of(std::size_t place, const model::CameraParams& camera) {
  const auto width = static_cast<std::size_t>(camera.width);
  return {static_cast<double>(place / width), static_cast<double>(place % width)};
}
/// The camera's size is that of an organised cloud where nobody says it. Throws InputError where it is not known, and
/// where an organised cloud has another one.
void take_size(const FrameHints& hints, const CameraFile::Size& own, bool is_organised, model::CameraParams& camera,
               const std::string& name);

/// What the numbers of a file are.
struct CloudReading {
  double unit = 1.0;  ///< m
  bool is_in_camera = false;
  Axes axes = Axes::Optical;
};

/// Puts points into the picture, the nearest of those that fall on one pixel.
class Cloud {
 public:
  Cloud(const model::CameraParams& camera, const CloudReading& reading);
  /// As the file has it; what is not finite is no point.
  void add(const Vector3& raw, const Pixel& pixel);
  /// Throws InputError where next to none of the points is in the picture, with the reading that would put them there,
  /// and where pixels that the file says are not those at which the camera would have seen its points.
  [[nodiscard]] Frame finish(const std::string& name) &&;

 private:
  [[nodiscard]] Vector3 in_camera(const Vector3& raw, const CloudReading& reading) const;
  [[nodiscard]] bool is_in_picture(const Vector3& p_C) const;
  [[nodiscard]] double part_in_picture(const CloudReading& reading) const;
  /// Empty, or the reading with which far more of the points would be in the picture.
  [[nodiscard]] std::string find_better_reading() const;
  [[nodiscard]] std::string place_of_points() const;

  Frame frame_;
  CloudReading reading_;
  Pose X_CW_;
  std::size_t count_ = 0, used_ = 0;
  std::vector<Vector3> samples_;  ///< every so many points, raw
  std::size_t stride_ = 1;
  double off_ = 0.0;  ///< px, sum of how far said pixels are from where the points are seen
  std::size_t said_ = 0;
};

}  // namespace snug::camera::internal
