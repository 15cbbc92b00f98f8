// Vacuum phases: when the lip seals, how pressure drives the cup, when it lets go, and the push of an unsealed lip.
#pragma once

#include <cstdint>
#include <string>

#include "snug/core/expected.hpp"
#include "snug/cup/suction_cup.hpp"

namespace snug::cup {

/// Holding: the model of the report, attached and released at once. Phases: with pressure (docs/theory/cup.md, 6).
enum class CupMode { Holding, Phases };
[[nodiscard]] const char* name_of(CupMode mode);
/// Throws InputError for another name than those two; `where` it was said.
[[nodiscard]] CupMode cup_mode_of(const std::string& name, const std::string& where);

enum class CupPhase {
  Free,       ///< not sealed; the lip may push
  Holding,    ///< sealed, vacuum on
  Releasing,  ///< sealed, vacuum off, pressure on its way back
};

struct CupCommand {
  bool vacuum = false;
  bool blow_off = false;
  std::uint32_t zones = ~0U;  ///< of a gripper of several cups, bit by bit: those that the two above are for
};

/// Everything about the cup that changes. Copying it is a snapshot.
struct CupState {
  CupPhase phase = CupPhase::Free;
  double pressure_gauge = 0.0;  ///< Pa, vacuum is negative
  int body = -1;                ///< sealed to this body of the world
  Pose X_PS;                    ///< lip on it
  double bend = 0.0;            ///< rad, of the last step
  double leak = 0.0;            ///< share of the vacuum's set point lost because the lip lifts, 0 .. 1
  double supply = 1.0;          ///< share of the vacuum's set point that a shared source reaches at this cup
  double release_time = 0.0;    ///< s, since the vacuum went off on a held box
  double peel_impulse = 0.0;    ///< Ns, of what the lip's contact has lacked since the vacuum went off
  double length = 0.0;          ///< m, E to lip along Ez when the pressure was last known; 0: not sealed then
  bool operator==(const CupState&) const = default;
};

enum class NoSeal { OutOfReach, TooTilted, OverEdge };
[[nodiscard]] const char* describe(NoSeal reason);

struct NoSealReason {
  NoSeal reason = NoSeal::OutOfReach;
  double gap = 0.0;       ///< m, between the free lip and the face along Ez
  double tilt = 0.0;      ///< rad, between lip plane and face
  double overhang = 0.0;  ///< m, of the sealing disc over an edge of the face
};

struct Seal {
  Pose X_PS;            ///< lip on the package: at the face, z into it, yaw of E
  double length = 0.0;  ///< m, from E to the face along Ez
  double tilt = 0.0;    ///< rad
};

/// Where the axis of the cup meets a box of these half sizes, and whether the lip seals there.
[[nodiscard]] Expected<Seal, NoSealReason> try_seal(const model::CupParams& params, const Pose& X_WE,
                                                    const Vector3& half, const Pose& X_WP);

/// How far the cup is drawn in: 0 free, 1 holding. Smooth in the pressure.
[[nodiscard]] double drawn_in(const model::CupParams& params, double pressure_gauge);
/// Length from E to the unloaded lip at this pressure, m.
[[nodiscard]] double unloaded_length(const model::CupParams& params, double pressure_gauge);
/// The sealed cup at this pressure.
[[nodiscard]] SuctionCup cup_at(const model::CupParams& params, double pressure_gauge, const Pose& X_PS);
/// One step of the pressure, exact for a constant command.
void advance_pressure(const model::CupParams& params, const CupCommand& command, double dt, CupState& state);

/// The sealed bellows keeps its gas while it changes length (constant temperature): stretching deepens the vacuum,
/// which pulls the cup in again. Without this the release throws the box instead of pushing it. `length`: E to lip
/// along Ez, m.
void follow_length(const model::CupParams& params, double length, CupState& state);

/// Share of the vacuum's set point from which on the limits of the hold count: before, the foam of the lip bridges what
/// the vacuum does not carry yet.
inline constexpr double kEstablishedVacuum = 0.8;

enum class HoldLoss { None, Tension, Shear, Peel, Bending };
[[nodiscard]] const char* describe(HoldLoss loss);

/// Share of the set point that a sealed lip loses under this wrench: zero below the onset of peeling.
[[nodiscard]] double find_leak(const model::CupParams& params, double pressure_gauge, const Wrench& F_S);

/// Is this wrench (on the package, in S about the lip) more than the vacuum and the friction of the lip can carry?
[[nodiscard]] HoldLoss find_hold_loss(const model::CupParams& params, double pressure_gauge, const Wrench& F_S,
                                      double bend);

/// Normal force, N, that the lip's contact lacks to carry this wrench without lifting, peeling off or slipping; not
/// above zero where it carries it. find_hold_loss says Tension, Peel or Shear where this is positive.
[[nodiscard]] double find_lacking_force(const model::CupParams& params, double pressure_gauge, const Wrench& F_S);

/// How many times this wrench, in the same proportions, the vacuum and the friction of the lip can carry: 1 is where
/// find_hold_loss begins to say no (the bend is not looked at), infinity where it never does.
[[nodiscard]] double find_hold_factor(const model::CupParams& params, double pressure_gauge, const Wrench& F_S);

/// The same of a box that hangs from the cup, its vacuum established, and is carried. `box_S`: as box_below_lip
/// (swing.hpp) has it; `acceleration_S`: m/s2, of the gripper less that of gravity. The box does not turn.
[[nodiscard]] double carried_hold_factor(const model::CupParams& params, const SpatialInertia& box_S,
                                         const Vector3& acceleration_S);

/// The same from what a robot senses: `F_E`, on the tool about Eo in E, from what it carries. Infinity until the vacuum
/// is established. The lip is taken for where it is while nothing deforms the cup.
[[nodiscard]] double sensed_hold_factor(const model::CupParams& params, double pressure_gauge, const Wrench& F_E);

/// The push of an open lip on a face: a unilateral spring along the face's normal, from E to the face.
class LipPush final : public physics::ForceElement {
 public:
  LipPush() = default;
  /// `stiffness` N/m and `damping` Ns/m along the normal, `length` of the unloaded cup; p_PS, n_P: where the lip
  /// stands on the package and the outward normal there.
  LipPush(double stiffness, double damping, double length, const Vector3& p_PS, const Vector3& n_P)
      : stiffness_(stiffness), damping_(damping), length_(length), p_PS_(p_PS), n_P_(n_P) {}
  [[nodiscard]] physics::ElementResponse evaluate(const physics::ElementQuery& query) const noexcept override;

 private:
  double stiffness_ = 0.0;
  double damping_ = 0.0;
  double length_ = 0.0;
  Vector3 p_PS_ = Vector3::Zero();
  Vector3 n_P_ = Vector3::UnitZ();
};

}  // namespace snug::cup
