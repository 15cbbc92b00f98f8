// Body, Container, Aligner, Spring, Drops: the things of a scene that are not parcels of a sequence.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "snug/geometry/shape.hpp"
#include "snug/model/cup_params.hpp"
#include "snug/model/material.hpp"
#include "snug/model/pose_path.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::model {

/// A convex shape fixed to a body (or to frame A of the aligner, or E of the tool).
struct PlacedShape {
  geometry::Shape shape = geometry::Box{};
  Pose X_BG;  ///< the shape's own frame G in the carrier's frame
  bool operator==(const PlacedShape&) const = default;
};

enum class BodyKind {
  Dynamic,    ///< moves by forces
  Static,     ///< never moves
  Kinematic,  ///< moves with its constant twist or along its path, whatever it meets
};

/// One rigid body, B. Static bodies have no meaningful inertia.
struct Body {
  std::string name;
  BodyKind kind = BodyKind::Dynamic;
  std::vector<PlacedShape> shapes;  ///< at least one
  MaterialId material;
  Pose X_WB;                ///< at appears_at
  Twist V_WB;               ///< at appears_at; linear part at the origin of B, in W. A kinematic body keeps it:
                            ///< it turns about its own origin while that moves straight
  SpatialInertia inertia;   ///< dynamic bodies only
  std::string parcel;       ///< id of the parcel the body is, or empty
  double appears_at = 0.0;  ///< s; the body is absent before
  Vector3 surface_velocity = Vector3::Zero();  ///< m/s, of its surface against it, in B: a belt that runs
  std::optional<PosePath> path;                ///< of a kinematic body, in place of its twist
  bool is_asleep = false;                      ///< at the start: rests until something touches it
  bool operator==(const Body&) const = default;
};

/// Open box made of a floor and four walls, or a pallet: the floor alone. Frame T: centre of the inner floor, z up, x
/// and y along the inner edges.
struct Container {
  std::string name;
  Pose X_WT;
  Vector3 inner_size = Vector3(0.57, 0.37, 0.25);  ///< m, along Tx, Ty, Tz (depth from floor to rim)
  double wall_thickness = 0.010;                   ///< m
  double floor_thickness = 0.010;                  ///< m
  MaterialId material;
  bool has_walls = true;  ///< false: a slab of inner_size; inner_size.z is how high boxes may stand
  bool holds_all = true;  ///< false: parcels that fit in no orientation are no error; packing says why it leaves them
  bool operator==(const Container&) const = default;
};

/// Floor and four walls of a container in T, disjoint inside and flush at their faces: the floor and the two walls
/// across x run the full outer width, the walls across y stand between those. Without walls: the floor, as wide as
/// inside.
[[nodiscard]] std::vector<PlacedShape> make_walls(const Container& container);

/// Inner volume, m^3.
[[nodiscard]] inline double compute_volume(const Container& container) { return container.inner_size.prod(); }

/// Which way the heavy side of a box faces when it stands on edge at the aligner.
enum class HeavySide {
  Corner,  ///< body -z (the plate side) toward the corner of the aligner
  Away,    ///< body -z away from the corner
  Any,     ///< left to the yaw rule
};

/// How the 90-degree yaw of a box at the aligner is chosen when the sequence does not give it.
enum class YawRule {
  NearestPick,  ///< the one that puts the pick waypoint nearest the middle of the top face
  Zero,         ///< always 0
};

/// Corner in which boxes appear. Frame A: a box touches the planes A.x = 0 and A.y = 0 from the positive side.
struct Aligner {
  Pose X_WA;
  double support_height = 0.0;      ///< m, world z of the surface the boxes stand on
  std::vector<PlacedShape> plates;  ///< stop plates in A (their X_BG is X_AG); static
  MaterialId material;              ///< of the plates
  YawRule yaw_rule = YawRule::NearestPick;
  HeavySide heavy_side = HeavySide::Corner;
  bool operator==(const Aligner&) const = default;
};

/// The holder travels straight to a pose while turning about a fixed axis; both follow one quintic in time.
struct StraightMove {
  double start = 0.0;     ///< s
  double duration = 1.0;  ///< s, > 0
  Pose X_WH;              ///< where it ends
  bool operator==(const StraightMove&) const = default;
};

/// The holder turns about a fixed axis through p_WA; the angle follows a quintic in time.
struct SwingMove {
  double start = 0.0;                 ///< s
  double duration = 1.0;              ///< s, > 0
  Vector3 p_WA = Vector3::Zero();     ///< a point of the axis, m
  Vector3 axis_W = Vector3::UnitZ();  ///< unit
  double angle = 0.0;                 ///< rad
  bool operator==(const SwingMove&) const = default;
};

using HolderMove = std::variant<StraightMove, SwingMove>;

/// 6D spring-damper (the law of the cup) between a driven holder H and frame S of a body; undeformed when H = S.
struct Spring {
  std::string name;
  std::string body;               ///< name of a dynamic body
  Pose X_BS;                      ///< attachment on the body
  CupElasticity stiffness;        ///< N/m and Nm/rad
  CupElasticity damping;          ///< Ns/m and Nms/rad
  Pose X_WH;                      ///< the holder at time 0
  std::vector<HolderMove> moves;  ///< in order of time, not overlapping; the holder rests between them
  bool operator==(const Spring&) const = default;
};

struct HolderState {
  Pose X_WH;
  Twist V_WH;  ///< linear part at H's origin, in W
};

/// Where the holder of a spring is at `time` [s] >= 0.
[[nodiscard]] HolderState holder_at(const Spring& spring, double time);

/// A force and a torque on a dynamic body for some time.
struct AppliedWrench {
  std::string body;                  ///< name of a dynamic body
  Vector3 force = Vector3::Zero();   ///< N
  Vector3 torque = Vector3::Zero();  ///< Nm
  bool is_in_body = false;           ///< force and torque turn with the body; else they are in W
  std::optional<Vector3> p_BQ;       ///< point of the body at which the force acts, m; absent: the centre of mass
  double start = 0.0;                ///< s
  double end = std::numeric_limits<double>::infinity();  ///< s, > start
  bool operator==(const AppliedWrench&) const = default;
};

/// Where a kinematic body that has appeared is at `time` [s].
[[nodiscard]] Pose kinematic_pose_at(const Body& body, double time);
/// Its twist: linear part at the origin of B, in W.
[[nodiscard]] Twist kinematic_twist_at(const Body& body, double time);

/// Boxes that fall into a container one after the other: type, yaw and place uniform, whole box inside the walls.
/// Boxes have the nominal size and mass of their type and uniform density.
struct Drops {
  std::string container;
  std::vector<std::string> types;  ///< names of parcel types, drawn with equal chance
  int count = 12;
  double start = 0.0;       ///< s, first box
  double interval = 0.5;    ///< s
  double clearance = 0.05;  ///< m, lower face above the highest corner of all boxes (or the floor)
  std::uint64_t seed = 1;
  MaterialId material;
  bool operator==(const Drops&) const = default;
};

}  // namespace snug::model
