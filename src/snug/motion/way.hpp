// Way: where the tool passes from one pose to another: straight, or around the robot's first axis, which then turns
// evenly.
#pragma once

#include <optional>

#include "snug/spatial/pose.hpp"

namespace snug::motion {

/// A robot's first axis, where that is vertical.
struct PanAxis {
  Vector3 p_WB = Vector3::Zero();  ///< m, on it
  double least_pan = 0.2;          ///< rad, a way that turns it less goes straight
  double least_radius = 0.20;      ///< m, as one that begins or ends nearer to it
  bool operator==(const PanAxis&) const = default;
};

/// Share 0: at the first pose, 1: at the second.
class Way {
 public:
  /// No way, at the identity.
  Way() = default;
  /// A straight line and a turn about a fixed axis, the shorter way round. Finite poses (checked).
  Way(const Pose& X_WA, const Pose& X_WB) : Way(X_WA, X_WB, std::nullopt) {}
  /// Where the way turns the axis far enough, and both ends are far enough away from it, radius, height and angle about
  /// the axis change evenly along the way, and the turn beyond that angle is about an axis that is carried along. Else,
  /// and without an axis: straight.
  Way(const Pose& X_WA, const Pose& X_WB, const std::optional<PanAxis>& pan_axis);

  [[nodiscard]] Pose at(double share) const noexcept;
  /// Derivatives by the share: of where E is, and of how it is turned (in W).
  struct Slope {
    Twist first;
    Twist second;
  };
  [[nodiscard]] Slope slope(double share) const noexcept;
  /// From the first pose: turn and shift in W, so that the way can be put on top of another that ends there.
  [[nodiscard]] Pose increment(double share) const noexcept;

  [[nodiscard]] const Pose& start() const noexcept { return X_WA_; }
  [[nodiscard]] const Pose& end() const noexcept { return X_WB_; }
  /// Whether it is longer, or turns further, than what poses are rounded by (1e-9 m or rad).
  [[nodiscard]] bool is_motion() const noexcept;
  [[nodiscard]] bool is_straight() const noexcept { return pan_ == 0.0; }
  /// rad, about the robot's first axis; 0 of a straight way.
  [[nodiscard]] double pan() const noexcept { return pan_; }

  bool operator==(const Way&) const = default;

 private:
  [[nodiscard]] Vector3 shift(double share) const noexcept;

  Pose X_WA_, X_WB_;
  Vector3 line_W_ = Vector3::Zero();  ///< m, from the first to the second
  Vector3 turn_W_ = Vector3::Zero();  ///< rad, rotation vector of the turn beyond the pan, at the first pose
  double pan_ = 0.0;
  Vector3 p_WB_ = Vector3::Zero();
  double radius_ = 0.0, radius_gain_ = 0.0, azimuth_ = 0.0;  ///< m, m, rad: of the first pose about the axis
};

/// rad, in (-pi, pi]: how far the first, vertical axis of a robot at `p_WB` turns on the way of the tool.
[[nodiscard]] double pan_between(const Vector3& p_WB, const Vector3& p_W_from, const Vector3& p_W_to);

}  // namespace snug::motion
