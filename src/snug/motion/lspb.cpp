// LspbSegment: straight line and fixed-axis turn with trapezoidal speeds, report section 2.3.1 (eqs 4-11).
#include "snug/motion/lspb.hpp"

#include <algorithm>
#include <cmath>

#include "snug/core/check.hpp"

namespace snug::motion {
namespace {

// m or rad: shorter is the rounding of poses, not a motion.
constexpr double kNoLength = 1e-14;

LspbProfile two_phase_profile(double length, double duration) {
  const double peak = 2.0 * (length / duration);
  return {length, duration, 0.5 * duration, peak, peak};
}

LspbProfile with_sampled_coast(LspbProfile profile, double tick) {
  const double blend_ticks = profile.blend_time / tick;
  if (blend_ticks <= 1.0) return profile;
  const double last_sample = std::ceil(blend_ticks) - 1.0;  // the last tick strictly inside the blend
  profile.coast_speed = profile.peak_speed * std::min(1.0, last_sample / blend_ticks);
  return profile;
}

}  // namespace

LspbProfile::Sample LspbProfile::sample(double t) const noexcept {
  if (!(t > 0.0)) return {0.0, 0.0, duration > 0.0 ? acceleration() : 0.0};
  if (t >= duration) return {length, 0.0, 0.0};
  if (length <= 0.0) return {};
  if (t < blend_time) {
    const double part = t / blend_time;  // eq. (9) with a t_s = v: no squares of tiny or huge numbers
    return {0.5 * peak_speed * blend_time * part * part, peak_speed * part, acceleration()};
  }
  const double left = duration - t;
  if (left > blend_time) {
    return {0.5 * length + coast_speed * (t - 0.5 * duration), coast_speed, 0.0};
  }
  const double part = left / blend_time;
  return {length - 0.5 * peak_speed * blend_time * part * part, peak_speed * part, -acceleration()};
}

LspbProfile plan_fastest_profile(double length, double max_speed, double max_acceleration) {
  SNUG_CHECK(std::isfinite(length) && length >= 0.0, "length of a motion must be finite and not negative");
  SNUG_CHECK(is_positive(max_speed) && is_positive(max_acceleration), "limits of a motion must be finite and positive");
  if (length <= 0.0) return {};
  const double blend_time = max_speed / max_acceleration;
  if (length > max_speed * blend_time) {
    return {length, length / max_speed + blend_time, blend_time, max_speed, max_speed};
  }
  return two_phase_profile(length, 2.0 * std::sqrt(length / max_acceleration));
}

LspbProfile plan_stretched_profile(double length, double max_speed, double max_acceleration, double duration) {
  const LspbProfile fastest = plan_fastest_profile(length, max_speed, max_acceleration);
  if (duration <= fastest.duration) return fastest;
  if (length <= 0.0) return {0.0, duration, 0.0, 0.0, 0.0};
  // Two phases also need the acceleration 4 L / T^2. The limit always allows it here: T is at least
  // L / v + v / a >= 2 sqrt(L / a) after three phases (means) and 2 sqrt(L / a) after two.
  if (2.0 * (length / duration) <= max_speed) return two_phase_profile(length, duration);
  return {length, duration, duration - length / max_speed, max_speed, max_speed};
}

LspbSegment::LspbSegment(const Pose& X_WA, const Pose& X_WB, const MotionLimits& limits) : X_WA_(X_WA), X_WB_(X_WB) {
  SNUG_CHECK(X_WA.p.allFinite() && X_WA.R.allFinite() && X_WB.p.allFinite() && X_WB.R.allFinite(),
             "poses of a motion must be finite");
  const Vector3 line = X_WB.p - X_WA.p;
  const Vector3 turn_A = log_rotation(X_WA.R.transpose() * X_WB.R);
  double length = line.norm();
  double angle = turn_A.norm();
  if (length < kNoLength) length = 0.0;
  if (angle < kNoLength) angle = 0.0;
  if (length > 0.0) direction_W_ = line / length;
  if (angle > 0.0) axis_W_ = X_WA.R * (turn_A / angle);

  translation_ = plan_fastest_profile(length, limits.max_speed, limits.max_acceleration);
  rotation_ = plan_fastest_profile(angle, limits.max_turn_speed, limits.max_turn_acceleration);
  if (translation_.duration < rotation_.duration) {
    translation_ = plan_stretched_profile(length, limits.max_speed, limits.max_acceleration, rotation_.duration);
  } else if (rotation_.duration < translation_.duration) {
    rotation_ =
        plan_stretched_profile(angle, limits.max_turn_speed, limits.max_turn_acceleration, translation_.duration);
  }
}

LspbSegment::Sample LspbSegment::sample(double t) const noexcept {
  if (t >= duration()) return {X_WB_, {}, {}};
  const LspbProfile::Sample line = translation_.sample(t);
  const LspbProfile::Sample turn = rotation_.sample(t);
  Sample sample;
  sample.X_WE.p = X_WA_.p + line.position * direction_W_;
  sample.X_WE.R = turn.position > 0.0 ? Matrix3(exp_rotation(turn.position * axis_W_) * X_WA_.R) : X_WA_.R;
  sample.V_WE = {line.speed * direction_W_, turn.speed * axis_W_};
  sample.A_WE = {line.acceleration * direction_W_, turn.acceleration * axis_W_};
  return sample;
}

LspbSegment LspbSegment::with_sampled_coast(double tick) const {
  SNUG_CHECK(is_positive(tick), "a tick must be finite and positive");
  LspbSegment segment = *this;
  segment.translation_ = motion::with_sampled_coast(translation_, tick);
  segment.rotation_ = motion::with_sampled_coast(rotation_, tick);
  return segment;
}

}  // namespace snug::motion
