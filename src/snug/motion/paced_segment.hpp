// PacedSegment: a motion along a way, from rest to rest, as fast as tool, held box and joints allow.
#pragma once

#include <span>

#include "snug/motion/path_profile.hpp"
#include "snug/motion/tool_path.hpp"
#include "snug/motion/way.hpp"

namespace snug::motion {

/// What else than the tool's own limits bounds the motion along a way: the joints.
class PathLimits {
 public:
  PathLimits() = default;
  PathLimits(const PathLimits&) = delete;
  PathLimits& operator=(const PathLimits&) = delete;
  virtual ~PathLimits() = default;
  /// Lowers the largest share of the way per second, and per second squared, in each of as many equal parts.
  virtual void limit(const Way& way, std::span<double> rates, std::span<double> accelerations) const noexcept = 0;
};

/// Limits of one segment. SI units.
struct Pace {
  double max_speed = 1.0;              ///< m/s
  double max_acceleration = 4.0;       ///< m/s^2
  double max_turn_speed = 2.5;         ///< rad/s
  double max_turn_acceleration = 5.0;  ///< rad/s^2
  double window = 0.1;                 ///< s, over which the motion is averaged (Smoothing)
  double shaper_delay = 0.0;           ///< s, by which half of it comes later (Smoothing)
  /// So many times the acceleration limits may go into the average where no more than the limits comes out: on ways
  /// that are never faster than the limits times the window.
  double before_average = 4.0;
  bool operator==(const Pace&) const = default;
};

class PacedSegment {
 public:
  /// No motion, duration 0, at the identity.
  PacedSegment() = default;
  /// Limits must be positive (checked). `others`: not kept; none: nothing else limits.
  PacedSegment(const Way& way, const Pace& pace, const PathLimits* others);

  [[nodiscard]] double duration() const noexcept { return profile_.duration(); }
  /// Exactly `end` and at rest from the duration on.
  [[nodiscard]] ToolState sample(double t) const noexcept;
  /// What the motion is beyond `start` at t, to be put on top of another motion that ends there: turn and shift in W,
  /// and twist.
  struct Increment {
    Matrix3 R_W = Matrix3::Identity();
    Vector3 shift_W = Vector3::Zero();
    Twist V_W;
  };
  [[nodiscard]] Increment increment(double t) const noexcept;
  [[nodiscard]] const Pose& start() const noexcept { return way_.start(); }
  [[nodiscard]] const Pose& end() const noexcept { return way_.end(); }
  /// Unit, in W, from start to end; zero without a translation.
  [[nodiscard]] Vector3 direction_W() const noexcept;

  bool operator==(const PacedSegment&) const = default;

 private:
  Way way_;
  PathProfile profile_;
};

}  // namespace snug::motion
