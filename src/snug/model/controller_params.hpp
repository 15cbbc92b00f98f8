// ControllerParams, ToolParams: the robot's side: how it moves between waypoints and what it carries.
#pragma once

#include <string>
#include <vector>

#include "snug/core/field.hpp"
#include "snug/model/body.hpp"
#include "snug/model/material.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::model {

/// Limits of the motion to a waypoint whose name starts with `prefix`. Of all that match, the last in the list counts.
struct MoveLimits {
  std::string prefix;
  double precision = 0.005;            ///< m, arrival when |position error| + angle / convergence angle per metre <= it
  double max_acceleration = 3.0;       ///< m/s^2 (A)
  double max_speed = 0.5;              ///< m/s (V)
  double max_turn_speed = 1.5;         ///< rad/s (W)
  double max_turn_acceleration = 1.5;  ///< rad/s^2 (dW)

  template <class Archive>
  void fields(Archive& a) {
    a("precision", precision, Range::Positive);
    a("max_acceleration", max_acceleration, Range::Positive);
    a("max_speed", max_speed, Range::Positive);
    a("max_turn_speed", max_turn_speed, Range::Positive);
    a("max_turn_acceleration", max_turn_acceleration, Range::Positive);
  }
  bool operator==(const MoveLimits&) const = default;
};

/// Shift of the waypoints whose names start with one of the prefixes. Every matching correction of a layer adds.
struct Correction {
  std::vector<std::string> prefixes;
  Vector3 offset = Vector3::Zero();  ///< m, in W
  bool operator==(const Correction&) const = default;
};

/// A named set of site corrections; none is used unless asked for.
struct CorrectionLayer {
  std::string name;
  std::vector<Correction> corrections;
  bool with_phases = true;  ///< made for a cup with vacuum phases; false: for one that holds and lets go at once
  bool operator==(const CorrectionLayer&) const = default;
};

struct ControllerParams {
  double tick = 0.008;                       ///< s
  double task_stiffness = 10.0;              ///< 1/s^2; critically damped
  double vacuum_wait = 0.5;                  ///< s, pose held after the vacuum command changed
  double convergence_deg_per_metre = 500.0;  ///< degrees of orientation error that weigh as much as one metre
  /// Of the URDF's joint speeds that its programs may use, at most the robot's own; fast motions use the robot's.
  double velocity_fraction = 1.0;
  Pose X_WE_start;  ///< tool pose at the start
  std::vector<MoveLimits> limits;
  std::vector<CorrectionLayer> correction_layers;

  template <class Archive>
  void fields(Archive& a) {
    a("tick", tick, Range::Positive);
    a("task_stiffness", task_stiffness, Range::Positive);
    a("vacuum_wait", vacuum_wait, Range::NotNegative);
    a("convergence_deg_per_metre", convergence_deg_per_metre, Range::Positive);
    a("velocity_fraction", velocity_fraction, Range::Fraction);
  }
  bool operator==(const ControllerParams&) const = default;
};

/// What the robot carries, fixed to frame E (z toward the package).
struct ToolParams {
  double mass = 1.0;                    ///< kg
  std::vector<PlacedShape> rod_shapes;  ///< touch everything (their X_BG is X_EG)
  std::vector<PlacedShape> cup_shapes;  ///< touch everything but the box that is held or about to be
  MaterialId rod_material;
  MaterialId cup_material;
  bool operator==(const ToolParams&) const = default;
};

}  // namespace snug::model
