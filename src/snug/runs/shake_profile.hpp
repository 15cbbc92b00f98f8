// ShakeProfile: what a container with its load is driven with: accelerations and tilts over time.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::runs {

/// Between two samples everything goes straight from one to the other.
struct ShakeSample {
  double time = 0.0;                         ///< s, from 0, rising
  Vector3 acceleration_T = Vector3::Zero();  ///< m/s^2, of the container, along its own axes
  double roll = 0.0, pitch = 0.0;            ///< rad, tilts about Tx and Ty; slow: the weight turns, nothing else
  bool operator==(const ShakeSample&) const = default;
};

/// One motion, from a load at rest.
struct ShakeMotion {
  std::string name;  ///< "brake 0.80 g, +x"
  std::vector<ShakeSample> samples;
  [[nodiscard]] double duration() const { return samples.empty() ? 0.0 : samples.back().time; }
  [[nodiscard]] ShakeSample at(double time) const;
  bool operator==(const ShakeMotion&) const = default;
};

struct ShakeProfileOptions {
  double level = 0.5;           ///< g, of eumos40509 and tilt: the tilt is the angle whose tangent this is
  Vector3 size{0.4, 0.3, 0.2};  ///< m, of the container: the longer level side looks forward
};

/// conveyor: a belt at 0.5 m/s that starts with 2 m/s^2, stops with 2 and, in an emergency, with 5, along each axis.
/// truck: 0.8 g forward, 0.5 g to the rear and to either side for a second each (EN 12195-1, road). eumos40509: `level`
/// to all four sides for 0.3 s with ramps of 50 ms. tilt: slowly to the angle of `level`, to all four sides.
[[nodiscard]] std::vector<std::string> shake_profile_names();
/// Throws InputError for a name that is not one of these.
[[nodiscard]] std::vector<ShakeMotion> make_shake_profile(std::string_view name, const ShakeProfileOptions& options);

/// One motion of a CSV: a head with time_s and any of ax, ay, az (m/s^2, of the container along its axes), roll_deg and
/// pitch_deg (tilts about Tx, Ty), then a line each. Throws InputError with file and line.
[[nodiscard]] std::vector<ShakeMotion> load_shake_profile(const std::filesystem::path& path);
[[nodiscard]] std::vector<ShakeMotion> parse_shake_profile(std::string_view text, const std::string& name);

}  // namespace snug::runs
