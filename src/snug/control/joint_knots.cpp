// find_knots: the few states of a motion of joints between which cubic polynomials pass all others.
#include "snug/control/joint_knots.hpp"

#include <algorithm>
#include <cmath>

namespace snug::control {
namespace {

/// The polynomial of one joint.
struct Cubic {
  double duration = 0.0;            ///< s
  double speed_start = 0.0;         ///< rad/s
  double acceleration_start = 0.0;  ///< rad/s^2; linear in time from here
  double acceleration_end = 0.0;    ///< rad/s^2
};

Cubic cubic_of(const TimedJoints& from, const TimedJoints& to, Eigen::Index joint) {
  const double duration = to.time - from.time;
  const double mean_speed = (to.q[joint] - from.q[joint]) / duration;
  const double v0 = from.qd[joint], v1 = to.qd[joint];
  return {duration, v0, (6.0 * mean_speed - 4.0 * v0 - 2.0 * v1) / duration,
          (-6.0 * mean_speed + 2.0 * v0 + 4.0 * v1) / duration};
}

/// Its speed where it neither grows nor falls; that at the start when there is no such place.
double turning_speed(const Cubic& cubic) {
  const double a0 = cubic.acceleration_start, a1 = cubic.acceleration_end;
  if (!(a0 * a1 < 0.0)) return cubic.speed_start;
  return cubic.speed_start + 0.5 * a0 * cubic.duration * a0 / (a0 - a1);
}

/// What is not a number is not within limits either.
bool is_within_limits(const Cubic& cubic, double max_speed, double max_acceleration) {
  return std::abs(cubic.acceleration_start) <= max_acceleration &&
         std::abs(cubic.acceleration_end) <= max_acceleration && std::abs(turning_speed(cubic)) <= max_speed;
}

bool is_admissible(std::span<const TimedJoints> states, std::size_t from, std::size_t to, const KnotLimits& limits) {
  if (to == from + 1) return true;
  for (Eigen::Index j = 0; j < states[from].q.size(); ++j) {
    if (!is_within_limits(cubic_of(states[from], states[to], j), limits.max_speed[j], limits.max_acceleration))
      return false;
  }
  for (std::size_t i = from + 1; i < to; ++i) {
    const robot::JointVector error = interpolate(states[from], states[to], states[i].time) - states[i].q;
    if (!(error.cwiseAbs().maxCoeff() <= limits.tolerance)) return false;
  }
  return true;
}

/// As far from `from` as was found admissible.
std::size_t find_next(std::span<const TimedJoints> states, std::size_t from, const KnotLimits& limits) {
  const std::size_t last = states.size() - 1;
  std::size_t good = from + 1, bad = last + 1;
  while (good < last && bad > last) {
    const std::size_t further = std::min(last, from + 2 * (good - from));
    (is_admissible(states, from, further, limits) ? good : bad) = further;
  }
  while (bad <= last && bad - good > 1) {
    const std::size_t middle = good + (bad - good) / 2;
    (is_admissible(states, from, middle, limits) ? good : bad) = middle;
  }
  return good;
}

}  // namespace

robot::JointVector interpolate(const TimedJoints& from, const TimedJoints& to, double time) {
  const double duration = to.time - from.time;
  const double u = (time - from.time) / duration, rest = 1.0 - u;
  return (1.0 + 2.0 * u) * rest * rest * from.q + u * rest * rest * duration * from.qd +
         u * u * (3.0 - 2.0 * u) * to.q - u * u * rest * duration * to.qd;
}

std::vector<std::size_t> find_knots(std::span<const TimedJoints> states, const KnotLimits& limits) {
  std::vector<std::size_t> knots;
  for (std::size_t at = 0; at + 1 < states.size(); at = knots.back()) knots.push_back(find_next(states, at, limits));
  return knots;
}

}  // namespace snug::control
