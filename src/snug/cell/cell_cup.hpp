// CellCup: a cup in the cell: what it seals to, what it does to that box in the coming step, and when it lets go.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "snug/cell/world_builder.hpp"
#include "snug/cup/phases.hpp"

namespace snug::cell {

struct GripperEvent {
  enum class Kind {
    Seal,
    NoSeal,
    BendWarning,
    HoldLost,
    Released,
    CupsHold,  ///< several cups: the vacuum of those that hold the box is there
    CupLost,   ///< several cups: one came off, others hold
    TwoBoxes,  ///< several cups: some hold another box too
  } kind = Kind::Seal;
  int body = -1;
  Vector3 offset_P = Vector3::Zero();  ///< Seal: from the face's centre to the lip, in P, m
  double length = 0.0;                 ///< Seal: E to face, m
  double angle = 0.0;                  ///< tilt or bend, rad
  cup::NoSealReason no_seal;
  cup::HoldLoss loss = cup::HoldLoss::None;
  int of = 0;        ///< CupsHold: all cups of the gripper
  int holding = 0;   ///< CupsHold, CupLost: so many cups hold the box
  std::string cups;  ///< CupsHold, CupLost, TwoBoxes: their names, or that of the one that came off
};

/// The twist of a point that moves with a frame, `p_W` from its origin.
[[nodiscard]] inline Twist twist_at(const Twist& V, const Vector3& p_W) {
  return {V.linear + V.angular.cross(p_W), V.angular};
}

/// Everything of a cup that changes.
struct CupHold {
  cup::CupState cup;
  double vacuum_time = 0.0;     ///< s, since the vacuum was switched on
  bool is_established = false;  ///< the vacuum of the present hold was nearly complete: its limits count
  bool has_warned = false;      ///< of too much bending, for the present hold
  bool has_reported = false;    ///< that no seal was found, for the present vacuum command
  bool is_letting_go = false;   ///< since the vacuum went off on a held box, until it comes on again
  bool cannot_seal = false;     ///< a fault: the lip leaks
  bool has_come_off = false;    ///< and stays open, until the vacuum goes off
  /// The least cup::find_hold_factor of a hold whose vacuum was nearly complete, since somebody set it to infinity.
  double least_hold_factor = std::numeric_limits<double>::infinity();
  Wrench F_S;  ///< on the held box, at the lip, at the start of the step
  bool operator==(const CupHold&) const = default;
};

/// What a cup contributes to one step of the physics.
struct CupStep {
  cup::SuctionCup cup;
  cup::LipPush push;
  const physics::ForceElement* element = nullptr;  ///< one of the two above, or none
  int body = -1;                                   ///< it acts on
  int ignored = -1;                                ///< box that the cup's own shape must not collide with
};

class CellCup {
 public:
  /// `stays_open`: once it came off it does not seal again before the vacuum goes off, as one cup of several whose box
  /// is still there.
  CellCup(const model::CupParams& params, cup::CupMode mode, bool stays_open, const CellWorld& world);

  /// To be called before every physics step, with the tool at the start of the step. Appends what happened.
  void prepare(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE,
               const cup::CupCommand& command, double dt, CupHold& state, CupStep& out,
               std::vector<GripperEvent>& events) const;

 private:
  struct Target {
    int body = -1;
    cup::Seal hit;  ///< where the cup's axis meets it, sealable or not
    Vector3 half = Vector3::Zero();
    Pose X_WP;
  };
  [[nodiscard]] const model::CupParams& params_of(const CupHold& state) const {
    return state.is_letting_go ? letting_go_ : params_;
  }
  /// Pa, where the vacuum of the sealed cup settles.
  [[nodiscard]] double set_point(const CupHold& state) const {
    return params_.vacuum.pressure_gauge_hold * state.cup.supply;
  }
  [[nodiscard]] Target find_target(const physics::WorldState& world_state, const Pose& X_WE) const;
  void try_to_seal(const Target& target, const Pose& X_WE, const cup::CupCommand& command, CupHold& state,
                   std::vector<GripperEvent>& events) const;
  void check_hold(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE, double dt,
                  const cup::SuctionCup& cup, CupHold& state, std::vector<GripperEvent>& events) const;
  void advance_gas(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE,
                   const cup::CupCommand& command, double dt, CupHold& state) const;
  void let_go(GripperEvent event, CupHold& state, std::vector<GripperEvent>& events) const;

  model::CupParams params_;
  model::CupParams letting_go_;  ///< the same, grown by its share of the push at release
  cup::CupMode mode_;
  bool stays_open_;
  const CellWorld* world_;
};

}  // namespace snug::cell
