// ParcelType, Parcel, Item, Sequence: the boxes to be packed and the order in which they come.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/model/body.hpp"
#include "snug/model/material.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::model {

/// Nominal box of one kind.
struct ParcelType {
  std::string name;
  Vector3 size = Vector3::Constant(0.1);  ///< m, along Px, Py, Pz
  double mass = 1.0;                      ///< kg
  bool operator==(const ParcelType&) const = default;
};

/// What may be done to a box.
struct Handling {
  bool upright_only = false;       ///< only with +Pz up
  bool no_stack = false;           ///< nothing may stand on it
  std::optional<double> max_load;  ///< kg that may rest on it; absent: any
  bool operator==(const Handling&) const = default;
};

/// One individual box. Frame P: geometric centre, axes along the edges.
struct Parcel {
  std::string id;
  std::string type;                       ///< name of a ParcelType
  Vector3 size = Vector3::Constant(0.1);  ///< m, along Px, Py, Pz, as measured (before parcel_clearance)
  SpatialInertia inertia;                 ///< mass; com in P; inertia about the com, axes of P
  MaterialId material;
  Handling handling;
  bool operator==(const Parcel&) const = default;
};

/// One homogeneous cuboid inside a box, axes along P.
struct Layer {
  double density = 0.0;                   ///< kg/m^3
  Vector3 size = Vector3::Constant(0.1);  ///< m
  Vector3 centre = Vector3::Zero();       ///< p_PL, m
  bool operator==(const Layer&) const = default;
};

/// The empty box: a hollow cuboid of uniform density and uniform wall thickness, its outside the size of the box.
struct Shell {
  double mass = 0.0;       ///< kg
  double thickness = 0.0;  ///< m
  bool operator==(const Shell&) const = default;
};

/// Mass, centre of mass and inertia about it of a shell with layers inside: report eqs 12-14, with the parallel-axis
/// term m (d^2 I - d d^T), which the printed eq. 13 lacks.
[[nodiscard]] SpatialInertia compute_layered_inertia(const Vector3& size, const std::optional<Shell>& shell,
                                                     const std::vector<Layer>& layers);

/// The axis of P that points up at the pick location.
enum class UpAxis { X, Y, Z };

struct Item {
  std::string parcel;  ///< id
  UpAxis up = UpAxis::Z;
  int up_sign = 1;                      ///< +1 or -1: which end of that axis is up
  std::optional<double> yaw;            ///< rad, multiple of pi/2, about Az; absent: the aligner's rule decides
  std::optional<HeavySide> heavy_side;  ///< absent: the aligner's
  Vector3 shift_A = Vector3::Zero();    ///< m, in A: how far it stands from where the aligner's corner puts it
  double turn = 0.0;                    ///< rad, about the vertical through its middle: the same
  bool operator==(const Item&) const = default;
};

/// What somebody else reached with a sequence, as published.
struct Reported {
  std::string agent;
  std::optional<int> packed_count;        ///< how many of the first items
  std::optional<double> filling_percent;  ///< as printed, of whatever container the source counts with
  bool operator==(const Reported&) const = default;
};

struct Sequence {
  std::string name;
  std::vector<Item> items;
  std::optional<double> task_stiffness;  ///< 1/s^2, overrides the controller's
  std::vector<Reported> reported;        ///< what others reached; the first is the one to compare a run with
  bool operator==(const Sequence&) const = default;
};

/// R_AP of a box that stands with `up` (of the given sign) along Az. At yaw 0 and sign +1 the two axes that follow
/// `up` in the order x, y, z, x lie along Ax and Ay; sign -1 turns that by pi about Ax first; yaw turns about Az.
[[nodiscard]] Matrix3 standing_rotation(UpAxis up, int up_sign, double yaw);

/// X_WP of a box of this size standing on the aligner's support with its corner at A's origin, edges along +Ax, +Ay.
[[nodiscard]] Pose standing_pose(const Aligner& aligner, const Vector3& size, const Matrix3& R_AP);

/// True when body -z (the plate side) points toward the aligner's corner (negative Ax or negative Ay), and also when
/// Pz is vertical, where the question is empty.
[[nodiscard]] bool has_heavy_side_at_corner(const Matrix3& R_AP);

}  // namespace snug::model
