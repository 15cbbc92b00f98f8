#include "snug/physics/internal/contact_path.hpp"

#include <cmath>

namespace snug::physics::internal {
namespace {

/// Cylinders: a contact is on a rim where it lies in the radial direction that faces the other body, to this fraction
/// of the radius; steeper than this (sine between axis and normal) a rim has such a direction.
constexpr double kOnRim = 0.05;
constexpr double kLeastSlope = 0.02;

/// A body as it moves within the step, from its start.
struct Mover {
  const BodyWork* work = nullptr;
  Vector3 v, w;  ///< mean of the step, as predicted
};

Mover mover_of(const BodyWork& body) {
  Mover mover{&body, body.velocity_start, body.angular_start};
  if (body.active >= 0 || body.is_moving) mover.w = 0.5 * (body.angular_start + body.angular_guess);
  if (body.active < 0 && body.is_moving) mover.v = 0.5 * (body.velocity_start + body.velocity);
  return mover;
}

/// Where the point of touch is after `time`, from the centre of mass: it belongs to the body, or to the round surface
/// that rolls on. n: into the body.
Vector3 arm_after(const Mover& mover, const Geom& geom, const Vector3& arm, const Vector3& n, double time) {
  const Matrix3 turn = exp_rotation(time * mover.w);
  if (const auto* capsule = std::get_if<geometry::Capsule>(&geom.shape))
    return turn * (arm + capsule->radius * n) - capsule->radius * n;
  const auto* cylinder = std::get_if<geometry::Cylinder>(&geom.shape);
  if (cylinder == nullptr) return turn * arm;
  const Matrix3& R_WB = mover.work->R_WB;
  const Vector3 axis = R_WB * geom.X_BG.R.col(2);
  const Vector3 centre = R_WB * geom.X_BG.p + mover.work->p_WB - mover.work->p_WBcm;
  const Vector3 from_centre = arm - centre;
  const double along = from_centre.dot(axis);
  const auto rim = [&](const Vector3& a) -> Vector3 { return a.dot(n) * a - n; };
  const Vector3 facing = rim(axis);
  const double slope = facing.norm();
  if (slope < kLeastSlope ||
      (from_centre - along * axis - cylinder->radius / slope * facing).norm() > kOnRim * cylinder->radius)
    return arm;  // a flat end slides and spins under points that stay
  const Vector3 axis_then = turn * axis;
  return turn * centre + along * axis_then + cylinder->radius * rim(axis_then).normalized();
}

const Geom& geom_of(const WorldModel& model, std::uint32_t geom) {
  const WorldModel::GeomRef& ref = model.geoms[geom];
  return model.bodies[static_cast<std::size_t>(ref.body)].geoms[static_cast<std::size_t>(ref.geom)];
}

}  // namespace

bool is_round(const WorldModel& model, std::uint32_t geom) {
  const geometry::Shape& shape = geom_of(model, geom).shape;
  return std::holds_alternative<geometry::Capsule>(shape) || std::holds_alternative<geometry::Cylinder>(shape);
}

bool follows_path(const WorldModel& model, const WorldState& state, const Scratch& work, const Patch& patch,
                  const Contact& contact) {
  const BodyWork& a = work.bodies[static_cast<std::size_t>(patch.body_a)];
  const BodyWork& b = work.bodies[static_cast<std::size_t>(patch.body_b)];
  if ((a.active < 0) == (b.active < 0) || !(a.turns || b.turns) || patch.is_swept) return false;
  const PairState& pair = state.pairs[patch.pair];
  if (!(pair.impulses[static_cast<std::size_t>(contact.point)][0] > 0.0) ||
      std::abs(contact.approach) > model.settings.restitution_threshold)
    return false;
  const bool is_a = a.active >= 0;
  const bool rides = is_a ? b.turns : a.turns;
  if (rides || is_round(model, is_a ? pair.geom_a : pair.geom_b)) return true;
  const BodyWork& body = is_a ? a : b;
  return body.is_lone && patch.n.cross(body.angular_start).squaredNorm() > kRocks * kRocks;
}

ContactArms arms_of(const WorldModel& model, const WorldState& state, const Scratch& work, const Patch& patch,
                    const Contact& contact) {
  const PairState& pair = state.pairs[patch.pair];
  const Geom& geom_a = geom_of(model, pair.geom_a);
  const Geom& geom_b = geom_of(model, pair.geom_b);
  const Mover a = mover_of(work.bodies[static_cast<std::size_t>(patch.body_a)]);
  const Mover b = mover_of(work.bodies[static_cast<std::size_t>(patch.body_b)]);
  const Vector3 arm_a = contact.p_WQ - a.work->p_WBcm, arm_b = contact.p_WQ - b.work->p_WBcm;
  const bool is_a = a.work->active >= 0;  // the point belongs to the body that the solver moves
  const auto arms_after = [&](double time, Vector3& to_a, Vector3& to_b) {
    const Vector3 way_a = a.work->p_WBcm + time * a.v, way_b = b.work->p_WBcm + time * b.v;
    const Vector3 p = is_a ? Vector3(way_a + arm_after(a, geom_a, arm_a, -patch.n, time))
                           : Vector3(way_b + arm_after(b, geom_b, arm_b, patch.n, time));
    to_a = p - way_a;
    to_b = p - way_b;
  };
  ContactArms arms;
  arms_after(0.5 * work.dt, arms.a_mid, arms.b_mid);
  arms_after(work.dt, arms.a_end, arms.b_end);
  return arms;
}

}  // namespace snug::physics::internal
