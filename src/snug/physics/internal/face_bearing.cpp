// Face bearing: where the friction of a patch acts that bears on its edges or its face. docs/theory/contact.md,
// section 3.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "snug/physics/internal/face_loads.hpp"
#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

/// m, to which the centre of pressure is rounded: what rests has the same bytes in each step. Its friction is off by
/// less than mu N times this.
constexpr double kGrid = 1e-4;
/// m/s of slip, and turning over sliding, from which friction follows the motion at the start of the step.
constexpr double kSlides = 1e-4, kTurns = 1e-6;
constexpr double kRound = 1e-6;     ///< of the radius: points of a patch that are on one circle
constexpr double kParallel = 1e-6;  ///< 1 - cosine, between the axis of a flat end and the normal of its patch

double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

/// Contacts of one face, in its plane: of one patch, or of several that lie on supports of one plane.
struct Face {
  std::array<FaceLoad, geometry::kMaxManifoldPoints> points;
  std::size_t count = 0;
  Vector3 origin, n, t1, t2;  ///< n from A to B, B the moving body where several support it
  int body_a = 0, body_b = 0;
  Vector3 belt_W;  ///< of B's surface against A's
  std::size_t law = 0;
  bool strikes = false;  ///< one that bears, faster than the threshold of restitution
};

double load_of(const WorldState& state, const Scratch& work, int contact) {
  const Contact& c = work.contacts[static_cast<std::size_t>(contact)];
  const Patch& patch = work.patches[static_cast<std::size_t>(c.patch)];
  return state.pairs[patch.pair].impulses[static_cast<std::size_t>(c.point)][0];
}

FaceLoad load_at(const WorldModel& model, const WorldState& state, const Scratch& work, const Face& face, int index) {
  const Contact& contact = work.contacts[static_cast<std::size_t>(index)];
  const Vector3 p = contact.p_WQ - face.origin;
  const double load = load_of(state, work, index);
  return {face.t1.dot(p), face.t2.dot(p), load, 1.0, bears(model, contact, load), index};
}

void add_point(const WorldModel& model, const WorldState& state, const Scratch& work, int index, Face& face) {
  const FaceLoad& point = face.points[face.count++] = load_at(model, state, work, face, index);
  const double approach = work.contacts[static_cast<std::size_t>(index)].approach;
  face.strikes |= point.bears && approach < -model.settings.restitution_threshold;
}

Face face_of(const WorldModel& model, const WorldState& state, const Scratch& work, const Patch& patch) {
  Face face;
  face.origin = work.contacts[static_cast<std::size_t>(patch.first_contact)].p_WQ;
  face.n = patch.n, face.t1 = patch.t1, face.t2 = patch.t2;
  face.body_a = patch.body_a, face.body_b = patch.body_b;
  face.belt_W = patch.belt_W;
  face.law = patch.law;
  for (int k = 0; k < patch.contact_count; ++k) add_point(model, state, work, patch.first_contact + k, face);
  return face;
}

/// A flat end of a cylinder: its points are on a circle about its axis.
bool is_disc(const WorldModel& model, const Scratch& work, const Face& face, std::uint32_t geom_index,
             std::span<const FaceLoad> points, FaceSpread& spread) {
  const WorldModel::GeomRef& ref = model.geoms[geom_index];
  const Geom& geom = model.bodies[static_cast<std::size_t>(ref.body)].geoms[static_cast<std::size_t>(ref.geom)];
  const auto* cylinder = std::get_if<geometry::Cylinder>(&geom.shape);
  if (cylinder == nullptr || points.size() < 3) return false;
  const BodyWork& body = work.bodies[static_cast<std::size_t>(ref.body)];
  const Vector3 axis = body.R_WB * geom.X_BG.R.col(2);
  if (1.0 - std::abs(axis.dot(face.n)) > kParallel) return false;
  const Vector3 middle = body.p_WB + body.R_WB * geom.X_BG.p - face.origin;
  spread.x = face.t1.dot(middle), spread.y = face.t2.dot(middle);
  return std::all_of(points.begin(), points.end(), [&](const FaceLoad& p) {
    const double r = length_of(p.x - spread.x, p.y - spread.y);
    return std::abs(r - cylinder->radius) <= kRound * cylinder->radius;
  });
}

/// Puts the corners in order around the face.
FaceSpread spread_on(const WorldModel& model, const WorldState& state, const Scratch& work, const Face& face,
                     std::span<FaceLoad> corners) {
  const Bearing bearing = model.laws[face.law].bearing;
  const auto first = static_cast<std::size_t>(corners[0].index);
  const FaceSpread polygon = spread_of(corners, bearing);
  const PairState& pair = state.pairs[work.patches[static_cast<std::size_t>(work.contacts[first].patch)].pair];
  FaceSpread disc;
  for (const std::uint32_t geom : {pair.geom_a, pair.geom_b}) {
    if (!is_disc(model, work, face, geom, corners, disc)) continue;
    const double radius = length_of(corners[0].x - disc.x, corners[0].y - disc.y);
    disc.distance = bearing == Bearing::Face ? 2.0 / 3.0 * radius : radius;
    return disc;
  }
  return polygon;
}

double to_grid(double x) { return kGrid * std::round(x / kGrid); }

/// In the plane of a patch.
struct Planar {
  double x = 0.0, y = 0.0;
};

double cross(const Planar& a, const Planar& b) { return a.x * b.y - a.y * b.x; }

/// What friction depends on of a patch whose corners bear.
struct FrictionPatch {
  std::array<FaceLoad, geometry::kMaxManifoldPoints> corners;  ///< around the patch; those that bear
  std::size_t count = 0;
  FaceSpread spread;
  Planar pressed;                                           ///< m, centre of pressure
  Planar velocity;                                          ///< m/s, there, of B on A, at the start of the step
  double angular = 0.0;                                     ///< rad/s
  std::array<double, geometry::kMaxManifoldPoints> unit{};  ///< loads of an even pressure of 1
};

/// Where a row's friction acts and what is left of it; direction: that of the slip there.
struct CornerFriction {
  Planar at, direction;
  double fraction = 1.0;
};
using CornerFrictions = std::array<CornerFriction, geometry::kMaxManifoldPoints>;

FrictionPatch friction_patch_of(const WorldModel& model, const WorldState& state, const Scratch& work,
                                const Face& face) {
  FrictionPatch f;
  for (std::size_t k = 0; k < face.count; ++k) {
    if (face.points[k].bears) f.corners[f.count++] = face.points[k];
  }
  if (f.count == 0) return f;
  const std::span<FaceLoad> corners{f.corners.data(), f.count};
  f.spread = spread_on(model, state, work, face, corners);
  auto unit = f.corners;
  share_unit_load({unit.data(), f.count}, f.spread);
  double sum = 0.0, x = 0.0, y = 0.0;
  for (std::size_t i = 0; i < f.count; ++i) {
    const FaceLoad& p = f.corners[i];
    f.unit[i] = unit[i].load;
    sum += p.load, x += p.load * (p.x - f.spread.x), y += p.load * (p.y - f.spread.y);
  }
  f.pressed = {f.spread.x, f.spread.y};
  if (sum > 0.0) f.pressed.x += to_grid(x / sum), f.pressed.y += to_grid(y / sum);
  const BodyWork& a = work.bodies[static_cast<std::size_t>(face.body_a)];
  const BodyWork& b = work.bodies[static_cast<std::size_t>(face.body_b)];
  const Vector3 p_WQ = face.origin + f.pressed.x * face.t1 + f.pressed.y * face.t2;
  const Vector3 v = (b.velocity_start + b.angular_start.cross(p_WQ - b.p_WBcm)) -
                    (a.velocity_start + a.angular_start.cross(p_WQ - a.p_WBcm)) + face.belt_W;
  f.velocity = {face.t1.dot(v), face.t2.dot(v)};
  f.angular = face.n.dot(b.angular_start - a.angular_start);
  return f;
}

/// Of what sticks, or slides without turning: corners drawn in to where they have the torque of even pressure.
void draw_in_corners(const FrictionPatch& f, CornerFrictions& frictions) {
  double distance = 0.0;
  for (std::size_t i = 0; i < f.count; ++i)
    distance += f.unit[i] * length_of(f.corners[i].x - f.spread.x, f.corners[i].y - f.spread.y);
  const double scale = distance > 0.0 ? f.spread.distance / distance : 1.0;
  for (std::size_t i = 0; i < f.count; ++i) {
    const FaceLoad& p = f.corners[i];
    frictions[i].at = {f.pressed.x + scale * (p.x - f.pressed.x), f.pressed.y + scale * (p.y - f.pressed.y)};
  }
}

constexpr std::size_t kSamples = geometry::kMaxManifoldPoints;

/// The part of the patch that belongs to a corner: points of equal pressure about the part's middle, which lies halfway
/// between the corner and the middle of the patch.
struct FacePart {
  std::array<Planar, kSamples> samples;
  std::size_t count = 0;
};

FacePart part_of(const FrictionPatch& f, std::size_t corner, Bearing bearing) {
  FacePart part;
  const FaceLoad& p = f.corners[corner];
  if (bearing == Bearing::Edges && f.count > 2) {  // along both sides, halfway to the next corners
    for (const std::size_t next : {(corner + 1) % f.count, (corner + f.count - 1) % f.count}) {
      const FaceLoad& q = f.corners[next];
      for (const double way : {0.125, 0.375}) part.samples[part.count++] = {way * (q.x - p.x), way * (q.y - p.y)};
    }
  } else {  // the patch at half its size
    for (std::size_t k = 0; k < f.count; ++k)
      part.samples[part.count++] = {0.25 * (f.corners[k].x - p.x), 0.25 * (f.corners[k].y - p.y)};
  }
  Planar mean;
  const auto n = static_cast<double>(part.count);
  for (std::size_t k = 0; k < part.count; ++k) mean.x += part.samples[k].x / n, mean.y += part.samples[k].y / n;
  for (std::size_t k = 0; k < part.count; ++k) part.samples[k].x -= mean.x, part.samples[k].y -= mean.y;
  return part;
}

/// What makes the mean distance of all samples that of the patch.
double size_of_parts(const FrictionPatch& f, Bearing bearing) {
  double distance = 0.0;
  for (std::size_t i = 0; i < f.count; ++i) {
    const FacePart part = part_of(f, i, bearing);
    const double x = 0.5 * (f.corners[i].x - f.spread.x), y = 0.5 * (f.corners[i].y - f.spread.y);
    for (std::size_t k = 0; k < part.count; ++k)
      distance += f.unit[i] / static_cast<double>(part.count) * length_of(x + part.samples[k].x, y + part.samples[k].y);
  }
  return distance > 0.0 ? f.spread.distance / distance : 1.0;
}

/// Force and torque of friction on one part, over mu N, and the point at which a row has both: there the slip is along
/// the force, and its line of action passes through.
CornerFriction friction_of(const FrictionPatch& f, const FacePart& part, double size, const Planar& middle,
                           double& missing) {
  const auto slip = [&f](const Planar& at) {
    return Planar{f.velocity.x - f.angular * (at.y - f.pressed.y), f.velocity.y + f.angular * (at.x - f.pressed.x)};
  };
  Planar force;
  double torque = 0.0, radius = 0.0;
  for (std::size_t k = 0; k < part.count; ++k) {
    const Planar arm{size * part.samples[k].x, size * part.samples[k].y};
    const Planar v = slip({middle.x + arm.x, middle.y + arm.y});
    const double speed = length_of(v.x, v.y) + 1e-12, share = 1.0 / static_cast<double>(part.count);
    const Planar d{share * v.x / speed, share * v.y / speed};
    force.x += d.x, force.y += d.y, torque += cross(arm, d);
    radius = std::max(radius, length_of(arm.x, arm.y));
  }
  CornerFriction friction;
  friction.fraction = length_of(force.x, force.y);
  const Planar v = slip(middle);
  if (friction.fraction < 1e-6) {  // turns about its middle
    friction = {middle, {1.0, 0.0}, 0.0};
    missing = torque;
    return friction;
  }
  friction.direction = {force.x / friction.fraction, force.y / friction.fraction};
  const Planar& d = friction.direction;
  const double across = std::clamp(torque / friction.fraction, -radius, radius);
  const double sideways = d.x * v.y - d.y * v.x;
  const double along = std::abs(sideways) < std::abs(f.angular) * radius ? -sideways / f.angular
                                                                         : std::copysign(radius, -sideways * f.angular);
  friction.at = {middle.x + across * d.y + along * d.x, middle.y - across * d.x + along * d.y};
  missing = torque - across * friction.fraction;
  return friction;
}

/// Of what slides and turns: force and torque of the planar integral for the motion at the start of the step.
void follow_slip(const FrictionPatch& f, Bearing bearing, CornerFrictions& frictions) {
  const double size = size_of_parts(f, bearing);
  double sum = 0.0, missing = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < f.count; ++i) sum += f.corners[i].load;
  Planar force;
  for (std::size_t i = 0; i < f.count; ++i) {
    const FaceLoad& p = f.corners[i];
    const Planar arm{0.5 * size * (p.x - f.pressed.x), 0.5 * size * (p.y - f.pressed.y)};
    double left = 0.0;
    frictions[i] = friction_of(f, part_of(f, i, bearing), size, {f.pressed.x + arm.x, f.pressed.y + arm.y}, left);
    const double load = sum > 0.0 ? p.load / sum : f.unit[i];
    missing += load * left;
    force.x += load * frictions[i].fraction * frictions[i].direction.x;
    force.y += load * frictions[i].fraction * frictions[i].direction.y;
    largest = std::max(largest, length_of(arm.x, arm.y));
  }
  // The torque of a part that turns about a point within: all others move to its side.
  const double square = force.x * force.x + force.y * force.y;
  if (!(square > 0.0)) return;
  const double way = std::clamp(missing / square, -largest, largest);
  for (std::size_t i = 0; i < f.count; ++i) frictions[i].at.x += way * force.y, frictions[i].at.y -= way * force.x;
}

void set_point(Scratch& work, int contact, const FrictionPoint& point) {
  FrictionPoint& known = work.friction_points[static_cast<std::size_t>(contact)];
  if (known == point) return;
  known = point;
  work.patches[static_cast<std::size_t>(work.contacts[static_cast<std::size_t>(contact)].patch)].is_kept = false;
}

/// Starts the solver with the friction of a corner that slides.
void start_friction(const Face& face, const FaceLoad& corner, const CornerFriction& friction, double mu,
                    WorldState& state, const Scratch& work) {
  const Contact& contact = work.contacts[static_cast<std::size_t>(corner.index)];
  const Patch& patch = work.patches[static_cast<std::size_t>(contact.patch)];
  auto& impulse = state.pairs[patch.pair].impulses[static_cast<std::size_t>(contact.point)];
  const double limit = mu * friction.fraction * impulse[0] * (patch.body_b == face.body_b ? -1.0 : 1.0);
  const Vector3 on_b = limit * (friction.direction.x * face.t1 + friction.direction.y * face.t2);
  impulse[1] = patch.t1.dot(on_b), impulse[2] = patch.t2.dot(on_b);
}

/// Places the friction of the rows, and of what slides and turns starts the solver with it.
void place_friction(const WorldModel& model, const Face& face, WorldState& state, Scratch& work) {
  const FrictionPatch f = friction_patch_of(model, state, work, face);
  const ContactLaw& law = model.laws[face.law];
  CornerFrictions frictions;
  const double turning = std::abs(f.angular) * f.spread.distance, sliding = length_of(f.velocity.x, f.velocity.y);
  const bool follows = turning + sliding > kSlides && turning > kTurns * sliding;
  if (follows) {
    follow_slip(f, law.bearing, frictions);
  } else {
    draw_in_corners(f, frictions);
  }
  for (std::size_t k = 0; k < face.count; ++k) {
    if (face.strikes || !face.points[k].bears)
      set_point(work, face.points[k].index, {work.contacts[static_cast<std::size_t>(face.points[k].index)].p_WQ});
  }
  for (std::size_t i = 0; i < f.count && !face.strikes; ++i) {
    const FaceLoad& p = f.corners[i];
    const Vector3& p_WQ = work.contacts[static_cast<std::size_t>(p.index)].p_WQ;
    set_point(
        work, p.index,
        {p_WQ + (frictions[i].at.x - p.x) * face.t1 + (frictions[i].at.y - p.y) * face.t2, frictions[i].fraction});
    if (follows) start_friction(face, p, frictions[i], law.friction, state, work);
  }
}

void set_load(WorldState& state, Scratch& work, int index, double load) {
  const Contact& contact = work.contacts[static_cast<std::size_t>(index)];
  Patch& patch = work.patches[static_cast<std::size_t>(contact.patch)];
  auto& impulse = state.pairs[patch.pair].impulses[static_cast<std::size_t>(contact.point)];
  if (impulse[0] == load) return;
  impulse[0] = load;
  patch.is_kept = false;
}

/// Rigid bodies leave open how points share what a face carries.
void even_face(const FaceWrench& wrench, Face& face, WorldState& state, Scratch& work) {
  const auto bearing = std::count_if(face.points.begin(), face.points.begin() + static_cast<std::ptrdiff_t>(face.count),
                                     [](const FaceLoad& p) { return p.bears; });
  if (bearing <= 2 || face.strikes) return;
  std::array<FaceLoad, geometry::kMaxManifoldPoints> points = face.points;  // which of them bear stays
  if (!even_loads({points.data(), face.count}, wrench)) return;
  for (std::size_t k = 0; k < face.count; ++k) {
    face.points[k].load = points[k].load;
    set_load(state, work, points[k].index, points[k].load);
  }
}

}  // namespace

bool bear_on_plane(const WorldModel& model, std::span<const int> patches, std::span<const int> contacts,
                   WorldState& state, Scratch& work) {
  const Patch& first = work.patches[static_cast<std::size_t>(patches.front())];
  Face face = face_of(model, state, work, first);
  const bool is_b = work.bodies[static_cast<std::size_t>(first.body_b)].active >= 0;
  if (!is_b) {  // the moving body is B of the face
    std::swap(face.body_a, face.body_b);
    face.n = -face.n, face.t2 = -face.t2, face.belt_W = -face.belt_W;
  }
  face.count = 0;
  face.strikes = false;
  FaceWrench wrench;
  std::size_t bearing = 0;
  for (const int index : contacts) bearing += work.contacts[static_cast<std::size_t>(index)].is_covered ? 0U : 1U;
  if (bearing > face.points.size()) return false;
  for (const int index : contacts) {
    const FaceLoad point = load_at(model, state, work, face, index);
    wrench.sum += point.load, wrench.x += point.load * point.x, wrench.y += point.load * point.y;
    if (!work.contacts[static_cast<std::size_t>(index)].is_covered) {
      add_point(model, state, work, index, face);
      continue;
    }
    set_load(state, work, index, 0.0);
    set_point(work, index, {work.contacts[static_cast<std::size_t>(index)].p_WQ});
  }
  for (const int index : patches) {
    Patch& patch = work.patches[static_cast<std::size_t>(index)];
    patch.moves_friction = patch.is_shared = true;
  }
  even_face(wrench, face, state, work);
  place_friction(model, face, state, work);
  return true;
}

void bear_on_faces(const WorldModel& model, WorldState& state, Scratch& work) {
  if (work.friction_points.empty() || work.has_too_many_contacts) return;
  for_ranges(work.pool, work.patches.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      Patch& patch = work.patches[i];
      if (patch.is_swept || patch.is_shared || model.laws[patch.law].bearing == Bearing::Corners) continue;
      Face face = face_of(model, state, work, patch);
      patch.moves_friction = true;
      if (model.laws[patch.law].stiffness <= 0.0 && patch.contact_count > 3)
        even_face(wrench_of({face.points.data(), face.count}), face, state, work);
      place_friction(model, face, state, work);
    }
  });
}

}  // namespace snug::physics::internal
