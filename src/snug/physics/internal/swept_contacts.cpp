// Swept contacts: what a body that turns fast would run into by the end of a step beside the contacts found at its start.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

constexpr double kTurn = 1e-3;   ///< m, way of a point by turning in one step from which on ends are looked at
constexpr double kDepth = 5e-4;  ///< m, more overlap than at the start from which on a step is solved again

/// Where a body is at the end of the step as solved.
struct End {
  Pose X_WB;
  Vector3 p_WBcm;
  Displacement displacement;
};

End end_of(const WorldModel& model, const Scratch& work, int index) {
  const BodyWork& body = work.bodies[static_cast<std::size_t>(index)];
  End end;
  end.displacement = displacement_of(work, index);
  end.p_WBcm = body.p_WBcm + end.displacement.way;
  const Matrix3 R_WB = exp_rotation(end.displacement.rotation) * body.R_WB;
  end.X_WB = {R_WB, end.p_WBcm - R_WB * model.bodies[static_cast<std::size_t>(index)].inertia.com};
  return end;
}

bool turns_fast(const WorldModel& model, const Scratch& work, int index) {
  return displacement_of(work, index).rotation.norm() * model.masses[static_cast<std::size_t>(index)].radius > kTurn;
}

const Geom& geom_of(const WorldModel& model, const WorldModel::GeomRef& ref) {
  return model.bodies[static_cast<std::size_t>(ref.body)].geoms[static_cast<std::size_t>(ref.geom)];
}

/// Velocity at the start of a point that is carried along.
Vector3 velocity_at(const BodyWork& body, const Vector3& arm) {
  return body.velocity_start + body.angular_start.cross(arm);
}

Vector3 way_of(const Displacement& displacement, const Vector3& arm) {
  return displacement.way + displacement.rotation.cross(arm);
}

}  // namespace

bool add_swept_contacts(const WorldModel& model, const WorldInput& input, const WorldState& state, Scratch& work) {
  (void)input;
  bool any_fast = false;
  for (int i = 0; i < static_cast<int>(work.bodies.size()) && !any_fast; ++i) any_fast = turns_fast(model, work, i);
  if (getenv("DBG")) fprintf(stderr, "pass step %ld\n", (long)state.step_index);
  if (!any_fast) return false;
  bool has_added = false;
  for (std::uint32_t i = 0; i < state.pairs.size(); ++i) {
    const PairState& pair = state.pairs[i];
    const WorldModel::GeomRef ref_a = model.geoms[pair.geom_a], ref_b = model.geoms[pair.geom_b];
    const BodyWork& a = work.bodies[static_cast<std::size_t>(ref_a.body)];
    const BodyWork& b = work.bodies[static_cast<std::size_t>(ref_b.body)];
    if (a.active < 0 && b.active < 0) continue;
    if (!turns_fast(model, work, ref_a.body) && !turns_fast(model, work, ref_b.body)) continue;
    const Geom &geom_a = geom_of(model, ref_a), &geom_b = geom_of(model, ref_b);
    const auto law = static_cast<std::size_t>(geom_a.material * model.material_count + geom_b.material);
    if (model.laws[law].stiffness > 0.0) continue;
    const End end_a = end_of(model, work, ref_a.body), end_b = end_of(model, work, ref_b.body);
    geometry::Manifold manifold;
    geometry::PairCache cache = pair.cache;
    geometry::collide(geom_a.shape, end_a.X_WB * geom_a.X_BG, geom_b.shape, end_b.X_WB * geom_b.X_BG,
                      model.settings.contact_margin, cache, manifold);
    double deepest = 0.0;
    for (int k = 0; k < manifold.count; ++k) deepest = std::min(deepest, manifold.points[static_cast<std::size_t>(k)].phi);
    if (getenv("DBG") && deepest < -1e-3) fprintf(stderr, "step %ld pair %d %d deepest %.3f mm points %d start %.3f\n", (long)state.step_index, ref_a.body, ref_b.body, 1e3*deepest, manifold.count, 1e3*work.pair_memories[i].clearance);
    if (deepest > std::min(0.0, work.pair_memories[i].clearance) - kDepth) continue;
    if (work.patches.full() || work.contacts.capacity() - work.contacts.size() < geometry::kMaxManifoldPoints) break;
    const auto index = static_cast<int>(work.patches.size());
    const Vector3& n = manifold.n_AB_W;
    Patch& patch = work.patches.push_back(Patch{});
    patch.pair = i;
    patch.body_a = ref_a.body, patch.body_b = ref_b.body;
    patch.first_contact = static_cast<int>(work.contacts.size());
    patch.contact_count = patch.row_count = manifold.count;
    patch.is_swept = true;
    patch.way_a = end_a.displacement.way, patch.way_b = end_b.displacement.way;
    patch.n = n;
    patch.t1 = n.unitOrthogonal();
    patch.t2 = n.cross(patch.t1);
    patch.law = law;
    for (int k = 0; k < manifold.count; ++k) {
      const geometry::ManifoldPoint& point = manifold.points[static_cast<std::size_t>(k)];
      const Vector3 p_WQ = 0.5 * (point.p_WA + point.p_WB);
      const Vector3 arm_a = p_WQ - end_a.p_WBcm, arm_b = p_WQ - end_b.p_WBcm;
      // Seen from the end: the gap from which the motion as solved, linear there, leads to the gap that it ends with.
      const double phi = point.phi - n.dot(way_of(end_b.displacement, arm_b) - way_of(end_a.displacement, arm_a));
      work.contacts.push_back({p_WQ, phi, n.dot(velocity_at(b, arm_b) - velocity_at(a, arm_a)), index, -1});
    }
    if (getenv("DBG")) for (int k=patch.first_contact;k<patch.first_contact+patch.contact_count;++k){ auto&c=work.contacts[k]; fprintf(stderr,"step %ld   n %.3f %.3f %.3f phi %.3f mm approach %.3f end phi %.3f shift a %.3f b %.3f mm turn %.3f %.3f\n",(long)state.step_index,n.x(),n.y(),n.z(),1e3*c.phi,c.approach,1e3*manifold.points[k-patch.first_contact].phi, 1e3*(end_a.displacement.way-0.5*work.dt*(a.velocity_start+a.velocity)).norm(),1e3*(end_b.displacement.way-0.5*work.dt*(b.velocity_start+b.velocity)).norm(), end_a.displacement.rotation.norm(), end_b.displacement.rotation.norm());}
    has_added = true;
  }
  return has_added;
}

}  // namespace snug::physics::internal
