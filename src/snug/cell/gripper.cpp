// Gripper: the cups in the cell, one or several: what they hold together, what they do to it in the coming step.
#include "snug/cell/gripper.hpp"

#include <algorithm>
#include <utility>

namespace snug::cell {
namespace {

using Kind = GripperEvent::Kind;

bool holds(const CupHold& cup, int body) { return cup.cup.phase != cup::CupPhase::Free && cup.cup.body == body; }

/// The body that most cups hold, of equally many that of the first cup; -1: none.
int held_by_most(const GripperState& state) {
  int best = -1, most = 0;
  for (const CupHold& cup : state.cups) {
    if (cup.cup.phase == cup::CupPhase::Free) continue;
    const int count = holding_cups(state, cup.cup.body);
    if (count > most) {
      best = cup.cup.body;
      most = count;
    }
  }
  return best;
}

}  // namespace

int holding_cups(const GripperState& state, int body) {
  return static_cast<int>(
      std::count_if(state.cups.begin(), state.cups.end(), [body](const auto& cup) { return holds(cup, body); }));
}

Gripper::Gripper(const model::Scenario& scenario, cup::CupMode mode, const CellWorld& world)
    : params_(scenario.gripper), world_(&world) {
  if (!params_) {
    cups_.emplace_back(scenario.cup, mode, false, world);
    return;
  }
  for (const model::MountedCup& cup : params_->cups) cups_.emplace_back(cup.cup, mode, true, world);
}

void Gripper::prepare(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE,
                      const cup::CupCommand& command, double dt, GripperState& state, GripperStep& out,
                      std::vector<GripperEvent>& events) const {
  out.cups.resize(cups_.size());
  out.uses.clear();
  if (params_) {
    state.cups.resize(cups_.size());
    share_supply(command, state, out);
    Told told;
    prepare_cups(world_state, X_WE, V_WE, command, dt, state, out, told, events);
    end_hold(told, state, events);
    begin_hold(told, state, events);
    add_up(command, X_WE, world_state, state);
    tell_cups(state, events);
    out.ignored = state.cup.body;
    for (const CupStep& cup : out.cups) out.ignored = out.ignored < 0 ? cup.ignored : out.ignored;
  } else {
    cups_[0].prepare(world_state, X_WE, V_WE, command, dt, state, out.cups[0], events);
    out.ignored = out.cups[0].ignored;
  }
  for (std::size_t i = 0; i < out.cups.size(); ++i) {
    const CupStep& cup = out.cups[i];
    if (cup.element == nullptr) continue;
    const Pose X_EC{Matrix3::Identity(), params_ ? params_->cups[i].p_EC : Vector3(Vector3::Zero())};
    out.uses.push_back({cup.element, world_->tool, X_EC, physics::BodyId{cup.body}});
  }
}

/// The flow settles within a step: what the cups did before it decides what vacuum they are given in it.
void Gripper::share_supply(const cup::CupCommand& command, GripperState& state, GripperStep& out) const {
  if (!params_->supply) return;
  out.lines.resize(cups_.size());
  for (std::size_t i = 0; i < cups_.size(); ++i) {
    const bool is_sealed = state.cups[i].cup.phase == cup::CupPhase::Holding;
    out.lines[i] = !is_on(i, command) ? model::LineState::Shut
                   : is_sealed        ? model::LineState::Sealed
                                      : model::LineState::Open;
  }
  model::balance_supply(*params_, out.lines, out.balance);
  for (std::size_t i = 0; i < cups_.size(); ++i) {
    // A cup that is about to seal will have what the manifold has.
    const double vacuum = out.lines[i] == model::LineState::Sealed ? out.balance.cups[i] : out.balance.manifold;
    state.cups[i].cup.supply = vacuum / -params_->cups[i].cup.vacuum.pressure_gauge_hold;
  }
}

void Gripper::prepare_cups(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE,
                           const cup::CupCommand& command, double dt, GripperState& state, GripperStep& out, Told& told,
                           std::vector<GripperEvent>& events) const {
  state.vacuum_time = command.vacuum ? state.vacuum_time + dt : 0.0;
  if (!command.vacuum) state.has_reported = false;
  for (std::size_t i = 0; i < cups_.size(); ++i) {
    CupHold& cup = state.cups[i];
    const bool on = is_on(i, command);
    cup.cannot_seal = state.cannot_seal;
    cup.least_hold_factor = std::numeric_limits<double>::infinity();
    const Vector3& p_EC = params_->cups[i].p_EC;
    const Pose X_WC = X_WE * Pose{Matrix3::Identity(), p_EC};
    const bool blows = command.blow_off && ((command.zones >> params_->cups[i].zone) & 1U) != 0;
    out.events.clear();
    cups_[i].prepare(world_state, X_WC, twist_at(V_WE, X_WE.R * p_EC), {on, blows}, dt, cup, out.cups[i], out.events);
    state.least_hold_factor = std::min(state.least_hold_factor, cup.least_hold_factor);
    for (GripperEvent& event : out.events) {
      if (event.kind == Kind::Seal && !told.seal) {
        told.seal = event;
        told.sealed_cup = i;
      }
      if (event.kind == Kind::NoSeal && !told.no_seal) told.no_seal = event;
      if (event.kind == Kind::BendWarning && !told.warning) told.warning = event;
      if (event.kind != Kind::HoldLost && event.kind != Kind::Released) continue;
      if (event.body == state.cup.body) told.end = event;
      if (event.kind != Kind::HoldLost) continue;
      event.kind = Kind::CupLost;
      event.cups = params_->cups[i].name;
      events.push_back(event);  // how many still hold: tell_cups
    }
  }
}

void Gripper::end_hold(const Told& told, GripperState& state, std::vector<GripperEvent>& events) const {
  if (state.cup.body < 0 || holding_cups(state, state.cup.body) > 0) return;
  GripperEvent event = told.end.value_or(GripperEvent{});
  if (!told.end) event.kind = Kind::Released;
  event.body = state.cup.body;
  events.push_back(event);
  state.cup.phase = cup::CupPhase::Free;
  state.cup.body = -1;
  state.cup.bend = state.cup.leak = 0.0;
  state.F_S = Wrench{};
}

void Gripper::begin_hold(const Told& told, GripperState& state, std::vector<GripperEvent>& events) const {
  if (state.cup.body < 0) {
    state.cup.body = held_by_most(state);
    if (state.cup.body >= 0) {
      std::size_t first = 0;
      while (!holds(state.cups[first], state.cup.body)) ++first;
      const Pose& X_PSi = state.cups[first].cup.X_PS;
      Vector3 p_ECi = params_->cups[first].p_EC;
      const double before = std::exchange(p_ECi.z(), 0.0);
      state.cup.X_PS = {X_PSi.R, X_PSi.p - X_PSi.R * p_ECi};
      state.is_established = state.has_warned = state.has_two_boxes = false;
      GripperEvent event;
      if (told.seal && told.seal->body == state.cup.body) {
        event = *told.seal;
        event.offset_P += state.cup.X_PS.p - state.cups[told.sealed_cup].cup.X_PS.p;
        event.length += before;
      }
      event.body = state.cup.body;
      events.push_back(event);
      return;
    }
  }
  if (told.no_seal && state.cup.body < 0 && !state.has_reported) {
    state.has_reported = true;
    events.push_back(*told.no_seal);
  }
  if (told.warning && !state.has_warned) {
    state.has_warned = true;
    events.push_back(*told.warning);
  }
}

std::string Gripper::names_of_holding(const GripperState& state, int body) const {
  std::string names;
  for (std::size_t i = 0; i < cups_.size(); ++i) {
    if (holds(state.cups[i], body)) names += (names.empty() ? "" : " ") + params_->cups[i].name;
  }
  return names;
}

void Gripper::tell_cups(GripperState& state, std::vector<GripperEvent>& events) const {
  for (GripperEvent& event : events) {
    if (event.kind == Kind::CupLost) event.holding = holding_cups(state, event.body);
  }
  if (state.cup.body < 0) return;
  GripperEvent event;
  event.of = static_cast<int>(cups_.size());
  const bool is_there = std::all_of(state.cups.begin(), state.cups.end(),
                                    [&](const auto& cup) { return !holds(cup, state.cup.body) || cup.is_established; });
  if (is_there && !state.is_established) {
    state.is_established = true;
    event.kind = Kind::CupsHold;
    event.body = state.cup.body;
    event.holding = holding_cups(state, event.body);
    event.cups = names_of_holding(state, event.body);
    events.push_back(event);
  }
  if (state.has_two_boxes) return;
  for (const CupHold& cup : state.cups) {
    if (cup.cup.phase == cup::CupPhase::Free || cup.cup.body == state.cup.body) continue;
    state.has_two_boxes = true;
    event.kind = Kind::TwoBoxes;
    event.body = cup.cup.body;
    event.cups = names_of_holding(state, event.body);
    events.push_back(event);
    return;
  }
}

/// Wrench, vacuum and bend of all as of one cup at E.
void Gripper::add_up(const cup::CupCommand& command, const Pose& X_WE, const physics::WorldState& world_state,
                     GripperState& state) const {
  state.is_letting_go = false;
  double weakest = -std::numeric_limits<double>::infinity(), deepest = 0.0;
  Wrench F_S_P;  // about the origin of S, in P
  bool is_holding = false;
  for (const CupHold& cup : state.cups) {
    const CupHold& hold = cup;
    state.is_letting_go = state.is_letting_go || hold.is_letting_go;
    deepest = hold.cup.pressure_gauge < 0.0 ? std::min(deepest, hold.cup.pressure_gauge)
              : deepest < 0.0               ? deepest
                                            : std::max(deepest, hold.cup.pressure_gauge);
    if (state.cup.body < 0 || !holds(cup, state.cup.body)) continue;
    is_holding = is_holding || hold.cup.phase == cup::CupPhase::Holding;
    weakest = std::max(weakest, hold.cup.pressure_gauge);
    const Vector3 force_P = hold.cup.X_PS.R * hold.F_S.force;
    F_S_P.force += force_P;
    F_S_P.torque += hold.cup.X_PS.R * hold.F_S.torque + (hold.cup.X_PS.p - state.cup.X_PS.p).cross(force_P);
  }
  if (state.cup.body < 0) {
    state.cup.pressure_gauge = command.vacuum ? 0.0 : deepest;
    return;
  }
  state.cup.phase = is_holding ? cup::CupPhase::Holding : cup::CupPhase::Releasing;
  state.cup.pressure_gauge = command.vacuum ? weakest : deepest;
  const Matrix3& R_PS = state.cup.X_PS.R;
  state.F_S = {R_PS.transpose() * F_S_P.force, R_PS.transpose() * F_S_P.torque};
  const Matrix3 R_WP = physics::pose_of(world_->model, world_state, physics::BodyId{state.cup.body}).R;
  state.cup.bend = cup::bend_angle(X_WE.R.transpose() * R_WP * R_PS);
}

}  // namespace snug::cell
