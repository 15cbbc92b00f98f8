// Phases: what vacuum does to the cup over time: seal, draw in, hold, let go, push off. A pure state machine.
#pragma once

#include <array>
#include <string>

#include "snug/cup/lip_contact.hpp"
#include "snug/cup/seal.hpp"
#include "snug/cup/suction_cup.hpp"

namespace snug::cup {

/// Which model of gripping runs.
enum class CupMode {
  Phases,   ///< pressure, moving rest length, hold limits, push at release
  Holding,  ///< the report's: the holding law from the command on, gone at once; only the bending limit applies
};

enum class Phase {
  Free,       ///< lip open, no vacuum asked for or no seal found
  Sealing,    ///< attached, pressure still building
  Holding,    ///< attached, at least 80 % of the vacuum reached once
  Releasing,  ///< vacuum off, and the lip has not left the face yet; attached as long as the lip is tight
};

struct CupCommand {
  bool vacuum = false;
  bool blow_off = false;
};

/// Why a lip came off.
enum class LetGo {
  Tension,  ///< pulled off: no normal force left between lip and face
  Shear,    ///< slid or twisted off: friction of the lip exceeded
  Peel,     ///< levered off
  Bend,     ///< bent to 45 degrees: the law has no moment left to give
};

enum class CupEventKind {
  Sealed,       ///< the lip found a face: attached from now on
  NoSeal,       ///< vacuum asked for, no face found for a while (once per command and reason)
  Drawn,        ///< vacuum reached: Holding
  Leak,         ///< bending lifts the lip on one side: vacuum weakens (once per onset)
  BendWarning,  ///< bent beyond the warning angle (once per hold)
  HoldLost,     ///< the lip came off although vacuum was on
  VacuumOff,    ///< vacuum switched off while attached
  LipOpened,    ///< after VacuumOff the lip is no longer tight; the cup may still push
  Separated,    ///< the lip left the face
};

struct CupEvent {
  CupEventKind kind = CupEventKind::Sealed;
  LetGo cause = LetGo::Tension;  ///< of HoldLost and LipOpened
  Refusal refusal;               ///< of NoSeal
  double value = 0.0;            ///< bending [rad], use of the limit [1] or length [m], see describe()
  bool operator==(const CupEvent&) const = default;
};

/// Up to eight events of one step, in order; no allocation.
struct CupEvents {
  std::array<CupEvent, 8> items;
  int count = 0;
  void add(const CupEvent& event) noexcept {
    if (count < 8) items[static_cast<std::size_t>(count++)] = event;
  }
  [[nodiscard]] const CupEvent* begin() const noexcept { return items.data(); }
  [[nodiscard]] const CupEvent* end() const noexcept { return items.data() + count; }
};

/// All that a cup remembers. Copyable, comparable: a copy is a snapshot.
struct CupState {
  Phase phase = Phase::Free;
  bool is_attached = false;
  double pressure_gauge = 0.0;  ///< Pa, negative is vacuum
  double time_in_phase = 0.0;   ///< s
  Pose X_PS;                    ///< lip on the package; meaningful while attached
  Face face = 4;                ///< face of the package that the lip is on (or was last)
  double slack_length = 0.0;    ///< m, rest length without vacuum of this hold
  double hold_length = 0.0;     ///< m, rest length under vacuum of this hold; set from the parameters at the seal
  double length = 0.0;          ///< m, E to S along Ez at the end of the last step
  double leak = 0.0;            ///< lost fraction of the vacuum set point, 0..1
  bool has_leaked = false;      ///< Leak was reported and has not ended
  bool has_warned = false;      ///< BendWarning was reported in this hold
  bool is_blocked = false;      ///< lost a hold: no new seal before the lip has breathed out
  double time_unsealed = 0.0;   ///< s, vacuum on without a face
  bool has_refused = false;     ///< NoSeal was reported for last_refusal
  Refusal last_refusal;
  bool operator==(const CupState&) const = default;
};

/// Geometry at the end of a step: the gripper and the one package that is held, or else stands before the lip.
struct CupScene {
  Pose X_WE;
  Twist V_WE;                                  ///< at E's origin, in W
  bool has_package = false;                    ///< false: nothing near
  Vector3 half = Vector3::Constant(0.05);      ///< half edge lengths of the package, m
  Pose X_WP;                                   ///< its frame: centre, axes along the edges
  Twist V_WP;                                  ///< at P's origin, in W
};

/// Advances the machine by one step of length dt [s] > 0 that has just been taken with the elements below. The scene must
/// show the held package while is_attached. Emits what happened; changes nothing but `state`.
[[nodiscard]] CupEvents advance(const model::CupParams& params, CupMode mode, const CupCommand& command,
                                const CupScene& scene, double dt, CupState& state) noexcept;

/// Share of the drawn-in bellows at a pressure: 0 slack, 1 drawn; smoothstep between.
[[nodiscard]] double compute_drawn_share(const model::VacuumParams& vacuum, double pressure_gauge) noexcept;

/// The attached cup for the coming step: stiffness, damping and rest length follow the pressure, and the pressure
/// follows the length of the sealed bellows (constant temperature), within the step too.
class DrivenCup final : public physics::ForceElement {
 public:
  DrivenCup(const model::CupParams& params, CupMode mode, const CupState& state) noexcept;

  [[nodiscard]] physics::ElementResponse evaluate(const physics::ElementQuery& query) const noexcept override;
  [[nodiscard]] CupReading read(const physics::ElementQuery& query) const noexcept;
  /// Pressure [Pa gauge] of the bellows at a length [m], nothing having flowed in or out since the step began.
  [[nodiscard]] double compute_pressure(double length) const noexcept;

 private:
  [[nodiscard]] double drawn_share(double length) const noexcept;
  [[nodiscard]] SuctionCup at_share(double share) const noexcept;
  [[nodiscard]] double measure_length(const physics::ElementQuery& query) const noexcept;

  model::VacuumParams vacuum_;
  bool is_fixed_ = false;  ///< CupMode::Holding: always fully drawn
  Matrix6 K_, D_;          ///< drawn
  double stiffness_ratio_ = 1.0, damping_ratio_ = 1.0;
  double slack_length_ = 0.0, hold_length_ = 0.0, centre_from_lip_ = 0.0;
  double start_pressure_ = 0.0, start_length_ = 0.0;
  Pose X_PS_;
};

/// The open lip against the package of the scene, for the coming step. Only CupMode::Phases has one.
[[nodiscard]] LipContact make_lip_contact(const model::CupParams& params, const CupScene& scene) noexcept;
/// Whether the coming step needs the open lip: not attached, and the package is within a lip's reach of it.
[[nodiscard]] bool needs_lip_contact(const model::CupParams& params, CupMode mode, const CupState& state,
                                     const CupScene& scene) noexcept;

/// How much of each hold limit a wrench on the package at and in S uses; > 1 (or tension) lets go.
struct HoldUse {
  double normal_force = 0.0;  ///< N between lip and face
  double shear = 0.0;         ///< root of the sum of squares of sliding and twisting use
  double peel = 0.0;          ///< bending moment / (N R)
  bool is_held = true;
  LetGo cause = LetGo::Tension;  ///< when not held
};
[[nodiscard]] HoldUse check_hold(const model::CupParams& params, double pressure_gauge, const Vector6& wrench_S) noexcept;

/// Names in snake_case and one line of text, for tables and events.
[[nodiscard]] const char* name_of(Phase phase) noexcept;
[[nodiscard]] const char* name_of(LetGo cause) noexcept;
[[nodiscard]] const char* name_of(CupEventKind kind) noexcept;
[[nodiscard]] std::string describe(const CupEvent& event);

}  // namespace snug::cup
