// CellCup: a cup in the cell: what it seals to, what it does to that box in the coming step, and when it lets go.
#include "snug/cell/cell_cup.hpp"

#include <algorithm>
#include <cmath>

#include "snug/cup/release.hpp"

namespace snug::cell {
namespace {

/// A cup that found nothing says so after this long with the vacuum on; it keeps trying.
constexpr double kSealPatience = 0.4;  // s

physics::ElementQuery query_of(const CellWorld& world, const physics::WorldState& state, int body, const Pose& X_WE,
                               const Twist& V_WE) {
  physics::ElementQuery query;
  query.X_WE = X_WE;
  query.V_WE = V_WE;
  query.X_WB = physics::pose_of(world.model, state, physics::BodyId{body});
  query.V_WB = physics::twist_of(world.model, state, physics::BodyId{body});
  query.p_WBcm = state.bodies[static_cast<std::size_t>(body)].p_WBcm;
  return query;
}

Vector3 half_of(const CellWorld& world, int body) {
  return std::get<geometry::Box>(world.model.bodies[static_cast<std::size_t>(body)].geoms[0].shape).half;
}

}  // namespace

CellCup::CellCup(const model::CupParams& params, cup::CupMode mode, bool stays_open, const CellWorld& world)
    : params_(params), letting_go_(params), mode_(mode), stays_open_(stays_open), world_(&world) {
  letting_go_.free_length = params.hold_length + params.release_push * (params.free_length - params.hold_length);
}

CellCup::Target CellCup::find_target(const physics::WorldState& world_state, const Pose& X_WE) const {
  model::CupParams loose = params_;  // anything in front of the cup, sealable or not
  loose.seal.reach = params_.free_length;
  loose.seal.max_tilt = 1.5;
  loose.seal.max_overhang = params_.effective_diameter;
  Target nearest;
  for (const physics::BodyId id : world_->parcels) {
    if (!world_state.bodies[static_cast<std::size_t>(id.index)].is_present) continue;
    const Pose X_WP = physics::pose_of(world_->model, world_state, id);
    const Vector3 half = half_of(*world_, id.index);
    if ((X_WP.p - X_WE.p).norm() > half.norm() + 2.0 * params_.free_length) continue;
    const auto seal = cup::try_seal(loose, X_WE, half, X_WP);
    if (seal && (nearest.body < 0 || seal->length < nearest.hit.length)) nearest = {id.index, *seal, half, X_WP};
  }
  return nearest;
}

void CellCup::try_to_seal(const Target& target, const Pose& X_WE, const cup::CupCommand& command, CupHold& state,
                          std::vector<GripperEvent>& events) const {
  if (!command.vacuum) return;
  GripperEvent event;
  event.body = target.body;
  if (target.body >= 0 && !state.cannot_seal && !state.has_come_off) {
    const auto seal = cup::try_seal(params_, X_WE, target.half, target.X_WP);
    if (seal) {
      state.cup.phase = cup::CupPhase::Holding;
      state.cup.body = target.body;
      state.cup.X_PS = seal->X_PS;
      if (mode_ == cup::CupMode::Holding) state.cup.pressure_gauge = set_point(state);
      state.has_warned = false;
      state.is_established = false;
      event.kind = GripperEvent::Kind::Seal;
      const Vector3 outward = -seal->X_PS.R.col(2);
      event.offset_P = seal->X_PS.p - outward.cwiseProduct(target.half).cwiseProduct(outward.cwiseAbs());
      event.length = seal->length;
      event.angle = seal->tilt;
      events.push_back(event);
      return;
    }
    event.no_seal = seal.error();
  }
  if (state.has_reported || state.vacuum_time < kSealPatience) return;
  state.has_reported = true;
  event.kind = GripperEvent::Kind::NoSeal;
  events.push_back(event);
}

void CellCup::let_go(GripperEvent event, CupHold& state, std::vector<GripperEvent>& events) const {
  event.body = state.cup.body;
  events.push_back(event);
  state.has_come_off = stays_open_ && event.kind == GripperEvent::Kind::HoldLost;
  state.cup.phase = cup::CupPhase::Free;
  state.cup.body = -1;
  state.cup.length = 0.0;
  state.cup.leak = 0.0;
  state.cup.bend = 0.0;
  state.F_S = Wrench{};
  if (event.kind == GripperEvent::Kind::HoldLost || mode_ == cup::CupMode::Holding) state.cup.pressure_gauge = 0.0;
}

void CellCup::check_hold(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE, double dt,
                         const cup::SuctionCup& cup, CupHold& state, std::vector<GripperEvent>& events) const {
  const physics::ElementQuery query = query_of(*world_, world_state, state.cup.body, X_WE, V_WE);
  state.F_S = cup.lip_wrench(query);
  state.cup.bend = cup::bend_angle(X_WE.R.transpose() * query.X_WB.R * state.cup.X_PS.R);
  GripperEvent event;
  event.angle = state.cup.bend;
  const bool is_holding = state.cup.phase == cup::CupPhase::Holding;
  const bool is_recorded = !is_holding && state.cup.release_time > 0.0;
  if (is_recorded && !cup::peel_lip(params_, state.F_S, dt, state.cup)) return;
  if (is_recorded || (!is_holding && mode_ == cup::CupMode::Holding)) {
    event.kind = GripperEvent::Kind::Released;
    let_go(event, state, events);
    return;
  }
  // While the cup draws a box in that cannot follow yet it pulls harder than the vacuum of the moment holds; the foam
  // of the lip bridges that. Limits count once the vacuum is nearly there.
  state.is_established =
      state.is_established || !is_holding || state.cup.pressure_gauge <= cup::kEstablishedVacuum * set_point(state);
  const bool may_leak = is_holding && state.is_established && mode_ == cup::CupMode::Phases;
  state.cup.leak = may_leak ? cup::find_leak(params_, state.cup.pressure_gauge, state.F_S) : 0.0;
  if (is_holding && state.is_established) {
    state.least_hold_factor =
        std::min(state.least_hold_factor, cup::find_hold_factor(params_, state.cup.pressure_gauge, state.F_S));
  }
  if (state.is_established) {
    event.loss = cup::find_hold_loss(params_, state.cup.pressure_gauge, state.F_S, state.cup.bend);
    if (event.loss != cup::HoldLoss::None) {
      event.kind = is_holding ? GripperEvent::Kind::HoldLost : GripperEvent::Kind::Released;
      let_go(event, state, events);
      return;
    }
  }
  if (state.cup.bend > params_.limits.warn_bend && !state.has_warned) {
    state.has_warned = true;
    event.kind = GripperEvent::Kind::BendWarning;
    event.body = state.cup.body;
    events.push_back(event);
  }
}

void CellCup::advance_gas(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE,
                          const cup::CupCommand& command, double dt, CupHold& state) const {
  if (state.cup.phase != cup::CupPhase::Free) {
    const physics::ElementQuery query = query_of(*world_, world_state, state.cup.body, X_WE, V_WE);
    const Vector3 p_BS_W = query.X_WB.R * state.cup.X_PS.p, p_ES_W = query.X_WB.p + p_BS_W - X_WE.p;
    const Vector3 v_ES_W =
        query.V_WB.linear + query.V_WB.angular.cross(p_BS_W) - V_WE.linear - V_WE.angular.cross(p_ES_W);
    const double length = (X_WE.R.transpose() * p_ES_W).z();
    // Recordings are of releases with blow-off: others are those of the phases.
    const bool begins = state.cup.phase == cup::CupPhase::Holding && command.blow_off && params_.release.is_used();
    if (!command.vacuum && (begins || state.cup.release_time > 0.0)) {
      // A step's pressure is that halfway through it, so the second half of the last step comes first.
      const double rate = (X_WE.R.transpose() * v_ES_W).z();
      if (!begins) cup::advance_release(params_, command.blow_off, state.cup.length, 0.5 * dt, state.cup);
      cup::advance_release(params_, command.blow_off, length + 0.5 * dt * rate, 0.5 * dt, state.cup);
      return;
    }
    cup::follow_length(params_, length, state.cup);
  }
  if (command.vacuum) state.cup.release_time = state.cup.peel_impulse = 0.0;
  cup::advance_pressure(params_, command, dt, state.cup);
}

void CellCup::prepare(const physics::WorldState& world_state, const Pose& X_WE, const Twist& V_WE,
                      const cup::CupCommand& command, double dt, CupHold& state, CupStep& out,
                      std::vector<GripperEvent>& events) const {
  out.element = nullptr;
  out.body = out.ignored = -1;
  if (mode_ == cup::CupMode::Phases) advance_gas(world_state, X_WE, V_WE, command, dt, state);
  state.vacuum_time = command.vacuum ? state.vacuum_time + dt : 0.0;
  if (!command.vacuum) state.has_reported = false;
  if (command.vacuum) state.is_letting_go = false;
  if (!command.vacuum) state.has_come_off = false;
  const auto present_cup = [&] {
    if (state.cup.release_time > 0.0 && state.cup.phase == cup::CupPhase::Releasing)
      return cup::releasing_cup(params_, state.cup.pressure_gauge, state.cup.length, state.cup.X_PS);
    return cup::cup_at(params_of(state), state.cup.pressure_gauge, state.cup.X_PS);
  };
  if (state.cup.phase != cup::CupPhase::Free) {
    if (!command.vacuum && state.cup.phase == cup::CupPhase::Holding) {
      state.cup.phase = cup::CupPhase::Releasing;
      state.is_letting_go = true;
    }
    out.cup = present_cup();
    check_hold(world_state, X_WE, V_WE, dt, out.cup, state, events);
  }
  if (state.cup.phase == cup::CupPhase::Free) {
    const Target target = find_target(world_state, X_WE);
    out.ignored = target.body;
    try_to_seal(target, X_WE, command, state, events);
    const bool opens = state.cup.release_time > 0.0;  // the bellows of a cup that has just let go as recorded
    const double length = opens ? params_.hold_length + params_.release.growth
                                : cup::unloaded_length(params_of(state), state.cup.pressure_gauge);
    if (state.cup.phase == cup::CupPhase::Free && mode_ == cup::CupMode::Phases && target.body >= 0 &&
        target.hit.length < length) {
      out.push =
          cup::LipPush(opens ? params_.release.open_stiffness : params_.free_stiffness_ratio * params_.stiffness.axial,
                       opens ? params_.release.damping : params_.free_damping_ratio * params_.damping.axial, length,
                       target.hit.X_PS.p, -target.hit.X_PS.R.col(2));
      out.element = &out.push;
      out.body = target.body;
    }
    if (state.cup.phase != cup::CupPhase::Free) out.cup = present_cup();
  }
  if (state.cup.phase != cup::CupPhase::Free) {
    out.element = &out.cup;
    out.body = state.cup.body;
    out.ignored = state.cup.body;
  }
}

}  // namespace snug::cell
