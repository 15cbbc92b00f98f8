// Scenes S1 to S8, tower, wall and piles: sizes, masses, poses and motions.
#include "peers/scenes.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "bench/figures/drawn_scenes.hpp"
#include "snug/core/rng.hpp"

namespace snug::peers {

namespace {

constexpr double kMm = 1e-3;
constexpr double kDegree = std::numbers::pi / 180.0;

struct ParcelType {
  const char* name;
  double x, y, z;  ///< m, full sizes
  double mass;     ///< kg
};
constexpr std::array<ParcelType, 4> kParcels{{{"B1", 0.200, 0.200, 0.097, 0.55},
                                              {"B2", 0.105, 0.120, 0.108, 0.26},
                                              {"B3", 0.184, 0.259, 0.062, 1.05},
                                              {"B4", 0.170, 0.235, 0.094, 0.95}}};

BoxBody fixed_box(const char* name, const Vector3& half, const Vector3& centre) {
  BoxBody body{.name = name, .half = half};
  body.X_WB.p = centre;
  return body;
}

BoxBody standing(int type, double x, double y, double bottom) {
  BoxBody body = parcel(type);
  body.X_WB.p = {x, y, bottom + body.half.z()};
  return body;
}

/// The box turned by 90 degrees about the vertical, written as exchanged sizes.
BoxBody turned(BoxBody body) {
  std::swap(body.half.x(), body.half.y());
  return body;
}

void add_container(std::vector<BoxBody>& bodies) {
  const Vector3& in = kContainerHalf;
  const double wall = 5 * kMm;  // half of 10 mm
  bodies.push_back(fixed_box("floor", {in.x() + 2 * wall, in.y() + 2 * wall, wall}, {0, 0, -wall}));
  for (const double side : {-1.0, 1.0}) {
    bodies.push_back(fixed_box("wall x", {wall, in.y() + 2 * wall, in.z()}, {side * (in.x() + wall), 0, in.z()}));
    bodies.push_back(fixed_box("wall y", {in.x(), wall, in.z()}, {0, side * (in.y() + wall), in.z()}));
  }
}

/// Quintic from 0 to 1 with zero velocity and acceleration at both ends: value and slope over s in [0, 1].
struct Blend {
  double value, slope;
};
Blend blend(double s) {
  if (s <= 0.0) return {0.0, 0.0};
  if (s >= 1.0) return {1.0, 0.0};
  return {s * s * s * (10.0 + s * (-15.0 + 6.0 * s)), 30.0 * s * s * (1.0 - s) * (1.0 - s)};
}

constexpr double kSwingRadius = 0.6;  // m

HolderMotion swing_holder(double time) {
  const Blend path = blend(time);
  const double angle = 60 * kDegree * path.value;
  const double rate = 60 * kDegree * path.slope;
  HolderMotion motion;
  motion.X_WE.R = exp_rotation({0, 0, angle});
  motion.X_WE.p = kSwingRadius * motion.X_WE.R.col(0);
  motion.V_WE = {kSwingRadius * rate * motion.X_WE.R.col(1), {0, 0, rate}};
  return motion;
}

constexpr double kHeldHalfHeight = 47 * kMm;
constexpr double kPressedHeight = kHeldHalfHeight - 2 * kMm;  // m, centre of the box 2 mm below touching
constexpr double kStartHeight = 160 * kMm;                    // m, 19 mm above the neighbours
constexpr double kGapOffset = 0.3 * kMm;

/// The holder sits at the top centre of where the box should be: centre (x, 0, height), tilted about y.
HolderMotion above_box(double x, Blend height, double height_from, double height_to, double tilt, double tilt_rate,
                       double duration) {
  const Matrix3 R_WE = exp_rotation({0, tilt, 0});
  const Vector3 p_BE_W = R_WE * Vector3(0, 0, kHeldHalfHeight);
  const Vector3 w{0, tilt_rate, 0};
  const double z = height_from + (height_to - height_from) * height.value;
  const double z_rate = (height_to - height_from) * height.slope / duration;
  HolderMotion motion;
  motion.X_WE = {R_WE, Vector3(x, 0, z) + p_BE_W};
  motion.V_WE = {Vector3(0, 0, z_rate) + w.cross(p_BE_W), w};
  return motion;
}

HolderMotion straight_holder(double time) {
  return above_box(kGapOffset, blend(time / 2.0), kStartHeight, kPressedHeight, 0.3 * kDegree, 0.0, 2.0);
}

HolderMotion flat_holder(double time) {
  return above_box(kGapOffset, blend(time / 2.0), kStartHeight, kPressedHeight, 0.0, 0.0, 2.0);
}

HolderMotion tilted_holder(double time) {
  constexpr double kPhase = 1.5;  // s, each of: down tilted; levelled and pressed
  constexpr double kLow = 98.5 * kMm;
  if (time < kPhase) {
    return above_box(0.0, blend(time / kPhase), kStartHeight + 50 * kMm, kLow, 25 * kDegree, 0.0, kPhase);
  }
  const Blend path = blend((time - kPhase) / kPhase);
  return above_box(0.0, path, kLow, kPressedHeight, 25 * kDegree * (1.0 - path.value),
                   -25 * kDegree * path.slope / kPhase, kPhase);
}

}  // namespace

BoxBody parcel(int type) {
  const ParcelType& parcel = kParcels.at(static_cast<std::size_t>(type));
  return {.name = parcel.name, .half = 0.5 * Vector3(parcel.x, parcel.y, parcel.z), .mass = parcel.mass};
}

Vector3 moments_of(const BoxBody& box) {
  const double factor = box.inertia_factor * box.mass / 12.0;
  const Vector3 square = (2.0 * box.half).cwiseAbs2();
  if (box.is_round) {
    const double across = 0.75 * square.x() + square.z();
    return factor * Vector3(across, across, 1.5 * square.x());
  }
  return factor * Vector3(square.y() + square.z(), square.x() + square.z(), square.x() + square.y());
}

Scene stacked_scene() {
  constexpr double gap = 1 * kMm, rise = 0.2 * kMm;
  const double x0 = -kContainerHalf.x(), y0 = -kContainerHalf.y();
  Scene scene{.name = "s1"};
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const double third = 0.000667;  // m, three of them and two boxes fill the width of 370 mm
      scene.bodies.push_back(
          turned(standing(2, x0 + gap + 0.1295 + i * (0.259 + gap), y0 + third + 0.092 + j * (0.184 + third), rise)));
    }
  }
  const double second = 2 * rise + 0.062;
  for (int i = 0; i < 3; ++i) {
    scene.bodies.push_back(standing(3, x0 + gap + 0.085 + i * (0.170 + gap), y0 + gap + 0.1175, second));
  }
  for (int i = 0; i < 5; ++i) {
    scene.bodies.push_back(standing(1, x0 + gap + 0.0525 + i * (0.105 + gap), y0 + gap + 0.235 + gap + 0.060, second));
  }
  const double third = second + rise + 0.094;
  scene.bodies.push_back(turned(standing(2, x0 + gap + 0.1295, y0 + gap + 0.02 + 0.092, third)));
  scene.bodies.push_back(standing(0, x0 + gap + 0.259 + gap + 0.1, y0 + gap + 0.01 + 0.1, third));
  add_container(scene.bodies);
  return scene;
}

Scene dropped_scene(unsigned seed) {
  Rng rng = Rng(seed).split("types");
  Scene scene{.name = "s2", .has_plane = true, .plane_height = -11 * kMm};
  for (int i = 0; i < 12; ++i) {
    scene.bodies.push_back(parcel(rng.index(static_cast<int>(kParcels.size()))));
    scene.bodies.back().is_present = false;
  }
  add_container(scene.bodies);
  return scene;
}

Scene sliding_scene(double slope) {
  Scene scene{.name = "s3", .has_plane = true, .box_container = {0.2, 0.0}};
  const double angle = std::atan(slope), direction = 0.4;  // rad
  scene.gravity =
      9.81 * Vector3(std::sin(angle) * std::cos(direction), std::sin(angle) * std::sin(direction), -std::cos(angle));
  scene.bodies.push_back(standing(0, 0, 0, 0));
  return scene;
}

Scene bouncing_scene() {
  Scene scene{.name = "s4", .has_plane = true, .box_container = {0.2, 0.5}};
  scene.bodies.push_back(standing(0, 0, 0, 0.5));
  return scene;
}

HeldScene swing_scene() {
  HeldScene held{.scene = {.name = "s5"}, .end = 4.0, .holder = swing_holder};
  held.spring = {.p_BA = {0.07, 0.0, 0.047},
                 .stiffness = {2000, 2000, 5000},
                 .rotational_stiffness = {20, 20, 5},
                 .damping = {6, 6, 10},
                 .rotational_damping = {0.04, 0.04, 0.02}};
  BoxBody box = parcel(3);
  box.X_WB.p = swing_holder(0.0).X_WE.p - held.spring.p_BA;
  held.scene.bodies.push_back(box);
  return held;
}

HeldScene gap_scene(GapVariant variant) {
  const double gap = variant == GapVariant::A ? 0.171 : 0.165, travel = 0.020, wall = 0.01;  // m
  HeldScene held{.scene = {.name = "s6", .has_plane = true}};
  held.spring = {.p_BA = {0, 0, kHeldHalfHeight},
                 .stiffness = Vector3::Constant(5000),
                 .rotational_stiffness = Vector3::Constant(20),
                 .damping = Vector3::Constant(14),
                 .rotational_damping = Vector3::Constant(0.08)};
  held.holder = variant == GapVariant::A ? straight_holder : variant == GapVariant::B ? tilted_holder : flat_holder;
  held.end = variant == GapVariant::A ? 3.0 : variant == GapVariant::B ? 4.0 : 7.0;
  BoxBody box = parcel(3);
  for (const double side : {-1.0, 1.0}) {
    const double outer = gap / 2 + 2 * box.half.x();
    held.scene.bodies.push_back(standing(3, side * (gap / 2 + box.half.x()), 0, 0));
    held.scene.bodies.push_back(fixed_box("wall", {wall, 0.3, 0.1}, {side * (outer + travel + wall), 0, 0.1}));
  }
  const Pose X_WE = held.holder(0.0).X_WE;
  box.X_WB = {X_WE.R, X_WE * Vector3(-held.spring.p_BA)};
  held.held = static_cast<int>(held.scene.bodies.size());
  held.scene.bodies.push_back(box);
  return held;
}

Scene turning_scene() {
  Scene scene{.name = "s7", .has_plane = true, .box_box = {0.3, 0.0}, .box_container = {0.3, 0.0}};
  scene.bodies.push_back({.name = "box", .half = {0.15, 0.10, 0.01}, .mass = 1.0});
  scene.bodies.back().X_WB.p.z() = 0.01;
  return scene;
}

Scene disc_scene() {
  Scene scene{.name = "s8", .has_plane = true, .box_box = {0.6, 0.0}, .box_container = {0.6, 0.0}};
  BoxBody disc{.name = "disc", .half = {0.0375, 0.0375, 0.001}, .mass = 0.1, .is_round = true};
  const double lean = 30 * kDegree;
  disc.X_WB = {exp_rotation({0, lean, 0}), {0, 0, disc.half.x() * std::sin(lean) + disc.half.z() * std::cos(lean)}};
  scene.bodies.push_back(disc);
  return scene;
}

Scene tower_scene() {
  Scene scene{.name = "tower", .has_plane = true, .box_box = {0.4, 0.0}, .box_container = {0.4, 0.0}};
  for (int i = 0; i < 40; ++i) {
    scene.bodies.push_back({.name = "box", .half = {0.10, 0.10, 0.05}, .mass = 1.0});
    scene.bodies.back().X_WB.p.z() = 0.05 + 0.1 * i;
  }
  return scene;
}

Scene wall_scene() {
  Scene scene{.name = "wall", .has_plane = true, .box_box = {0.4, 0.0}, .box_container = {0.4, 0.0}};
  for (int row = 0; row < 15; ++row) {
    for (int i = 0; i < 7; ++i) {
      scene.bodies.push_back({.name = "brick", .half = {0.10, 0.05, 0.05}, .mass = 1.0});
      scene.bodies.back().X_WB.p = {0.2 * i + (row % 2) * 0.1, 0.0, 0.05 + 0.1 * row};
    }
  }
  return scene;
}

Scene pile_scene(int count, int side, unsigned seed) {
  const model::Scenario scenario = bench::drawn_pile({count, side, seed});
  Scene scene{.name = "pile", .box_box = {0.4, 0.1}, .box_container = {0.4, 0.1}};
  for (const model::Body& body : scenario.bodies) {
    scene.bodies.push_back({.name = body.name,
                            .half = std::get<geometry::Box>(body.shapes.front().shape).half,
                            .mass = body.inertia.mass,
                            .X_WB = body.X_WB});
  }
  const model::Container& tote = scenario.containers.front();
  for (const model::PlacedShape& wall : model::make_walls(tote)) {
    scene.bodies.push_back(fixed_box("wall", std::get<geometry::Box>(wall.shape).half, (tote.X_WT * wall.X_BG).p));
  }
  return scene;
}

}  // namespace snug::peers
