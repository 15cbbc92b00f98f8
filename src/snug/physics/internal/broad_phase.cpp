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
  const Vector3 way = 0.5 * dt * (moving.velocity_start + moving.velocity) + dt * dt * model.gravity;
  const double turn = 0.5 * dt * (moving.angular_start + moving.angular).norm() * model.masses[body].radius;
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

/// Whether the box had to change.
bool refresh_fat_box(const WorldModel& model, std::size_t body, const BodyWork& moving, const Geom& geom, FatBox& fat) {
  const Matrix3 R_WG = moving.R_WB * geom.X_BG.R;
  const Vector3 p_WG = moving.R_WB * geom.X_BG.p + moving.p_WB;
  const FatBox tight = tight_box(geom.shape, R_WG, p_WG);
  const FatBox swept = swept_box(model, body, moving, tight);
  if (contains(fat, swept)) return false;
  const Vector3 ahead = kLookAhead * moving.velocity_start;
  const Vector3 margin = Vector3::Constant(kFatMargin);
  fat.lower = swept.lower.cwiseMin(tight.lower + ahead) - margin;
  fat.upper = swept.upper.cwiseMax(tight.upper + ahead) + margin;
  return true;
}

void refresh_body(const WorldModel& model, WorldState& state, Scratch& work, std::size_t index) {
  const BodyWork& moving = work.bodies[index];
  const int first = model.first_geom[index], end = model.first_geom[index + 1];
  for (int g = first; g < end; ++g) {
    FatBox& fat = state.fat_boxes[static_cast<std::size_t>(g)];
    const bool is_valid = fat.lower.x() <= fat.upper.x();
    if (!state.bodies[index].is_present) {
      if (!is_valid) continue;
      fat = FatBox();
    } else {
      if (is_valid && (!moving.is_moving || moving.has_same_pose)) continue;
      const Geom& geom = model.bodies[index].geoms[static_cast<std::size_t>(g - first)];
      if (!refresh_fat_box(model, index, moving, geom, fat)) continue;
    }
    work.is_moved[static_cast<std::size_t>(g)] = 1;
  }
}

/// Marks and lists the geoms whose boxes changed.
void refresh_fat_boxes(const WorldModel& model, WorldState& state, Scratch& work) {
  for_ranges(work.pool, model.bodies.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) refresh_body(model, state, work, i);
  });
  work.moved.clear();
  for (std::size_t g = 0; g < work.is_moved.size(); ++g) {
    if (work.is_moved[g] != 0) work.moved.push_back(static_cast<int>(g));
  }
}

bool add_key(const WorldModel& model, const WorldState& state, Scratch& work, int a, int b) {
  if (!may_touch(model, a, b)) return true;
  if (!overlap(state.fat_boxes[static_cast<std::size_t>(a)], state.fat_boxes[static_cast<std::size_t>(b)])) return true;
  if (work.new_keys.size() == work.new_keys.capacity()) return false;
  work.new_keys.push_back(key_of(a, b));
  return true;
}

/// Orders the geoms by where their boxes begin along x, which changed for few.
void order_sweep(const WorldState& state, Scratch& work) {
  const auto is_before = [&state](int a, int b) {
    const double x_a = state.fat_boxes[static_cast<std::size_t>(a)].lower.x();
    const double x_b = state.fat_boxes[static_cast<std::size_t>(b)].lower.x();
    return x_a != x_b ? x_a < x_b : a < b;
  };
  std::vector<int>& order = work.sweep_order;
  const auto is_moved = [&work](int g) { return work.is_moved[static_cast<std::size_t>(g)] != 0; };
  std::sort(work.moved.begin(), work.moved.end(), is_before);
  const auto kept_end = std::remove_if(order.begin(), order.end(), is_moved);
  if (!std::is_sorted(order.begin(), kept_end, is_before)) std::sort(order.begin(), kept_end, is_before);
  // From the back, so that the places of those that moved are overwritten last.
  auto kept = kept_end;
  auto moved = work.moved.end();
  for (auto out = order.end(); moved != work.moved.begin();) {
    const bool takes_kept = kept != order.begin() && is_before(*(moved - 1), *(kept - 1));
    *--out = takes_kept ? *--kept : *--moved;
  }
}

/// Those that begin within the box of another one, of which at least one moved.
bool find_pairs_by_sweep(const WorldModel& model, const WorldState& state, Scratch& work) {
  order_sweep(state, work);
  const auto lower = [&state](int g) { return state.fat_boxes[static_cast<std::size_t>(g)].lower.x(); };
  std::size_t next = 0;  // of those that moved: the first behind a
  for (std::size_t i = 0; i < work.sweep_order.size(); ++i) {
    const int a = work.sweep_order[i];
    const double end = state.fat_boxes[static_cast<std::size_t>(a)].upper.x();
    const bool a_moved = next < work.moved.size() && work.moved[next] == a;
    if (a_moved) ++next;
    const std::vector<int>& others = a_moved ? work.sweep_order : work.moved;
    for (std::size_t j = a_moved ? i + 1 : next; j < others.size() && !(lower(others[j]) > end); ++j) {
      if (!add_key(model, state, work, a, others[j])) return false;
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

/// What matters of a pair: points beyond its count are not read.
void copy_pair(const PairState& from, PairState& to) {
  to.geom_a = from.geom_a, to.geom_b = from.geom_b;
  to.cache = from.cache;
  to.count = from.count;
  to.is_known = from.is_known;
  to.is_corner_pair = from.is_corner_pair;
  to.p_AB = from.p_AB;
  to.quat_AB = from.quat_AB;
  to.margin = from.margin;
  to.face_area = from.face_area;
  to.n_A = from.n_A, to.t_A = from.t_A;
  std::copy_n(from.points.begin(), from.count, to.points.begin());
  std::copy_n(from.impulses.begin(), from.count, to.impulses.begin());
  to.turning = from.turning;
}

std::uint64_t key_of(const PairState& pair) {
  return key_of(static_cast<int>(pair.geom_a), static_cast<int>(pair.geom_b));
}

/// Replaces state.pairs by those of work.keys, keeping what is known of pairs that stay. In place: both are sorted, so
/// where a pair moves down, the one that was there is gone or moved down before; where it moves up, from the end, too.
void replace_pairs(WorldState& state, Scratch& work) {
  constexpr int kNew = -1;
  const std::size_t count = work.keys.size();
  std::size_t old = 0;
  work.pair_origin.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    while (old < work.old_keys.size() && work.old_keys[old] < work.keys[i]) ++old;
    const bool is_old = old < work.old_keys.size() && work.old_keys[old] == work.keys[i];
    work.pair_origin[i] = is_old ? static_cast<int>(old) : kNew;
  }
  state.pairs.resize(std::max(count, work.old_keys.size()));
  const auto take = [&](std::size_t i) {
    copy_pair(state.pairs[static_cast<std::size_t>(work.pair_origin[i])], state.pairs[i]);
  };
  for (std::size_t i = 0; i < count; ++i) {
    if (work.pair_origin[i] > static_cast<int>(i)) take(i);
  }
  for (std::size_t i = count; i-- > 0;) {
    if (work.pair_origin[i] != kNew && work.pair_origin[i] < static_cast<int>(i)) take(i);
  }
  state.pairs.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (work.pair_origin[i] != kNew) continue;
    PairState& pair = state.pairs[i];
    pair = PairState{};
    pair.geom_a = static_cast<std::uint32_t>(work.keys[i] >> 32);
    pair.geom_b = static_cast<std::uint32_t>(work.keys[i]);
  }
}

}  // namespace

bool update_pairs(const WorldModel& model, WorldState& state, Scratch& work) {
  work.knows_pairs = work.knows_state;
  refresh_fat_boxes(model, state, work);
  if (work.moved.empty()) return true;
  work.new_keys.clear();
  const bool has_room = model.geoms.size() <= kBruteForce ? find_pairs_by_force(model, state, work)
                                                          : find_pairs_by_sweep(model, state, work);
  std::sort(work.new_keys.begin(), work.new_keys.end());
  work.old_keys.clear();
  for (const PairState& pair : state.pairs) work.old_keys.push_back(key_of(pair));
  work.keys.clear();
  auto next = work.new_keys.begin();
  for (const std::uint64_t key : work.old_keys) {  // pairs of geoms that stayed in their fat boxes stay
    if (work.is_moved[key >> 32] != 0 || work.is_moved[key & 0xffffffffU] != 0) continue;
    while (next != work.new_keys.end() && *next < key) work.keys.push_back(*next++);
    work.keys.push_back(key);
  }
  work.keys.insert(work.keys.end(), next, work.new_keys.end());
  for (const int g : work.moved) work.is_moved[static_cast<std::size_t>(g)] = 0;
  if (!has_room || work.keys.size() > model.pair_capacity) return false;
  if (work.keys == work.old_keys) return true;
  work.knows_pairs = false;
  replace_pairs(state, work);
  return true;
}

}  // namespace snug::physics::internal
