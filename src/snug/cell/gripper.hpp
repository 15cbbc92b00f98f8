// Gripper: the cups in the cell, one or several: what they hold together, what they do to it in the coming step.
#pragma once

#include <optional>
#include <vector>

#include "snug/cell/cell_cup.hpp"

namespace snug::cell {

/// Everything of the gripper that changes. Of one cup: its state. Of several: what they do together, told as of one
/// cup at E, for all that know one cup; and each of them.
///
/// Together: `cup.body` is the box that most cups hold (a second box is an event), `cup.X_PS` where Ez met it when the
/// first cup sealed, `F_S` all their wrenches there, `cup.pressure_gauge` the weakest vacuum of those that hold it (or,
/// without the vacuum, the deepest of all), `least_hold_factor` that of the cup that was nearest to coming off.
struct GripperState : CupHold {
  std::vector<CupHold> cups;   ///< of several, in the order of GripperParams::cups; empty until the first step
  bool has_two_boxes = false;  ///< reported for the present hold
  bool operator==(const GripperState&) const = default;
};

/// What the gripper contributes to one step of the physics, and scratch memory.
struct GripperStep {
  std::vector<CupStep> cups;
  std::vector<physics::ElementUse> uses;  ///< of the elements in `cups`
  int ignored = -1;                       ///< box that the cups' own shapes must not collide with
  std::vector<GripperEvent> events;
  std::vector<model::LineState> lines;
  model::SupplyBalance balance;
};

class Gripper {
 public:
  Gripper(const model::Scenario& scenario, cup::CupMode mode, const CellWorld& world);

  /// To be called before every physics step, with the tool at the start of the step. Appends what happened.
  void prepare(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE,
               const cup::CupCommand& command, double dt, GripperState& state, GripperStep& out,
               std::vector<GripperEvent>& events) const;

 private:
  /// What the cups' events of this step say of the box that they hold together.
  struct Told {
    std::optional<GripperEvent> seal;
    std::size_t sealed_cup = 0;
    std::optional<GripperEvent> end;  ///< of the last cup that let it go
    std::optional<GripperEvent> no_seal;
    std::optional<GripperEvent> warning;
  };
  void share_supply(const cup::CupCommand& command, GripperState& state, GripperStep& out) const;
  void prepare_cups(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE,
                    const cup::CupCommand& command, double dt, GripperState& state, GripperStep& out, Told& told,
                    std::vector<GripperEvent>& events) const;
  void end_hold(const Told& told, GripperState& state, std::vector<GripperEvent>& events) const;
  void begin_hold(const Told& told, GripperState& state, std::vector<GripperEvent>& events) const;
  void tell_cups(GripperState& state, std::vector<GripperEvent>& events) const;
  void add_up(const cup::CupCommand& command, const Pose& X_WE, const physics::WorldState& world_state,
              GripperState& state) const;
  [[nodiscard]] bool is_on(std::size_t cup, const cup::CupCommand& command) const {
    return command.vacuum && ((command.zones >> params_->cups[cup].zone) & 1U) != 0;
  }
  [[nodiscard]] std::string names_of_holding(const GripperState& state, int body) const;

  std::optional<model::GripperParams> params_;  ///< of several cups
  std::vector<CellCup> cups_;
  const CellWorld* world_;
};

/// How many cups hold this body.
[[nodiscard]] int holding_cups(const GripperState& state, int body);

}  // namespace snug::cell
