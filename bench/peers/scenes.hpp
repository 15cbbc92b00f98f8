// Scenes S1 to S8, tower, wall and piles: the work that every engine is given, as plain data that no engine had a say
// in.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::peers {

/// Friction and Newton restitution of one kind of touch.
struct Contact {
  double friction = 0.2;
  double restitution = 0.05;
  /// Softness, as far as an engine has it; 0: its default. Stiffness: N/m, of a patch (snug) or a point (Bullet);
  /// damping: Bullet's, N s/m of a point, and snug's, over the critical one of a point.
  double stiffness = 0.0, damping = 0.0, snug_damping_ratio = 0.0;
  /// The same for MuJoCo, whose contacts are springs by their time constant, s (solref).
  double time_constant = 0.0, damping_ratio = 1.0;
  double impedance = 0.95;  ///< MuJoCo's, where a contact begins (solimp[0]), with a time constant
  std::optional<double> edge_friction = std::nullopt;  ///< snug's, of edges and corners; absent: friction
};

/// A solid box (or cylinder) of uniform density; the body frame is at its centre.
struct BoxBody {
  std::string name{};
  Vector3 half = Vector3::Constant(0.05);  ///< m
  double mass = 0.0;                       ///< kg; 0: fixed to the world
  Pose X_WB{};                             ///< at the start, at rest
  bool is_present = true;                  ///< false: enters with Engine::insert
  double inertia_factor = 1.0;             ///< of the moments of a solid box
  Vector3 middle = Vector3::Zero();        ///< m, of the box from its centre of mass, which is the body's frame
  bool is_round = false;                   ///< a cylinder of radius half.x, its axis z
};

/// About its axes, kg m^2.
[[nodiscard]] Vector3 moments_of(const BoxBody& box);

/// Boxes, optionally on a plane. Fixed things (mass 0 and the plane) are the container, the others are boxes.
struct Scene {
  std::string name{};
  std::vector<BoxBody> bodies{};
  bool has_plane = false;
  double plane_height = 0.0;  ///< m, horizontal
  Contact box_box{0.2, 0.05};
  Contact box_container{0.24, 0.1};
  Vector3 gravity{0.0, 0.0, -9.81};  ///< m/s^2
};

/// Linear spring-damper between the holder's frame E and a frame A of the box that rests on E when unloaded.
/// Axial: along Ez; lateral: along Ex and Ey; bending: about Ex and Ey; torsion: about Ez.
struct Spring {
  Vector3 p_BA = Vector3::Zero();                  ///< m, attachment in the box; A is parallel to B
  Vector3 stiffness = Vector3::Zero();             ///< N/m, along Ex, Ey, Ez
  Vector3 rotational_stiffness = Vector3::Zero();  ///< Nm/rad
  Vector3 damping = Vector3::Zero();               ///< N s/m
  Vector3 rotational_damping = Vector3::Zero();    ///< Nm s/rad
};

/// Where the holder is, and how it moves.
struct HolderMotion {
  Pose X_WE;
  Twist V_WE;  ///< of E's origin, in W
};

/// One box on the spring, driven by a holder.
struct HeldScene {
  Scene scene{};
  int held = 0;  ///< index of the held box
  Spring spring{};
  double end = 0.0;  ///< s, when the measurement ends
  HolderMotion (*holder)(double time) = nullptr;
};

enum class GapVariant { A, B, C };

/// One of the four box types, its axes along those of the world. type: 0 .. 3 for B1 .. B4.
[[nodiscard]] BoxBody parcel(int type);

/// S1: 14 boxes in three layers, tight in the container.
[[nodiscard]] Scene stacked_scene();
/// S2: the container on a plane and 12 boxes that are not there yet. Which types: drawn from the seed.
[[nodiscard]] Scene dropped_scene(unsigned seed);
/// S3: one B1 on a plane, mu 0.2, no restitution. slope: tangent of the angle by which gravity leans.
[[nodiscard]] Scene sliding_scene(double slope);
/// S4: one B1, lower face 0.5 m above a plane, e 0.5.
[[nodiscard]] Scene bouncing_scene();
/// S5: one B4 carried round the vertical on an eccentric attachment.
[[nodiscard]] HeldScene swing_scene();
/// S6: one B4 pressed between two others.
[[nodiscard]] HeldScene gap_scene(GapVariant variant);

/// S7: a flat box on a plane, mu 0.3, that slides and turns.
[[nodiscard]] Scene turning_scene();
/// S8: Euler's disc, leaning by 30 degrees: radius 37.5 mm, thickness 2 mm, 100 g, mu 0.6.
[[nodiscard]] Scene disc_scene();
/// 40 boxes of 200 x 200 x 100 mm, one on the other, on a plane.
[[nodiscard]] Scene tower_scene();
/// 105 bricks of 200 x 100 x 100 mm on a plane, 15 rows of 7, each row half a brick aside.
[[nodiscard]] Scene wall_scene();

/// Boxes that fall into a tote in layers of side x side: bench::drawn_pile, as `snug bench piles` has it.
[[nodiscard]] Scene pile_scene(int count, int side, unsigned seed);

/// Inside of the container, half sizes [m]; the floor's top is at z = 0.
inline const Vector3 kContainerHalf{0.285, 0.185, 0.125};

}  // namespace snug::peers
