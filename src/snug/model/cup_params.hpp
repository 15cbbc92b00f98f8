// CupParams: everything the suction cup model needs to know. Defaults are estimates for a 70 mm bellows cup.
#pragma once

#include <numbers>

#include "snug/core/field.hpp"
#include "snug/model/cup_law.hpp"

namespace snug::model {

/// The five numbers of an axially symmetric 6x6 stiffness or damping matrix in its frame S1:
/// diag(lateral, lateral, axial, bend, bend, torsion) with (x, ry) = +coupling and (y, rx) = -coupling.
/// Positive definite when all diagonal entries are positive and lateral * bend > coupling^2.
struct CupElasticity {
  double lateral = 0.0;   ///< N/m (stiffness) or Ns/m (damping), along x and y
  double axial = 0.0;     ///< N/m or Ns/m, along z
  double bend = 0.0;      ///< Nm/rad or Nms/rad, about x and y
  double torsion = 0.0;   ///< Nm/rad or Nms/rad, about z
  double coupling = 0.0;  ///< N/rad or Ns/rad

  template <class Archive>
  void fields(Archive& a) {
    a("lateral", lateral, Range::NotNegative);
    a("axial", axial, Range::NotNegative);
    a("bend", bend, Range::NotNegative);
    a("torsion", torsion, Range::NotNegative);
    a("coupling", coupling, Range::Any);
  }
  bool operator==(const CupElasticity&) const = default;
};

/// When a lip that is told to grip finds a seal.
struct SealParams {
  double reach = 0.008;                               ///< m, largest gap between the free lip and the face
  double max_tilt = 15.0 * std::numbers::pi / 180.0;  ///< rad, between the lip plane and the face
  double max_overhang = 0.015;                        ///< m, how far the lip may stand over an edge of the face

  template <class Archive>
  void fields(Archive& a) {
    a("reach", reach, Range::NotNegative);
    a("max_tilt_deg", Degrees{max_tilt}, Range::Positive);
    a("max_overhang", max_overhang, Range::NotNegative);
  }
  bool operator==(const SealParams&) const = default;
};

/// Pressures are gauge: negative is vacuum.
struct VacuumParams {
  double pressure_gauge_hold = -6.0e4;      ///< Pa, settles here when sealed
  double pressure_gauge_blow = 5.0e3;       ///< Pa, settles here while blow-off is on
  double pressure_gauge_collapse = -1.2e4;  ///< Pa, bellows fully drawn in (and stiff) from here on
  double ambient_pressure_abs = 101325.0;   ///< Pa
  double evacuation_time = 0.20;            ///< s, time constant of drawing vacuum
  double vent_time = 0.030;                 ///< s, time constant of losing it
  double bellows_area = 2.83e-3;            ///< m^2, of the volume that the bellows sweeps
  double hose_volume = 2.0e-4;              ///< m^3, dead volume behind the bellows

  template <class Archive>
  void fields(Archive& a) {
    a("pressure_gauge_hold", pressure_gauge_hold, Range::Any);
    a("pressure_gauge_blow", pressure_gauge_blow, Range::NotNegative);
    a("pressure_gauge_collapse", pressure_gauge_collapse, Range::Any);
    a("ambient_pressure_abs", ambient_pressure_abs, Range::Positive);
    a("evacuation_time", evacuation_time, Range::Positive);
    a("vent_time", vent_time, Range::Positive);
    a("bellows_area", bellows_area, Range::NotNegative);
    a("hose_volume", hose_volume, Range::Positive);
  }
  bool operator==(const VacuumParams&) const = default;
};

/// When a sealed lip lets go. N is the normal force between lip and face, R the lip radius.
struct HoldLimits {
  double warn_bend = 35.0 * std::numbers::pi / 180.0;  ///< rad, the law softens beyond: a warning event
  double fail_bend = 45.0 * std::numbers::pi / 180.0;  ///< rad, moment of the law at its maximum: hold lost
  double peel_onset = 0.5;  ///< bending moment / (N R) at which the lip starts to lift (leak)
  double peel_full = 1.0;   ///< bending moment / (N R) at which it comes off
  double leak_gain = 0.5;   ///< loss of the vacuum set point per unit of excess over the onset

  template <class Archive>
  void fields(Archive& a) {
    a("warn_bend_deg", Degrees{warn_bend}, Range::Positive);
    a("fail_bend_deg", Degrees{fail_bend}, Range::Positive);
    a("peel_onset", peel_onset, Range::Positive);
    a("peel_full", peel_full, Range::Positive);
    a("leak_gain", leak_gain, Range::NotNegative);
  }
  bool operator==(const HoldLimits&) const = default;
};

/// How a cup lets go, as recorded releases show it (docs/theory/cup-release.md). Used with vacuum phases where
/// `growth` is above 0 and the blow-off goes on as the vacuum goes off, in place of release_push and of what CupParams
/// says of the axial direction without vacuum. Defaults: rounded from releases of seven masses (docs/decisions/0118).
struct ReleaseParams {
  double growth = 0.0;                    ///< m, length of the free open bellows less that of the shut one
  double shut_stiffness = 7000.0;         ///< N/m, axial, of folds that the vacuum presses together
  double open_stiffness = 700.0;          ///< N/m, axial, of the open bellows
  double damping = 11.0;                  ///< Ns/m, axial, shut and open
  double pressure_gauge_start = -1.40e4;  ///< Pa, once the valve moves; what is deeper is let in at once
  double volume = 0.8e-4;                 ///< m^3, behind the bellows
  double valve_delay = 0.0075;            ///< s, from the switch until the valve moves
  double valve_time = 0.060;              ///< s, from then until it is open
  double blow_flow = 1.7e-3;              ///< m^3/s at ambient pressure, of the blow-off through the open valve
  double peel_impulse = 0.08;             ///< Ns, of what the lip's contact lacks, until the lip has come off

  [[nodiscard]] bool is_used() const { return growth > 0.0; }
  template <class Archive>
  void fields(Archive& a) {
    a("growth", growth, Range::NotNegative);
    a("shut_stiffness", shut_stiffness, Range::Positive);
    a("open_stiffness", open_stiffness, Range::Positive);
    a("damping", damping, Range::NotNegative);
    a("pressure_gauge_start", pressure_gauge_start, Range::Any);
    a("volume", volume, Range::Positive);
    a("valve_delay", valve_delay, Range::NotNegative);
    a("valve_time", valve_time, Range::NotNegative);
    a("blow_flow", blow_flow, Range::NotNegative);
    a("peel_impulse", peel_impulse, Range::NotNegative);
  }
  bool operator==(const ReleaseParams&) const = default;
};

/// Frames: E the gripper's end, z toward the package; S the lip, z into the package. At rest and holding, S lies
/// hold_length along Ez. The spring acts between S1 (fixed to S) and S2 (fixed to E), both centre_from_lip before the
/// lip when undeformed: p_SS1 = (0, 0, -centre_from_lip), p_ES2 = (0, 0, hold_length - centre_from_lip).
struct CupParams {
  CupElasticity stiffness{2500.0, 6000.0, 5.0, 3.0, 0.0};  ///< where `law` is used: the law's, undeformed
  CupLaw law;
  CupElasticity damping{10.0, 15.0, 0.04, 0.025, 0.0};
  double hold_length = 0.050;          ///< m, E to S under vacuum
  double free_length = 0.072;          ///< m, E to S without vacuum
  double centre_from_lip = 0.025;      ///< m, centre of stiffness before the lip
  double free_stiffness_ratio = 0.25;  ///< stiffness without vacuum / stiffness under vacuum
  double free_damping_ratio = 0.25;    ///< damping without vacuum / damping under vacuum
  /// Share of the growth from hold_length to free_length that a cup has which lets go: 1 pushes with all of it, 0 lets
  /// go without a push. Counts with vacuum phases alone, and where `release` is not used.
  double release_push = 1.0;
  ReleaseParams release;
  double lip_radius = 0.035;          ///< m, unloaded
  double effective_diameter = 0.060;  ///< m, of the disc on which the vacuum acts
  double lip_friction = 0.5;          ///< Coulomb coefficient of lip on cardboard
  VacuumParams vacuum;
  SealParams seal;
  HoldLimits limits;

  template <class Archive>
  void fields(Archive& a) {
    a("stiffness", stiffness);
    a("law", law);
    a("damping", damping);
    a("hold_length", hold_length, Range::Positive);
    a("free_length", free_length, Range::Positive);
    a("centre_from_lip", centre_from_lip, Range::NotNegative);
    a("free_stiffness_ratio", free_stiffness_ratio, Range::Positive);
    a("free_damping_ratio", free_damping_ratio, Range::NotNegative);
    a("release_push", release_push, Range::Fraction);
    a("release", release);
    a("lip_radius", lip_radius, Range::Positive);
    a("effective_diameter", effective_diameter, Range::Positive);
    a("lip_friction", lip_friction, Range::NotNegative);
    a("vacuum", vacuum);
    a("seal", seal);
    a("hold_limits", limits);
  }
  bool operator==(const CupParams&) const = default;
};

void scale(CupElasticity& elasticity, double factor);
/// The stiffness, and that of the law.
void scale_stiffness(CupParams& cup, double factor);
/// The law's stiffness where nothing deforms it.
[[nodiscard]] CupElasticity undeformed_stiffness(const CupLaw& law);

}  // namespace snug::model
