// Swept contacts: what bodies would run into by the end of a step, beside the contacts found at its start: bodies that
// turn fast, and pairs that had none at a seam (geometry/README.md).
#include <algorithm>
#include <atomic>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

/// m, way of a body's farthest point by turning in one step. Slower bodies are not looked at.
constexpr double kFastTurn = 5e-4;
/// m, overlap which asks for contacts, at steps of 2 ms or less; twice that at 4 ms or more, where steps with many such
/// contacts are hard to solve. Of what overlapped more already, a quarter of it beyond that.
constexpr double kDeep = 1e-4, kDeepSpeed = 0.05;
double deep_in(double dt) { return std::clamp(kDeepSpeed * dt, kDeep, 2.0 * kDeep); }

bool turns_fast(const WorldModel& model, const Scratch& work, int index) {
  const BodyWork& body = work.bodies[static_cast<std::size_t>(index)];
  if (!body.is_moving) return false;
  const double radius = model.masses[static_cast<std::size_t>(index)].radius;
  return displacement_of(work, index).rotation.squaredNorm() * radius * radius > kFastTurn * kFastTurn;
}

BodyEnd end_of(const WorldModel& model, const Scratch& work, int index) {
  const BodyWork& body = work.bodies[static_cast<std::size_t>(index)];
  BodyEnd end;
  end.displacement = displacement_of(work, index);
  end.turns_fast = turns_fast(model, work, index);
  end.p_WBcm = body.p_WBcm + end.displacement.way;
  const Matrix3 R_WB = exp_rotation(end.displacement.rotation) * body.R_WB;
  end.X_WB = {R_WB, end.p_WBcm - R_WB * model.bodies[static_cast<std::size_t>(index)].inertia.com};
  return end;
}

const Geom& geom_of(const WorldModel& model, const WorldModel::GeomRef& ref) {
  return model.bodies[static_cast<std::size_t>(ref.body)].geoms[static_cast<std::size_t>(ref.geom)];
}

/// Displacement of a point, as linear as the contact rows take it.
Vector3 way_of(const BodyEnd& end, const Vector3& p_WQ) {
  return end.displacement.way + end.displacement.rotation.cross(p_WQ - end.p_WBcm);
}

/// Velocity that the point had at the start if it is carried along.
Vector3 start_velocity_of(const BodyWork& body, const BodyEnd& end, const Vector3& p_WQ) {
  return body.velocity_start + body.angular_start.cross(p_WQ - end.p_WBcm);
}

/// Contacts as seen from the end of the step: its arms and normal, and the gap from which the motion as solved leads to
/// the gap that it ends with.
void add_patch(std::uint32_t index, int body_a, int body_b, std::size_t law, const geometry::Manifold& manifold,
               Scratch& work) {
  const BodyEnd& end_a = work.ends[static_cast<std::size_t>(body_a)];
  const BodyEnd& end_b = work.ends[static_cast<std::size_t>(body_b)];
  const Vector3& n = manifold.n_AB_W;
  const int patch_index = static_cast<int>(work.patches.size());
  Patch& patch = work.patches.push_back(Patch{});
  patch.pair = index;
  patch.body_a = body_a;
  patch.body_b = body_b;
  patch.first_contact = static_cast<int>(work.contacts.size());
  patch.contact_count = patch.row_count = manifold.count;
  patch.is_swept = true;
  patch.way_a = end_a.displacement.way;
  patch.way_b = end_b.displacement.way;
  patch.n = n;
  patch.t1 = n.unitOrthogonal();
  patch.t2 = n.cross(patch.t1);
  patch.law = law;
  for (int i = 0; i < manifold.count; ++i) {
    const geometry::ManifoldPoint& point = manifold.points[static_cast<std::size_t>(i)];
    const Vector3 p_WQ = 0.5 * (point.p_WA + point.p_WB);
    const Vector3 v = start_velocity_of(work.bodies[static_cast<std::size_t>(body_b)], end_b, p_WQ) -
                      start_velocity_of(work.bodies[static_cast<std::size_t>(body_a)], end_a, p_WQ);
    const double phi = point.phi - n.dot(way_of(end_b, p_WQ) - way_of(end_a, p_WQ));
    work.contacts.push_back({p_WQ, phi, n.dot(v), patch_index, -1});
  }
}

double deepest_of(const geometry::Manifold& manifold) {
  double phi = 0.0;
  for (int i = 0; i < manifold.count; ++i) phi = std::min(phi, manifold.points[static_cast<std::size_t>(i)].phi);
  return phi;
}

/// Wakes what a pair runs into. Whether something slept.
bool wake_pair(const WorldModel& model, WorldState& state, Scratch& work, int body_a, int body_b) {
  bool has_woken = false;
  for (const int index : {body_a, body_b}) {
    const int group = state.bodies[static_cast<std::size_t>(index)].sleep_group;
    if (group < 0 || model.bodies[static_cast<std::size_t>(index)].kind != BodyKind::Dynamic) continue;
    wake_group(model, state, work, group);
    has_woken = true;
  }
  return has_woken;
}

/// Whether there is something to look at: then all ends are known.
bool find_ends(const WorldModel& model, Scratch& work) {
  std::atomic<bool> is_one_fast{work.has_corner_pairs};
  const std::size_t count = work.bodies.size();
  for_ranges(work.pool, count, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end && !is_one_fast; ++i) {
      if (turns_fast(model, work, static_cast<int>(i))) is_one_fast = true;
    }
  });
  if (!is_one_fast) return false;
  std::atomic<bool> is_finite{true};  // else the end of the step names the body
  for_ranges(work.pool, count, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      work.ends[i] = end_of(model, work, static_cast<int>(i));
      if (!work.ends[i].X_WB.p.allFinite() || !work.ends[i].X_WB.R.allFinite()) is_finite = false;
    }
  });
  return is_finite;
}

/// A pair that could meet beside its contacts: rigid, and one of the bodies turns fast, or corners of both are flush.
bool may_meet(const WorldModel& model, const PairState& pair, const Scratch& work, std::size_t& law) {
  const WorldModel::GeomRef &a = model.geoms[pair.geom_a], &b = model.geoms[pair.geom_b];
  const bool is_of_interest = pair.is_corner_pair || work.ends[static_cast<std::size_t>(a.body)].turns_fast ||
                              work.ends[static_cast<std::size_t>(b.body)].turns_fast;
  if (!is_of_interest || !pair.is_known) return false;  // unknown: passes through what is held
  law = static_cast<std::size_t>(geom_of(model, a).material * model.material_count + geom_of(model, b).material);
  return model.laws[law].stiffness <= 0.0;  // else gives way by its law
}

/// Whether the pair overlaps at the end of the step much more than at its start.
bool meets(const WorldModel& model, const PairState& pair, double clearance, const Scratch& work,
           geometry::Manifold& manifold) {
  const WorldModel::GeomRef &a = model.geoms[pair.geom_a], &b = model.geoms[pair.geom_b];
  const Geom &geom_a = geom_of(model, a), &geom_b = geom_of(model, b);
  geometry::PairCache cache = pair.cache;
  geometry::collide(geom_a.shape, work.ends[static_cast<std::size_t>(a.body)].X_WB * geom_a.X_BG, geom_b.shape,
                    work.ends[static_cast<std::size_t>(b.body)].X_WB * geom_b.X_BG, model.settings.contact_margin,
                    cache, manifold);
  const double deep = deep_in(model.settings.dt);
  return !(deepest_of(manifold) > std::min(-deep, clearance - 0.25 * deep));
}

/// Marks in work.pair_done the pairs that are not to be looked at in turn.
void leave_out_pairs(const WorldModel& model, const WorldState& state, Scratch& work) {
  for_ranges(work.pool, state.pairs.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      std::size_t law = 0;
      geometry::Manifold manifold;
      const bool is_of_interest = may_meet(model, state.pairs[i], work, law) &&
                                  meets(model, state.pairs[i], work.pair_memories[i].clearance, work, manifold);
      work.pair_done[i] = is_of_interest ? 0 : 1;
    }
  });
}

}  // namespace

Swept add_swept_contacts(const WorldModel& model, WorldState& state, Scratch& work) {
  if (!find_ends(model, work)) return Swept::Nothing;
  const bool are_left_out = is_shared(work.pool, state.pairs.size());
  if (are_left_out) leave_out_pairs(model, state, work);
  bool has_added = false, has_woken = false;
  for (std::uint32_t i = 0; i < state.pairs.size(); ++i) {
    if (are_left_out && work.pair_done[i] != 0) continue;
    const PairState& pair = state.pairs[i];
    std::size_t law = 0;
    if (!may_meet(model, pair, work, law)) continue;
    const int a = model.geoms[pair.geom_a].body, b = model.geoms[pair.geom_b].body;
    if (work.bodies[static_cast<std::size_t>(a)].active < 0 && work.bodies[static_cast<std::size_t>(b)].active < 0)
      continue;
    geometry::Manifold manifold;
    if (!meets(model, pair, work.pair_memories[i].clearance, work, manifold)) continue;
    if (wake_pair(model, state, work, a, b)) {
      has_woken = true;
      continue;
    }
    if (work.patches.full() || work.contacts.capacity() - work.contacts.size() < geometry::kMaxManifoldPoints) break;
    add_patch(i, a, b, law, manifold, work);
    has_added = true;
  }
  return has_woken ? Swept::Sleepers : has_added ? Swept::Contacts : Swept::Nothing;
}

}  // namespace snug::physics::internal
