// find_knots: the few states of a motion of joints between which cubic polynomials pass all others.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "snug/robot/arm.hpp"

namespace snug::control {

/// Where joints are at a time, and how fast.
struct TimedJoints {
  double time = 0.0;      ///< s
  robot::JointVector q;   ///< rad (m)
  robot::JointVector qd;  ///< rad/s (m/s)
};

/// Positions at `time` of the cubic Hermite polynomials that have positions and speeds of both.
[[nodiscard]] robot::JointVector interpolate(const TimedJoints& from, const TimedJoints& to, double time);

/// What the polynomials between two knots may do.
struct KnotLimits {
  double tolerance = 0.0;         ///< rad (m), of each joint at each state in between
  robot::JointVector max_speed;   ///< rad/s (m/s)
  double max_acceleration = 0.0;  ///< rad/s^2 (m/s^2), of every joint
};

/// Indices of the knots after the first state, in order; the last state is the last of them. Each is as far from the
/// one before as the limits allow, by doubling and bisection; states that follow each other need no polynomial within
/// the limits. `states`: times grow. Empty for less than two states.
[[nodiscard]] std::vector<std::size_t> find_knots(std::span<const TimedJoints> states, const KnotLimits& limits);

}  // namespace snug::control
