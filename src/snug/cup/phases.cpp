// Vacuum phases: when the lip seals, how pressure drives the cup, when it lets go, and the push of an unsealed lip.
#include "snug/cup/phases.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "snug/core/input_error.hpp"

namespace snug::cup {
namespace {

struct FaceHit {
  int axis = -1;  ///< of the box; -1: the axis of the cup misses it
  double sign = 1.0;
  double distance = 0.0;  ///< from E along Ez, m
  Vector3 p_P = Vector3::Zero();
};

/// Where the ray from E along Ez enters the box (slab method, package frame).
FaceHit find_face(const Pose& X_PE, const Vector3& half) {
  FaceHit hit;
  const Vector3 start = X_PE.p, direction = X_PE.R.col(2);
  double entry = -std::numeric_limits<double>::infinity(), exit = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (std::abs(direction[i]) < 1e-12) {
      if (std::abs(start[i]) > half[i]) return {};
      continue;
    }
    const double sign = direction[i] > 0.0 ? 1.0 : -1.0;
    const double near = (-sign * half[i] - start[i]) / direction[i];
    exit = std::min(exit, (sign * half[i] - start[i]) / direction[i]);
    if (near > entry) {
      entry = near;
      hit.axis = i;
      hit.sign = -sign;
    }
  }
  if (hit.axis < 0 || entry > exit) return {};
  hit.distance = entry;
  hit.p_P = start + entry * direction;
  return hit;
}

/// Lip frame on the face: z into the package, x along the gripper's x as far as the face allows.
Matrix3 lip_axes(const FaceHit& hit, const Matrix3& R_PE) {
  const Vector3 z = -hit.sign * Vector3::Unit(hit.axis);
  Vector3 x = R_PE.col(0) - z * z.dot(R_PE.col(0));
  x.normalize();
  Matrix3 R;
  R << x, z.cross(x), z;
  return R;
}

/// Normal force between lip and face, N: suction on the sealed disc less what pulls the package away.
double lip_force(const model::CupParams& params, double pressure_gauge, const Wrench& F_S) {
  const double area = 0.25 * std::numbers::pi * params.effective_diameter * params.effective_diameter;
  return -pressure_gauge * area + F_S.force.z();
}

}  // namespace

const char* name_of(CupMode mode) { return mode == CupMode::Holding ? "holding" : "phases"; }

CupMode cup_mode_of(const std::string& name, const std::string& where) {
  for (const CupMode mode : {CupMode::Holding, CupMode::Phases})
    if (name == name_of(mode)) return mode;
  throw InputError(where, "cup", "'" + name + "'", "holding or phases");
}

const char* describe(NoSeal reason) {
  switch (reason) {
    case NoSeal::OutOfReach:
      return "no face within reach of the lip";
    case NoSeal::TooTilted:
      return "face too tilted for the lip";
    case NoSeal::OverEdge:
      return "lip over an edge of the face";
  }
  return "";
}

const char* describe(HoldLoss loss) {
  switch (loss) {
    case HoldLoss::None:
      return "held";
    case HoldLoss::Tension:
      return "pulled off";
    case HoldLoss::Shear:
      return "slipped off";
    case HoldLoss::Peel:
      return "peeled off";
    case HoldLoss::Bending:
      return "bent beyond the cup's capacity";
  }
  return "";
}

Expected<Seal, NoSealReason> try_seal(const model::CupParams& params, const Pose& X_WE, const Vector3& half,
                                      const Pose& X_WP) {
  const Pose X_PE = X_WP.inverse() * X_WE;
  const FaceHit hit = find_face(X_PE, half);
  NoSealReason no;
  no.gap = std::numeric_limits<double>::infinity();
  if (hit.axis < 0) return Unexpected<NoSealReason>(no);
  no.gap = hit.distance - params.free_length;
  no.tilt = std::acos(std::clamp(-hit.sign * X_PE.R(hit.axis, 2), -1.0, 1.0));
  const double radius = 0.5 * params.effective_diameter;
  for (int i = 0; i < 3; ++i) {
    if (i != hit.axis) no.overhang = std::max(no.overhang, std::abs(hit.p_P[i]) + radius - half[i]);
  }
  if (no.gap > params.seal.reach || hit.distance < 0.0) return Unexpected<NoSealReason>(no);
  no.reason = NoSeal::TooTilted;
  if (no.tilt > params.seal.max_tilt) return Unexpected<NoSealReason>(no);
  no.reason = NoSeal::OverEdge;
  if (no.overhang > params.seal.max_overhang) return Unexpected<NoSealReason>(no);
  return Seal{Pose{lip_axes(hit, X_PE.R), hit.p_P}, hit.distance, no.tilt};
}

double drawn_in(const model::CupParams& params, double pressure_gauge) {
  const double x = std::clamp(pressure_gauge / params.vacuum.pressure_gauge_collapse, 0.0, 1.0);
  return x * x * (3.0 - 2.0 * x);
}

double unloaded_length(const model::CupParams& params, double pressure_gauge) {
  return params.free_length + (params.hold_length - params.free_length) * drawn_in(params, pressure_gauge);
}

SuctionCup cup_at(const model::CupParams& params, double pressure_gauge, const Pose& X_PS) {
  const double s = drawn_in(params, pressure_gauge);
  const double length = unloaded_length(params, pressure_gauge);
  const double stiffness = params.free_stiffness_ratio + s * (1.0 - params.free_stiffness_ratio);
  const double damping = params.free_damping_ratio + s * (1.0 - params.free_damping_ratio);
  model::CupLaw law = params.law;
  law.scale(stiffness);
  return {stiffness * as_matrix(params.stiffness),
          damping * as_matrix(params.damping),
          Pose{Matrix3::Identity(), Vector3(0.0, 0.0, length - params.centre_from_lip)},
          X_PS,
          Pose{Matrix3::Identity(), Vector3(0.0, 0.0, -params.centre_from_lip)},
          law};
}

void advance_pressure(const model::CupParams& params, const CupCommand& command, double dt, CupState& state) {
  const model::VacuumParams& vacuum = params.vacuum;
  double wanted = 0.0;
  if (command.vacuum && state.phase == CupPhase::Holding) {
    wanted = vacuum.pressure_gauge_hold * state.supply * (1.0 - state.leak);
  } else if (command.blow_off && !command.vacuum) {
    wanted = vacuum.pressure_gauge_blow;
  }
  const double time = wanted < state.pressure_gauge ? vacuum.evacuation_time : vacuum.vent_time;
  state.pressure_gauge = wanted + (state.pressure_gauge - wanted) * std::exp(-dt / time);
}

void follow_length(const model::CupParams& params, double length, CupState& state) {
  const model::VacuumParams& vacuum = params.vacuum;
  const double volume = vacuum.bellows_area * std::max(length, 0.0) + vacuum.hose_volume;
  if (state.phase != CupPhase::Free && state.length > 0.0) {
    const double volume_before = vacuum.bellows_area * state.length + vacuum.hose_volume;
    state.pressure_gauge =
        (vacuum.ambient_pressure_abs + state.pressure_gauge) * (volume_before / volume) - vacuum.ambient_pressure_abs;
  }
  state.length = state.phase == CupPhase::Free ? 0.0 : std::max(length, 0.0);
}

double find_leak(const model::CupParams& params, double pressure_gauge, const Wrench& F_S) {
  const double normal = lip_force(params, pressure_gauge, F_S);
  if (normal <= 0.0) return 1.0;
  const double excess = F_S.torque.head<2>().norm() / (normal * params.lip_radius) - params.limits.peel_onset;
  return std::clamp(params.limits.leak_gain * excess, 0.0, 1.0);
}

HoldLoss find_hold_loss(const model::CupParams& params, double pressure_gauge, const Wrench& F_S, double bend) {
  if (bend >= params.limits.fail_bend) return HoldLoss::Bending;
  const double normal = lip_force(params, pressure_gauge, F_S);
  if (normal <= 0.0) return HoldLoss::Tension;
  const double radius = params.lip_radius;
  if (F_S.torque.head<2>().norm() > params.limits.peel_full * normal * radius) return HoldLoss::Peel;
  const double shear = F_S.force.head<2>().norm() / (params.lip_friction * normal);
  const double twist = F_S.torque.z() / (params.lip_friction * normal * radius);
  if (shear * shear + twist * twist > 1.0) return HoldLoss::Shear;
  return HoldLoss::None;
}

double find_lacking_force(const model::CupParams& params, double pressure_gauge, const Wrench& F_S) {
  const double peel = F_S.torque.head<2>().norm() / (params.limits.peel_full * params.lip_radius);
  const double slip = std::hypot(F_S.force.head<2>().norm(), F_S.torque.z() / params.lip_radius);
  const double needed = params.lip_friction > 0.0 ? std::max(peel, slip / params.lip_friction) : peel;
  return needed - lip_force(params, pressure_gauge, F_S);
}

double find_hold_factor(const model::CupParams& params, double pressure_gauge, const Wrench& F_S) {
  // The limits of find_hold_loss are of the form `load <= share * (suction + pull)` with load and pull proportional to
  // the wrench.
  const double suction = lip_force(params, pressure_gauge, Wrench{}), pull = F_S.force.z();
  const auto factor = [&](double load, double share) {
    const double growth = load - share * pull;
    return growth > 0.0 ? std::max(0.0, share * suction) / growth : std::numeric_limits<double>::infinity();
  };
  const double radius = params.lip_radius;
  const double slip = std::hypot(F_S.force.head<2>().norm(), F_S.torque.z() / radius);
  return std::min({factor(0.0, 1.0), factor(F_S.torque.head<2>().norm(), params.limits.peel_full * radius),
                   factor(slip, params.lip_friction)});
}

double carried_hold_factor(const model::CupParams& params, const SpatialInertia& box_S, const Vector3& acceleration_S) {
  const Vector3 force = box_S.mass * acceleration_S;
  return find_hold_factor(params, params.vacuum.pressure_gauge_hold, {force, box_S.com.cross(force)});
}

double sensed_hold_factor(const model::CupParams& params, double pressure_gauge, const Wrench& F_E) {
  if (pressure_gauge > kEstablishedVacuum * params.vacuum.pressure_gauge_hold) {
    return std::numeric_limits<double>::infinity();
  }
  const Vector3 p_ES(0.0, 0.0, params.hold_length);
  return find_hold_factor(params, pressure_gauge, {-F_E.force, p_ES.cross(F_E.force) - F_E.torque});
}

physics::ElementResponse LipPush::evaluate(const physics::ElementQuery& query) const noexcept {
  physics::ElementResponse response;
  const Vector3 n = query.X_WB.R * n_P_;  // outward: toward the gripper
  const Vector3 p_WS = query.X_WB * p_PS_;
  const double compression = length_ - n.dot(query.X_WE.p - p_WS);
  if (compression <= 0.0) return response;
  const Vector3 arm = p_WS - query.p_WBcm;
  const Vector3 v_body = query.V_WB.linear + query.V_WB.angular.cross(p_WS - query.X_WB.p);
  const double closing = n.dot(v_body - query.V_WE.linear);
  const double push = std::max(0.0, stiffness_ * compression + damping_ * closing);
  Vector6 direction;
  direction << -n, -arm.cross(n);
  response.wrench = push * direction;
  response.energy = 0.5 * stiffness_ * compression * compression;
  response.stiffness = stiffness_ * direction * direction.transpose();
  if (push > 0.0) response.damping = damping_ * direction * direction.transpose();
  return response;
}

}  // namespace snug::cup
