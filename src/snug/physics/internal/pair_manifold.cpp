// Manifolds of near pairs, kept while the pair hardly moves, with impulses handed on by feature.
#include "snug/physics/internal/pair_manifold.hpp"

#include <array>
#include <cmath>

#include "snug/physics/internal/face_loads.hpp"

namespace snug::physics::internal {
namespace {

// A manifold is kept while its bodies moved less than this relative to each other since it was found. Its gaps are
// still followed exactly to first order; the neglected part is angle^2 * size, below 1e-8 m for a 0.3 m box.
constexpr double kKeepDistance = 5e-5;   ///< m
constexpr double kKeepHalfAngle = 5e-5;  ///< rad/2
constexpr double kTouches = 1e-5;        ///< m, gap of a point that may bear what others did
constexpr double kMatchDistance = 4e-3;  ///< m, impulses are handed to a new feature this near to an old one

struct RelativePose {
  Vector3 p;
  Quaternion quat;
};

RelativePose relative_pose(const BodyWork& a, const BodyState& state_a, const BodyWork& b, const BodyState& state_b) {
  return {a.R_WB.transpose() * (b.p_WB - a.p_WB), state_a.quat_WB.conjugate() * state_b.quat_WB};
}

bool has_kept(const PairState& pair, const RelativePose& now, double reach) {
  if (!pair.is_known || pair.margin < reach) return false;
  if ((now.p - pair.p_AB).squaredNorm() > kKeepDistance * kKeepDistance) return false;
  // |sin(angle/2)|^2 of the rotation between then and now.
  const double along = now.quat.dot(pair.quat_AB);
  const double square = (now.quat.coeffs() - std::copysign(1.0, along) * pair.quat_AB.coeffs()).squaredNorm();
  return square <= kKeepHalfAngle * kKeepHalfAngle;
}

/// Two unit vectors that complete n; depends on n alone.
Vector3 tangent_of(const Vector3& n) {
  int smallest = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(n[i]) < std::abs(n[smallest])) smallest = i;
  }
  return n.cross(Vector3::Unit(smallest)).normalized();
}

using Impulse = std::array<double, 3>;

void turn(const Matrix3& R, const Impulse& from, Impulse& to) {
  Eigen::Map<Vector3>(to.data()) = R * Eigen::Map<const Vector3>(from.data());
}

/// Impulses of the old manifold, turned into the axes of the new one, for the new points: same feature first, else the
/// nearest old point. Returns which old points were handed on, a bit each.
std::uint32_t hand_on_impulses(const PairState& old, const Matrix3& R_new_old, PairState& pair) {
  const int old_count = old.count;
  std::uint32_t used = 0;
  for (int i = 0; i < pair.count; ++i) {
    const PairPoint& point = pair.points[static_cast<std::size_t>(i)];
    for (int j = 0; j < old_count; ++j) {
      if ((used >> j & 1U) == 0 && old.points[static_cast<std::size_t>(j)].feature == point.feature) {
        turn(R_new_old, old.impulses[static_cast<std::size_t>(j)], pair.impulses[static_cast<std::size_t>(i)]);
        used |= 1U << j;
        break;
      }
    }
  }
  for (int i = 0; i < pair.count && used != (1U << old_count) - 1U; ++i) {
    const PairPoint& point = pair.points[static_cast<std::size_t>(i)];
    if (pair.impulses[static_cast<std::size_t>(i)] != Impulse{}) continue;
    int best = -1;
    double best_square = kMatchDistance * kMatchDistance;
    for (int j = 0; j < old_count; ++j) {
      const double square = (old.points[static_cast<std::size_t>(j)].p_A - point.p_A).squaredNorm();
      if ((used >> j & 1U) == 0 && square < best_square) {
        best_square = square;
        best = j;
      }
    }
    if (best < 0) continue;
    turn(R_new_old, old.impulses[static_cast<std::size_t>(best)], pair.impulses[static_cast<std::size_t>(i)]);
    used |= 1U << best;
  }
  return used;
}

/// Columns n, t1, t2 of a pair, in A.
Matrix3 axes_of(const PairState& pair) {
  Matrix3 axes;
  axes << pair.n_A, pair.t_A, pair.n_A.cross(pair.t_A);
  return axes;
}

/// The points that touch take over the whole of what those of the old manifold bore: features come and go under a face
/// that slides or turns, its load stays.
void keep_load(const PairState& old, const geometry::Manifold& manifold, PairState& pair) {
  const Vector3 t2 = pair.n_A.cross(pair.t_A);
  const auto load_at = [&](const PairPoint& point, const Impulse& impulse, bool touches) {
    return FaceLoad{pair.t_A.dot(point.p_A), t2.dot(point.p_A), impulse[0], 1.0, touches};
  };
  std::array<FaceLoad, geometry::kMaxManifoldPoints> before, loads;
  for (std::size_t i = 0; i < static_cast<std::size_t>(old.count); ++i)
    before[i] = load_at(old.points[i], old.impulses[i], true);
  const auto count = static_cast<std::size_t>(pair.count);
  for (std::size_t i = 0; i < count; ++i)
    loads[i] = load_at(pair.points[i], pair.impulses[i], manifold.points[i].phi <= kTouches);
  if (!even_loads({loads.data(), count}, wrench_of({before.data(), static_cast<std::size_t>(old.count)}))) return;
  for (std::size_t i = 0; i < count; ++i) pair.impulses[i][0] = loads[i].load;
}

/// Returns which points of the old manifold were handed on, a bit each.
std::uint32_t find_manifold(const PairBodies& bodies, const BodyWork& a, const BodyWork& b, double margin, bool is_face,
                            const RelativePose& now, const PairState& old, PairState& pair) {
  const Pose X_WA{a.R_WB, a.p_WB}, X_WB{b.R_WB, b.p_WB};
  geometry::Manifold manifold;
  geometry::collide(bodies.geom_a.shape, X_WA * bodies.geom_a.X_BG, bodies.geom_b.shape, X_WB * bodies.geom_b.X_BG,
                    margin, pair.cache, manifold);
  pair.is_known = true;
  pair.p_AB = now.p;
  pair.quat_AB = now.quat;
  pair.margin = margin;
  pair.face_area = manifold.face_area;
  pair.is_corner_pair = manifold.is_corner_pair;
  pair.n_A = a.R_WB.transpose() * manifold.n_AB_W;
  pair.t_A = tangent_of(pair.n_A);
  pair.count = manifold.count;
  for (int i = 0; i < manifold.count; ++i) {
    const geometry::ManifoldPoint& found = manifold.points[static_cast<std::size_t>(i)];
    PairPoint& point = pair.points[static_cast<std::size_t>(i)];
    point.p_A = a.R_WB.transpose() * (found.p_WA - a.p_WB);
    point.p_B = b.R_WB.transpose() * (found.p_WB - b.p_WB);
    point.feature = found.feature;
    pair.impulses[static_cast<std::size_t>(i)] = {};
  }
  if (old.count == 0 || pair.count == 0) return 0;
  const Matrix3 R_new_old = axes_of(pair).transpose() * axes_of(old);
  const std::uint32_t handed_on = hand_on_impulses(old, R_new_old, pair);
  if (is_face) keep_load(old, manifold, pair);
  pair.turning.moment = R_new_old * old.turning.moment;
  return handed_on;
}

/// What is left of the old points: another support of the body may have the corner that bore there.
void keep_lost(const PairState& old, std::uint32_t handed_on, const PairBodies& bodies, std::uint32_t index,
               Scratch& work) {
  const bool is_b = work.bodies[static_cast<std::size_t>(bodies.b)].active >= 0;
  const Matrix3 axes_W = work.bodies[static_cast<std::size_t>(bodies.a)].R_WB * axes_of(old) * (is_b ? 1.0 : -1.0);
  for (int i = 0; i < old.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    if ((handed_on >> i & 1U) != 0 || !(old.impulses[k][0] > 0.0)) continue;
    const std::lock_guard lock(work.lost_impulses.mutex);
    if (work.lost_impulses.all.full()) return;
    work.lost_impulses.all.push_back({index, i, is_b ? bodies.b : bodies.a,
                                      is_b ? old.points[k].p_B : old.points[k].p_A, axes_W.col(0),
                                      axes_W * Eigen::Map<const Vector3>(old.impulses[k].data())});
  }
}

}  // namespace

void refresh_manifold(const PairBodies& bodies, const WorldState& state, double reach, double margin, bool is_face,
                      std::uint32_t index, Scratch& work, PairState& pair) {
  const BodyWork& a = work.bodies[static_cast<std::size_t>(bodies.a)];
  const BodyWork& b = work.bodies[static_cast<std::size_t>(bodies.b)];
  const RelativePose now = relative_pose(a, state.bodies[static_cast<std::size_t>(bodies.a)], b,
                                         state.bodies[static_cast<std::size_t>(bodies.b)]);
  if (has_kept(pair, now, reach)) return;
  const PairState old = pair;
  const std::uint32_t handed_on = find_manifold(bodies, a, b, margin, is_face, now, old, pair);
  const bool is_on_fixed = (a.active >= 0) != (b.active >= 0);
  if (is_on_fixed && !is_face) keep_lost(old, handed_on, bodies, index, work);
}

}  // namespace snug::physics::internal
