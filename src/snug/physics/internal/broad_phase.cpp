// Broad phase: which geoms are near each other, updated only when one may leave its fat box.
#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/geometry/bounds.hpp"
#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

using geometry::Box;
using geometry::Capsule;
using geometry::ConvexHull;
using geometry::Cylinder;

constexpr double kFatMargin = 0.008;     ///< m, around the tight box
constexpr double kLookAhead = 0.03;      ///< s, of motion that the fat box covers
constexpr std::size_t kBruteForce = 96;  ///< geoms; above it pairs are found by a sweep along x

FatBox tight_box(const geometry::Shape& shape, const Matrix3& R_WG, const Vector3& p_WG) {
  if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
    FatBox box;
    for (const Vector3& vertex : hull->vertices) {
      const Vector3 p = R_WG * vertex + p_WG;
      box.lower = box.lower.cwiseMin(p);
      box.upper = box.upper.cwiseMax(p);
    }
    return box;
  }
  Vector3 half;
  if (const auto* box = std::get_if<Box>(&shape)) {
    half = R_WG.cwiseAbs() * box->half;
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape)) {
    half = geometry::half_extent(*cylinder, R_WG);
  } else {
    const auto& capsule = std::get<Capsule>(shape);
    half = R_WG.col(2).cwiseAbs() * capsule.half_length + Vector3::Constant(capsule.radius);
  }
  return {p_WG - half, p_WG + half};
}

/// Where the box can be during this step, as the body moves now.
FatBox swept_box(const WorldModel& model, std::size_t body, const BodyWork& moving, const FatBox& tight) {
  const double dt = model.settings.dt;
  const Vector3 way = dt * moving.velocity_start + dt * dt * model.gravity;
  const double turn = dt * moving.angular_start.norm() * model.masses[body].radius;
  return {tight.lower + way.cwiseMin(0.0) - Vector3::Constant(turn),
          tight.upper + way.cwiseMax(0.0) + Vector3::Constant(turn)};
}

bool contains(const FatBox& outer, const FatBox& inner) {
  return (outer.lower.array() <= inner.lower.array()).all() && (outer.upper.array() >= inner.upper.array()).all();
}

bool overlap(const FatBox& a, const FatBox& b) {
  return (a.lower.array() <= b.upper.array()).all() && (b.lower.array() <= a.upper.array()).all();
}

bool may_touch(const WorldModel& model, int geom_a, int geom_b) {
  const int body_a = model.geoms[static_cast<std::size_t>(geom_a)].body;
  const int body_b = model.geoms[static_cast<std::size_t>(geom_b)].body;
  if (body_a == body_b) return false;
  return model.bodies[static_cast<std::size_t>(body_a)].kind == BodyKind::Dynamic ||
         model.bodies[static_cast<std::size_t>(body_b)].kind == BodyKind::Dynamic;
}

std::uint64_t key_of(int a, int b) {
  if (a > b) std::swap(a, b);
  return (static_cast<std::uint64_t>(a) << 32) | static_cast<std::uint64_t>(b);
}

void refresh_fat_boxes(const WorldModel& model, WorldState& state, Scratch& work) {
  work.moved.clear();
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const BodyState& body = state.bodies[i];
    const BodyWork& moving = work.bodies[i];
    const int first = model.first_geom[i], end = model.first_geom[i + 1];
    for (int g = first; g < end; ++g) {
      FatBox& fat = state.fat_boxes[static_cast<std::size_t>(g)];
      const bool is_valid = fat.lower.x() <= fat.upper.x();
      if (!body.is_present) {
        if (!is_valid) continue;
        fat = FatBox();
      } else {
        if (is_valid && (!moving.is_moving || moving.has_same_pose)) continue;
        const Geom& geom = model.bodies[i].geoms[static_cast<std::size_t>(g - first)];
        const Matrix3 R_WG = moving.R_WB * geom.X_BG.R;
        const Vector3 p_WG = moving.R_WB * geom.X_BG.p + moving.p_WB;
        const FatBox tight = tight_box(geom.shape, R_WG, p_WG);
        const FatBox swept = swept_box(model, i, moving, tight);
        if (contains(fat, swept)) continue;
        const Vector3 ahead = kLookAhead * moving.velocity_start;
        const Vector3 margin = Vector3::Constant(kFatMargin);
        fat.lower = swept.lower.cwiseMin(tight.lower + ahead) - margin;
        fat.upper = swept.upper.cwiseMax(tight.upper + ahead) + margin;
      }
      work.moved.push_back(g);
      work.is_moved[static_cast<std::size_t>(g)] = 1;
    }
  }
}

bool add_key(const WorldModel& model, const WorldState& state, Scratch& work, int a, int b) {
  if (!may_touch(model, a, b)) return true;
  if (!overlap(state.fat_boxes[static_cast<std::size_t>(a)], state.fat_boxes[static_cast<std::size_t>(b)])) return true;
  if (work.keys.size() == work.keys.capacity()) return false;
  work.keys.push_back(key_of(a, b));
  return true;
}

bool find_pairs_by_sweep(const WorldModel& model, const WorldState& state, Scratch& work) {
  const auto lower = [&state](int g) { return state.fat_boxes[static_cast<std::size_t>(g)].lower.x(); };
  std::sort(work.sweep_order.begin(), work.sweep_order.end(),
            [&lower](int a, int b) { return lower(a) != lower(b) ? lower(a) < lower(b) : a < b; });
  for (std::size_t i = 0; i < work.sweep_order.size(); ++i) {
    const int a = work.sweep_order[i];
    const double end = state.fat_boxes[static_cast<std::size_t>(a)].upper.x();
    const bool a_moved = work.is_moved[static_cast<std::size_t>(a)] != 0;
    for (std::size_t j = i + 1; j < work.sweep_order.size(); ++j) {
      const int b = work.sweep_order[j];
      if (lower(b) > end) break;
      if (!a_moved && work.is_moved[static_cast<std::size_t>(b)] == 0) continue;
      if (!add_key(model, state, work, a, b)) return false;
    }
  }
  return true;
}

bool find_pairs_by_force(const WorldModel& model, const WorldState& state, Scratch& work) {
  const int count = static_cast<int>(model.geoms.size());
  for (const int a : work.moved) {
    for (int b = 0; b < count; ++b) {
      if (work.is_moved[static_cast<std::size_t>(b)] != 0 && b <= a) continue;  // once per pair
      if (!add_key(model, state, work, a, b)) return false;
    }
  }
  return true;
}

/// Replaces state.pairs by the sorted keys, keeping what is known of pairs that stay.
bool merge_pairs(WorldState& state, Scratch& work) {
  if (work.keys.size() > state.pairs.capacity()) return false;
  bool is_same = work.keys.size() == state.pairs.size();
  for (std::size_t i = 0; is_same && i < work.keys.size(); ++i) {
    is_same = key_of(static_cast<int>(state.pairs[i].geom_a), static_cast<int>(state.pairs[i].geom_b)) == work.keys[i];
  }
  if (is_same) return true;
  work.knows_pairs = false;
  work.merged_pairs.clear();
  std::size_t old = 0;
  for (const std::uint64_t key : work.keys) {
    const auto a = static_cast<std::uint32_t>(key >> 32);
    const auto b = static_cast<std::uint32_t>(key);
    while (old < state.pairs.size() &&
           key_of(static_cast<int>(state.pairs[old].geom_a), static_cast<int>(state.pairs[old].geom_b)) < key) {
      ++old;
    }
    if (old < state.pairs.size() && state.pairs[old].geom_a == a && state.pairs[old].geom_b == b) {
      work.merged_pairs.push_back(state.pairs[old]);
    } else {
      PairState fresh;
      fresh.geom_a = a;
      fresh.geom_b = b;
      work.merged_pairs.push_back(fresh);
    }
  }
  std::swap(state.pairs, work.merged_pairs);
  return true;
}

}  // namespace

bool update_pairs(const WorldModel& model, WorldState& state, Scratch& work) {
  work.knows_pairs = work.knows_state;
  refresh_fat_boxes(model, state, work);
  if (work.moved.empty()) return true;
  work.keys.clear();
  bool has_room = true;
  for (const PairState& pair : state.pairs) {  // pairs of geoms that stayed in their fat boxes stay
    if (work.is_moved[pair.geom_a] == 0 && work.is_moved[pair.geom_b] == 0) {
      work.keys.push_back(key_of(static_cast<int>(pair.geom_a), static_cast<int>(pair.geom_b)));
    }
  }
  has_room = model.geoms.size() <= kBruteForce ? find_pairs_by_force(model, state, work)
                                               : find_pairs_by_sweep(model, state, work);
  for (const int g : work.moved) work.is_moved[static_cast<std::size_t>(g)] = 0;
  if (!has_room) return false;
  std::sort(work.keys.begin(), work.keys.end());
  return merge_pairs(state, work);
}

}  // namespace snug::physics::internal
