// Cloud: points of a file on their way into a camera's picture, and what may be wrong where they are not in it.
#include "snug/camera/internal/cloud.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "snug/camera/internal/file_parts.hpp"
#include "snug/core/input_error.hpp"

namespace snug::camera::internal {
namespace {

constexpr double kLeastPart = 0.02;     ///< of the points: with fewer in the picture the file is misread
constexpr double kPlausiblePart = 0.5;  ///< of the points: a reading with as many explains the file
constexpr double kBetterPart = 0.2;     ///< of the points: so many more, and another reading is meant
constexpr std::size_t kFewPoints = 50;  ///< so few tell nothing of how they are to be read
constexpr std::size_t kMostSamples = 4096;
constexpr double kMostOff = 3.0;  ///< px, mean: organised clouds of rectified cameras are off by less than one
constexpr std::array kUnits = {1.0, 1e-3, 1e-4, 1e-2, 1e-6};

std::string range_of(const model::CameraParams& camera) {
  return fmt::format("{} to {} m before the camera, its working range", camera.range.near, camera.range.far);
}

}  // namespace

void take_size(const FrameHints& hints, const CameraFile::Size& own, bool is_organised, model::CameraParams& camera,
               const std::string& name) {
  if (is_organised && hints.has_any_size) {
    camera.width = own.width;
    camera.height = own.height;
  }
  if (is_organised) return expect_size(camera, own.width, own.height, name);
  if (!hints.has_any_size) return;
  throw InputError(name, "size", "points without rows and columns, of a camera whose size nobody says",
                   "`width` and `height` in the camera's file");
}

Cloud::Cloud(const model::CameraParams& camera, const CloudReading& reading)
    : frame_{camera, Grid2<float>(camera.height, camera.width), {}}, reading_(reading), X_CW_(camera.X_WC.inverse()) {}

Vector3 Cloud::in_camera(const Vector3& raw, const CloudReading& reading) const {
  const Vector3 p = reading.unit * raw;
  return reading.is_in_camera ? Vector3(rotation_of(reading.axes).transpose() * p) : Vector3(X_CW_ * p);
}

bool Cloud::is_in_picture(const Vector3& p_C) const {
  if (!(usable(frame_.camera, p_C.z()) > 0.0F)) return false;
  const Eigen::Vector2d pixel = project(frame_.camera.intrinsics, p_C);
  return pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < frame_.camera.width - 0.5 &&
         pixel.y() < frame_.camera.height - 0.5;
}

void Cloud::add(const Vector3& raw, const Pixel& pixel) {
  if (!raw.allFinite() || raw.isZero()) return;  // organised clouds mark missing points so
  if (count_++ % stride_ == 0) samples_.push_back(raw);
  if (samples_.size() >= 2 * kMostSamples) {
    for (std::size_t i = 0; i < kMostSamples; ++i) samples_[i] = samples_[2 * i];
    samples_.resize(kMostSamples);
    stride_ *= 2;
  }
  const Vector3 p_C = in_camera(raw, reading_);
  const float depth = usable(frame_.camera, p_C.z());
  if (!(depth > 0.0F)) return;
  const Eigen::Vector2d seen = project(frame_.camera.intrinsics, p_C);
  const double row = pixel.is_said() ? pixel.row : std::round(seen.y());
  const double col = pixel.is_said() ? pixel.col : std::round(seen.x());
  if (!(row >= 0.0 && row < frame_.camera.height && col >= 0.0 && col < frame_.camera.width)) return;
  ++used_;
  if (pixel.is_said()) {
    off_ += std::min(1e3, std::hypot(seen.y() - row, seen.x() - col));
    ++said_;
  }
  float& there = frame_.depth(static_cast<int>(row), static_cast<int>(col));
  if (there == 0.0F || depth < there) there = depth;
}

double Cloud::part_in_picture(const CloudReading& reading) const {
  const auto count =
      std::ranges::count_if(samples_, [&](const Vector3& raw) { return is_in_picture(in_camera(raw, reading)); });
  return static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(1, samples_.size()));
}

std::string Cloud::find_better_reading() const {
  CloudReading best;
  double part = std::max(kPlausiblePart, part_in_picture(reading_) + kBetterPart);
  bool is_found = false;
  for (const double unit : kUnits) {
    for (const auto& [is_in_camera, axes] : {std::pair{false, Axes::Optical}, std::pair{true, Axes::Optical},
                                             std::pair{true, Axes::Ros}, std::pair{true, Axes::OpenGl}}) {
      const double with = part_in_picture({unit, is_in_camera, axes});
      if (with <= part) continue;
      part = with;
      best = {unit, is_in_camera, axes};
      is_found = true;
    }
  }
  if (!is_found) return {};
  return fmt::format("with coordinates in steps of {} m, in {}{}, {:.0f} % of them would be (--depth-unit {}{}{})",
                     best.unit, best.is_in_camera ? "the camera's frame" : "the world's frame",
                     best.is_in_camera ? fmt::format(", axes {}", name_of(best.axes)) : std::string(), 100.0 * part,
                     best.unit, best.is_in_camera ? " --points-in-camera" : "",
                     best.axes != Axes::Optical ? fmt::format(" --axes {}", name_of(best.axes)) : std::string());
}

std::string Cloud::place_of_points() const {
  std::vector<double> depths;
  for (const Vector3& raw : samples_) depths.push_back(in_camera(raw, reading_).z());
  std::ranges::nth_element(depths, depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2));
  const double middle = depths[depths.size() / 2];
  const model::CameraRange& range = frame_.camera.range;
  const char* why = middle <= 0.0         ? "behind the camera: its pose, or axes?"
                    : middle < range.near ? "too near"
                    : middle > range.far  ? "too far"
                                          : "beside the picture: the camera's pose, or its intrinsics?";
  return fmt::format("points {}, and in its picture; the middle one is {:.3g} m before the camera: {}",
                     range_of(frame_.camera), middle, why);
}

Frame Cloud::finish(const std::string& name) && {
  const bool is_empty = count_ >= kFewPoints && static_cast<double>(used_) < kLeastPart * static_cast<double>(count_);
  const bool is_off = said_ >= kFewPoints && off_ > kMostOff * static_cast<double>(said_);
  if (!is_empty && !is_off) return std::move(frame_);
  std::string would = find_better_reading();
  if (is_empty || !would.empty()) {
    if (would.empty()) would = place_of_points();
    throw InputError(name, "", fmt::format("{} of {} points in the camera's picture", used_, count_), would);
  }
  throw InputError(
      name, "",
      fmt::format("points that the camera would see {:.1f} px beside the pixels that the file says, on average",
                  off_ / static_cast<double>(said_)),
      "the intrinsics of the camera that took the frame, and its pose where points are in the world");
}

void expect_in_range(const model::CameraParams& camera, std::vector<double> depths, double unit,
                     const std::string& name) {
  const auto count_with = [&](double factor) {
    return static_cast<double>(
        std::ranges::count_if(depths, [&](double depth) { return usable(camera, factor * depth) > 0.0F; }));
  };
  const double used = count_with(1.0), all = static_cast<double>(depths.size());
  if (depths.size() < kFewPoints || used >= kLeastPart * all) return;
  std::ranges::nth_element(depths, depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2));
  const double middle = depths[depths.size() / 2];
  std::string would = fmt::format("depths {}; the middle one is {:.3g} m: {}", range_of(camera), middle,
                                  middle > camera.range.far ? "too far" : "too near");
  double part = kPlausiblePart;
  std::string other;
  for (const double factor : {1e-3, 1e3, 0.1, 10.0, 1e-4, 1e-6}) {
    const double with = count_with(factor) / all;
    if (with <= part) continue;
    part = with;
    other =
        fmt::format(", or steps of {:.9g} m (--depth-unit), with which it is {:.3g} m", factor * unit, factor * middle);
  }
  throw InputError(name, "", fmt::format("{:.0f} of {:.0f} points in the camera's working range", used, all),
                   would + other);
}

}  // namespace snug::camera::internal
