// simulate_drop: the implicit midpoint rule over steps of half a millisecond.
#include "snug/identification/internal/release_drop.hpp"

#include <algorithm>
#include <cmath>

#include "snug/cup/release.hpp"

namespace snug::identification::internal {
namespace {

constexpr double kDropGravity = 9.81;
constexpr double kLongestDropStep = 0.5e-3;  // s: a hundredth of it moves no height by 0.005 mm

/// What pulls the box, a spring and a damper.
struct Pull {
  double stiffness = 0.0;        // N/m
  double unloaded_length = 0.0;  // m
  double damping = 0.0;          // Ns/m
};

/// The cup of a run that is letting go, one dimension of it.
class DroppingCup {
 public:
  explicit DroppingCup(const model::CupParams& cup) : cup_(cup) {
    cup_.free_length = cup.hold_length + cup.release_push * (cup.free_length - cup.hold_length);
    if (!cup.release.is_used()) cup_.release.peel_impulse = 0.0;
    state_.phase = cup::CupPhase::Releasing;
    state_.pressure_gauge = cup.vacuum.pressure_gauge_hold;
  }
  [[nodiscard]] double length_at_rest(double weight) const {
    return cup_.hold_length + weight / (cup_.release.is_used() ? cup_.release.shut_stiffness : cup_.stiffness.axial);
  }
  void advance_gas(double length, double dt) {
    if (cup_.release.is_used()) {
      cup::advance_release(cup_, true, length, dt, state_);
      return;
    }
    cup::follow_length(cup_, length, state_);
    cup::advance_pressure(cup_, {false, true}, dt, state_);
  }
  [[nodiscard]] Pull pull_at(double length) const {
    if (cup_.release.is_used()) {
      const cup::Bellows bellows = cup::find_bellows(cup_, state_.pressure_gauge, length);
      return {bellows.stiffness, bellows.unloaded_length, cup_.release.damping};
    }
    const double held = cup::drawn_in(cup_, state_.pressure_gauge);
    return {(cup_.free_stiffness_ratio + held * (1.0 - cup_.free_stiffness_ratio)) * cup_.stiffness.axial,
            cup::unloaded_length(cup_, state_.pressure_gauge),
            (cup_.free_damping_ratio + held * (1.0 - cup_.free_damping_ratio)) * cup_.damping.axial};
  }
  /// Share of the step after which a lip that pulls the box with this force has come off; 1 or more: it has not.
  [[nodiscard]] double peel(double pull, double dt) {
    const double lacking =
        cup::find_lacking_force(cup_, state_.pressure_gauge, {Vector3(0.0, 0.0, -pull), Vector3::Zero()});
    const double left = cup_.release.peel_impulse - state_.peel_impulse;
    state_.peel_impulse += std::max(0.0, lacking) * dt;
    return lacking > 0.0 ? std::max(0.0, left / (lacking * dt)) : 1.0;
  }

 private:
  model::CupParams cup_;
  cup::CupState state_;
};

}  // namespace

Drop simulate_drop(const model::CupParams& cup, const RecordedRelease& release) {
  const double mass = release.mass;
  DroppingCup dropping(cup);
  Drop drop;
  drop.length = dropping.length_at_rest(mass * kDropGravity);
  drop.height = {0.0};
  double height = 0.0, speed = 0.0;
  for (std::size_t i = 1; i < release.times.size(); ++i) {
    const double span = release.times[i] - release.times[i - 1];
    const int steps = std::max(1, static_cast<int>(std::ceil(span / kLongestDropStep)));
    const double dt = span / steps, lift = (release.gripper[i] - release.gripper[i - 1]) / span;
    for (int k = 0; k < steps; ++k) {
      double pull = 0.0;
      if (drop.opening < 0.0) {
        // Halfway through the step: the pressure there, and the length there but for what this step accelerates.
        const double raised = release.gripper[i - 1] - release.gripper[0] + lift * dt * (k + 0.5);
        const double length = drop.length + raised - (height + 0.5 * dt * speed);
        dropping.advance_gas(length, 0.5 * dt);
        const Pull cup_pull = dropping.pull_at(length);
        const double without =
            cup_pull.stiffness * (length - cup_pull.unloaded_length) + cup_pull.damping * (lift - speed);
        const double softening = 1.0 + 0.5 * dt * (cup_pull.damping + 0.5 * dt * cup_pull.stiffness) / mass;
        pull = (without - mass * kDropGravity) / softening + mass * kDropGravity;
        const double part = dropping.peel(pull, dt);
        if (part < 1.0) {
          drop.opening = release.times[i - 1] + dt * (k + part);
          pull *= part;
        }
        dropping.advance_gas(length, 0.5 * dt);
      }
      const double before = speed;
      speed += dt * (pull / mass - kDropGravity);
      height += 0.5 * dt * (before + speed);
    }
    drop.height.push_back(height);
  }
  return drop;
}

}  // namespace snug::identification::internal
