// LspbSegment: straight line and fixed-axis turn with trapezoidal speeds, report section 2.3.1 (eqs 4-11).
#pragma once

#include "snug/motion/limits.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::motion {

/// Trapezoidal profile of a travelled length sigma(t), report eqs (9)-(11); linear deceleration in (10), where the
/// printed square is a slip. Units: m or rad. length 0: at rest for `duration`.
struct LspbProfile {
  double length = 0.0;       ///< L >= 0
  double duration = 0.0;     ///< T, s
  double blend_time = 0.0;   ///< t_s, s; T/2 without a coasting phase
  double peak_speed = 0.0;   ///< at the end of the first blend
  double coast_speed = 0.0;  ///< equals peak_speed, unless with_sampled_coast changed it

  struct Sample {
    double position = 0.0;
    double speed = 0.0;
    double acceleration = 0.0;
  };
  /// t is clamped to [0, T]; from T on the sample is (L, 0, 0). At t_s the later phase counts, as in (11).
  [[nodiscard]] Sample sample(double t) const noexcept;
  [[nodiscard]] double acceleration() const noexcept { return blend_time > 0.0 ? peak_speed / blend_time : 0.0; }
  bool operator==(const LspbProfile&) const = default;
};

/// Fastest profile over `length` >= 0 within finite positive limits.
[[nodiscard]] LspbProfile plan_fastest_profile(double length, double max_speed, double max_acceleration);
/// The profile that takes `duration` >= the fastest's: two phases if the speed limit allows, else three at that limit.
[[nodiscard]] LspbProfile plan_stretched_profile(double length, double max_speed, double max_acceleration,
                                                 double duration);

/// Motion from X_WA to X_WB: both parts start and end together, at rest. Lengths below 1e-14 m or rad count as none.
class LspbSegment {
 public:
  struct Sample {
    Pose X_WE;
    Twist V_WE;  ///< linear part at the origin of E; in W
    Twist A_WE;  ///< acceleration: d/dt of V_WE, in W
  };

  /// No motion, duration 0, at the identity.
  LspbSegment() = default;
  /// Poses must be finite and limits positive (checked).
  LspbSegment(const Pose& X_WA, const Pose& X_WB, const MotionLimits& limits);

  [[nodiscard]] double duration() const noexcept { return translation_.duration; }
  /// t is clamped to [0, duration]; exactly X_WB and at rest from the end on.
  [[nodiscard]] Sample sample(double t) const noexcept;

  [[nodiscard]] const LspbProfile& translation() const noexcept { return translation_; }
  [[nodiscard]] const LspbProfile& rotation() const noexcept { return rotation_; }
  [[nodiscard]] const Pose& start() const noexcept { return X_WA_; }
  [[nodiscard]] const Pose& end() const noexcept { return X_WB_; }
  /// Fixed axis of the turn, in W; zero without a turn. A half turn takes the sign that log_rotation gives.
  [[nodiscard]] const Vector3& axis_W() const noexcept { return axis_W_; }

  /// What the demonstrator's planner really does when sampled every `tick` seconds: the coasting phase runs at the
  /// speed of the last sample of the first blend, through the middle of the true one, so that the reference jumps at
  /// both ends of the coast by half of (missing speed x coasting time). A blend shorter than a tick keeps the true
  /// speed. End pose and duration stay.
  [[nodiscard]] LspbSegment with_sampled_coast(double tick) const;

  bool operator==(const LspbSegment&) const = default;

 private:
  Pose X_WA_;
  Pose X_WB_;
  Vector3 direction_W_ = Vector3::Zero();  ///< unit, or zero without a translation
  Vector3 axis_W_ = Vector3::Zero();       ///< unit, or zero without a turn
  LspbProfile translation_;
  LspbProfile rotation_;
};

}  // namespace snug::motion
