// PathProfile: how far along a way the tool is at each time: as fast as limits that change along it allow, its jerk
// bounded.
#pragma once

#include <array>
#include <span>

namespace snug::motion {

inline constexpr int kPathParts = 32;  ///< equal parts of a way, each with limits of its own

/// How a motion is smoothed.
struct Smoothing {
  double window = 0.1;        ///< s, over which it is averaged
  double shaper_delay = 0.0;  ///< s, by which its second half comes later (zero-vibration shaper); 0: none
  bool operator==(const Smoothing&) const = default;
};

/// Share of a way from 0 to 1, from rest to rest: the fastest within a speed and an acceleration limit for each part,
/// then averaged over a moving window. The average keeps limits that are the same in all parts (near a lower one it has
/// the mean over the window), bounds the jerk by twice the largest acceleration limit over the window, and leaves
/// nothing of a vibration whose period fits into the window a whole number of times. With a zero-vibration input shaper
/// (two equal impulses; Singer and Seering, 1990) half of the motion follows later, which keeps all limits and leaves
/// nothing of a vibration of twice that delay either.
class PathProfile {
 public:
  /// No way: at its end from the beginning.
  PathProfile() = default;
  /// `rates`: largest speed in each part, 1/s, positive, may be infinite. `accelerations`: 1/s^2, the same, finite.
  /// The window is positive, the shaper's delay 0 or more (all checked).
  PathProfile(std::span<const double, kPathParts> rates, std::span<const double, kPathParts> accelerations,
              const Smoothing& smoothing);

  struct Sample {
    double share = 1.0;
    double rate = 0.0;  ///< 1/s
  };
  /// t is clamped to [0, duration]; exactly 1 and at rest from the end on.
  [[nodiscard]] Sample sample(double t) const noexcept;
  [[nodiscard]] double duration() const noexcept { return time_.back() + smoothing_.window + smoothing_.shaper_delay; }

  bool operator==(const PathProfile&) const = default;

 private:
  struct Raw {
    double share = 0.0;
    double area = 0.0;  ///< integral of the share over time, s
  };
  [[nodiscard]] Raw raw(double t) const noexcept;
  [[nodiscard]] Sample averaged(double t) const noexcept;

  // At the ends of the parts, before averaging: s, 1/s, s.
  std::array<double, kPathParts + 1> time_{}, rate_{}, area_{};
  Smoothing smoothing_{0.0, 0.0};
};

}  // namespace snug::motion
