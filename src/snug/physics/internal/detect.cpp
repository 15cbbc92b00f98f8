// Contact detection: manifolds of near pairs, kept while the pair hardly moves, with impulses handed on by feature.
#include <algorithm>
#include <cmath>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

// A manifold is kept while its bodies moved less than this relative to each other since it was found. Its gaps are
// still followed exactly to first order; the neglected part is angle^2 * size, below 1e-8 m for a 0.3 m box.
constexpr double kKeepDistance = 5e-5;   ///< m
constexpr double kKeepHalfAngle = 5e-5;  ///< rad/2
constexpr double kTouchGap = 1e-5;       ///< m, a pair nearer than this at the end of a step wakes sleepers
constexpr double kMatchDistance = 4e-3;  ///< m, impulses are handed to a new feature this near to an old one

struct PairBodies {
  int a, b;
  const Geom& geom_a;
  const Geom& geom_b;
};

PairBodies bodies_of(const WorldModel& model, const PairState& pair) {
  const WorldModel::GeomRef& a = model.geoms[pair.geom_a];
  const WorldModel::GeomRef& b = model.geoms[pair.geom_b];
  return {a.body, b.body, model.bodies[static_cast<std::size_t>(a.body)].geoms[static_cast<std::size_t>(a.geom)],
          model.bodies[static_cast<std::size_t>(b.body)].geoms[static_cast<std::size_t>(b.geom)]};
}

struct RelativePose {
  Vector3 p;
  Quaternion quat;
};

RelativePose relative_pose(const BodyWork& a, const BodyState& state_a, const BodyWork& b, const BodyState& state_b) {
  return {a.R_WB.transpose() * (b.p_WB - a.p_WB), state_a.quat_WB.conjugate() * state_b.quat_WB};
}

bool has_kept(const PairState& pair, const RelativePose& now) {
  if (!pair.is_known) return false;
  if ((now.p - pair.p_AB).squaredNorm() > kKeepDistance * kKeepDistance) return false;
  // |sin(angle/2)|^2 of the rotation between then and now.
  const double along = now.quat.dot(pair.quat_AB);
  const double square = (now.quat.coeffs() - std::copysign(1.0, along) * pair.quat_AB.coeffs()).squaredNorm();
  return square <= kKeepHalfAngle * kKeepHalfAngle;
}

/// Impulses of the old manifold for the new points: same feature first, else the nearest old point.
void hand_on_impulses(const std::array<PairPoint, geometry::kMaxManifoldPoints>& old, int old_count, PairState& pair) {
  std::uint32_t used = 0;
  for (int i = 0; i < pair.count; ++i) {
    PairPoint& point = pair.points[static_cast<std::size_t>(i)];
    for (int j = 0; j < old_count; ++j) {
      if ((used >> j & 1U) == 0 && old[static_cast<std::size_t>(j)].feature == point.feature) {
        point.impulse_A = old[static_cast<std::size_t>(j)].impulse_A;
        used |= 1U << j;
        break;
      }
    }
  }
  for (int i = 0; i < pair.count && used != (1U << old_count) - 1U; ++i) {
    PairPoint& point = pair.points[static_cast<std::size_t>(i)];
    if (!point.impulse_A.isZero(0.0)) continue;
    int best = -1;
    double best_square = kMatchDistance * kMatchDistance;
    for (int j = 0; j < old_count; ++j) {
      const double square = (old[static_cast<std::size_t>(j)].p_A - point.p_A).squaredNorm();
      if ((used >> j & 1U) == 0 && square < best_square) {
        best_square = square;
        best = j;
      }
    }
    if (best < 0) continue;
    point.impulse_A = old[static_cast<std::size_t>(best)].impulse_A;
    used |= 1U << best;
  }
}

void find_manifold(const PairBodies& bodies, const BodyWork& a, const BodyWork& b, double margin,
                   const RelativePose& now, PairState& pair) {
  const Pose X_WA{a.R_WB, a.p_WB}, X_WB{b.R_WB, b.p_WB};
  geometry::Manifold manifold;
  geometry::collide(bodies.geom_a.shape, X_WA * bodies.geom_a.X_BG, bodies.geom_b.shape, X_WB * bodies.geom_b.X_BG,
                    margin, pair.cache, manifold);
  const std::array<PairPoint, geometry::kMaxManifoldPoints> old = pair.points;
  const int old_count = pair.count;
  pair.is_known = true;
  pair.p_AB = now.p;
  pair.quat_AB = now.quat;
  pair.n_A = a.R_WB.transpose() * manifold.n_AB_W;
  pair.count = manifold.count;
  for (int i = 0; i < manifold.count; ++i) {
    const geometry::ManifoldPoint& found = manifold.points[static_cast<std::size_t>(i)];
    PairPoint& point = pair.points[static_cast<std::size_t>(i)];
    point.p_A = a.R_WB.transpose() * (found.p_WA - a.p_WB);
    point.p_B = b.R_WB.transpose() * (found.p_WB - b.p_WB);
    point.feature = found.feature;
    point.impulse_A.setZero();
  }
  if (old_count > 0 && pair.count > 0) hand_on_impulses(old, old_count, pair);
}

/// Two unit vectors that complete n; depends on n alone.
void tangents_of(const Vector3& n, Vector3& t1, Vector3& t2) {
  int smallest = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(n[i]) < std::abs(n[smallest])) smallest = i;
  }
  t1 = n.cross(Vector3::Unit(smallest)).normalized();
  t2 = n.cross(t1);
}

/// Adds the pair's points that can matter within this step. Returns whether one of them touches.
bool add_contacts(const WorldModel& model, const PairBodies& bodies, std::uint32_t index, double reach, PairState& pair,
                  Scratch& work) {
  const BodyWork& a = work.bodies[static_cast<std::size_t>(bodies.a)];
  const BodyWork& b = work.bodies[static_cast<std::size_t>(bodies.b)];
  const Vector3 n = a.R_WB * pair.n_A;
  const auto first = static_cast<int>(work.contacts.size());
  bool touches = false;
  for (int i = 0; i < pair.count; ++i) {
    PairPoint& point = pair.points[static_cast<std::size_t>(i)];
    const Vector3 p_WA = a.R_WB * point.p_A + a.p_WB;
    const Vector3 p_WB = b.R_WB * point.p_B + b.p_WB;
    const double phi = n.dot(p_WB - p_WA);
    if (phi > reach || work.contacts.full()) {
      point.impulse_A.setZero();
      continue;
    }
    const Vector3 p_WQ = 0.5 * (p_WA + p_WB);
    const Vector3 v = (b.velocity_start + b.angular_start.cross(p_WQ - b.p_WBcm)) -
                      (a.velocity_start + a.angular_start.cross(p_WQ - a.p_WBcm));
    const double approach = n.dot(v);
    work.contacts.push_back({p_WQ, phi, approach, static_cast<int>(work.patches.size()), i});
    if (phi + model.settings.dt * std::min(0.0, approach) <= kTouchGap) touches = true;
  }
  const int count = static_cast<int>(work.contacts.size()) - first;
  if (count == 0) return false;
  Patch& patch = work.patches.push_back(Patch{});
  patch.pair = index;
  patch.body_a = bodies.a;
  patch.body_b = bodies.b;
  patch.first_contact = first;
  patch.contact_count = count;
  patch.n = n;
  tangents_of(n, patch.t1, patch.t2);
  patch.law = &model.law(bodies.geom_a.material, bodies.geom_b.material);
  return touches;
}

bool is_sleeping(const BodyState& state, const BodyModel& body) {
  return body.kind == BodyKind::Dynamic && state.sleep_group >= 0;
}

}  // namespace

void wake_group(const WorldModel& model, WorldState& state, Scratch& work, int group) {
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    BodyState& body = state.bodies[i];
    if (body.sleep_group != group || !body.is_present || model.bodies[i].kind != BodyKind::Dynamic) continue;
    body.sleep_group = -1;
    body.slow_time = 0.0;
    work.bodies[i].is_moving = true;
    work.bodies[i].active = work.active_count;
    work.active[static_cast<std::size_t>(work.active_count++)] = static_cast<int>(i);
  }
}

void detect_contacts(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work,
                     StepReport& report) {
  const double dt = model.settings.dt;
  double fastest = 0.0;
  for (const BodyWork& body : work.bodies) {
    if (body.is_moving) fastest = std::max(fastest, body.speed);
  }
  // A body can be pushed by another one, so the fastest of all bounds what may close a gap in one step.
  const double reach = dt * (2.0 * fastest + 2.0 * dt * model.gravity.norm()) + 2e-5;
  const double margin = std::max(model.settings.contact_margin, 1.5 * reach);
  work.patches.clear();
  work.contacts.clear();
  std::fill_n(work.pair_done.begin(), state.pairs.size(), char{0});
  for (bool has_woken = true; has_woken;) {  // waking a group brings its pairs in
    has_woken = false;
    for (std::uint32_t i = 0; i < state.pairs.size(); ++i) {
      if (work.pair_done[i] != 0) continue;
      PairState& pair = state.pairs[i];
      const PairBodies bodies = bodies_of(model, pair);
      const BodyWork& a = work.bodies[static_cast<std::size_t>(bodies.a)];
      const BodyWork& b = work.bodies[static_cast<std::size_t>(bodies.b)];
      if (!a.is_moving && !b.is_moving) continue;
      work.pair_done[i] = 1;
      const int held = input.held.index;
      if (held >= 0 && ((bodies.a == held && !bodies.geom_b.touches_held_body) ||
                        (bodies.b == held && !bodies.geom_a.touches_held_body))) {
        pair.count = 0;
        pair.is_known = false;
        continue;
      }
      const BodyState& state_a = state.bodies[static_cast<std::size_t>(bodies.a)];
      const BodyState& state_b = state.bodies[static_cast<std::size_t>(bodies.b)];
      const RelativePose now = relative_pose(a, state_a, b, state_b);
      if (!has_kept(pair, now)) find_manifold(bodies, a, b, margin, now, pair);
      if (pair.count == 0) continue;
      const bool touches = add_contacts(model, bodies, i, reach, pair, work);
      if (!touches) continue;
      for (const int body : {bodies.a, bodies.b}) {
        const auto k = static_cast<std::size_t>(body);
        if (!is_sleeping(state.bodies[k], model.bodies[k])) continue;
        wake_group(model, state, work, state.bodies[k].sleep_group);
        has_woken = true;
      }
    }
  }
  for (const Contact& contact : work.contacts) {
    if (work.patches[static_cast<std::size_t>(contact.patch)].law->stiffness > 0.0) continue;
    report.worst_penetration = std::max(report.worst_penetration, -contact.phi);
  }
}

}  // namespace snug::physics::internal
