// Gripper: the cup in the cell: what it seals to, what it does to that box in the coming step, and when it lets go.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "snug/cell/world_builder.hpp"
#include "snug/cup/phases.hpp"

namespace snug::cell {

struct GripperEvent {
  enum class Kind { Seal, NoSeal, BendWarning, HoldLost, Released } kind = Kind::Seal;
  int body = -1;
  Vector3 offset_P = Vector3::Zero();  ///< Seal: from the face's centre to the lip, in P, m
  double length = 0.0;                 ///< Seal: E to face, m
  double angle = 0.0;                  ///< tilt or bend, rad
  cup::NoSealReason no_seal;
  cup::HoldLoss loss = cup::HoldLoss::None;
};

/// Everything of the gripper that changes.
struct GripperState {
  cup::CupState cup;
  double vacuum_time = 0.0;     ///< s, since the vacuum was switched on
  bool is_established = false;  ///< the vacuum of the present hold was nearly complete: its limits count
  bool has_warned = false;      ///< of too much bending, for the present hold
  bool has_reported = false;    ///< that no seal was found, for the present vacuum command
  bool is_letting_go = false;   ///< since the vacuum went off on a held box, until it comes on again
  bool cannot_seal = false;     ///< a fault: the lip leaks
  /// The least cup::find_hold_factor of a hold whose vacuum was nearly complete, since somebody set it to infinity.
  double least_hold_factor = std::numeric_limits<double>::infinity();
  Wrench F_S;  ///< on the held box, at the lip, at the start of the step
  bool operator==(const GripperState&) const = default;
};

/// What the gripper contributes to one step of the physics.
struct GripperStep {
  cup::SuctionCup cup;
  cup::LipPush push;
  const physics::ForceElement* element = nullptr;  ///< one of the two above, or none
  int body = -1;                                   ///< it acts on
  int ignored = -1;                                ///< box that the cup's own shape must not collide with
};

class Gripper {
 public:
  Gripper(const model::CupParams& params, cup::CupMode mode, const CellWorld& world);

  /// To be called before every physics step, with the tool at the start of the step. Appends what happened.
  void prepare(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE,
               const cup::CupCommand& command, double dt, GripperState& state, GripperStep& out,
               std::vector<GripperEvent>& events) const;

 private:
  struct Target {
    int body = -1;
    cup::Seal hit;  ///< where the cup's axis meets it, sealable or not
    Vector3 half = Vector3::Zero();
    Pose X_WP;
  };
  [[nodiscard]] const model::CupParams& params_of(const GripperState& state) const {
    return state.is_letting_go ? letting_go_ : params_;
  }
  [[nodiscard]] Target find_target(const physics::WorldState& world_state, const Pose& X_WE) const;
  void try_to_seal(const Target& target, const Pose& X_WE, const cup::CupCommand& command, GripperState& state,
                   std::vector<GripperEvent>& events) const;
  void check_hold(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE, double dt,
                  const cup::SuctionCup& cup, GripperState& state, std::vector<GripperEvent>& events) const;
  void advance_gas(const physics::WorldState& world_state, const Pose& X_WE, const cup::CupCommand& command, double dt,
                   GripperState& state) const;
  void let_go(GripperEvent event, GripperState& state, std::vector<GripperEvent>& events) const;

  model::CupParams params_;
  model::CupParams letting_go_;  ///< the same, grown by its share of the push at release
  cup::CupMode mode_;
  const CellWorld* world_;
};

}  // namespace snug::cell
