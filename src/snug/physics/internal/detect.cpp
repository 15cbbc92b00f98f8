// Contact detection: the contacts that can matter within a step, and what they wake.
#include <algorithm>

#include "snug/physics/internal/pair_manifold.hpp"

namespace snug::physics::internal {
namespace {

constexpr double kTouchGap = 1e-5;  ///< m, a pair nearer than this at the end of a step wakes sleepers

double approach_at(const Vector3& p_WQ, const Vector3& n, const BodyWork& a, const BodyWork& b) {
  const Vector3 v = (b.velocity_start + b.angular_start.cross(p_WQ - b.p_WBcm)) -
                    (a.velocity_start + a.angular_start.cross(p_WQ - a.p_WBcm));
  return n.dot(v);
}

bool is_touching(const Contact& contact, double dt) {
  return contact.phi + dt * std::min(0.0, contact.approach) <= kTouchGap;
}

/// Takes over the pair's contacts of the last step as they stand. Only when neither body has moved and the reach asks
/// for the same points. Returns whether one of them touches.
bool keep_contacts(PairMemory& memory, double dt, Scratch& work) {
  ++memory.stamp;
  const BodyWork& a = work.bodies[static_cast<std::size_t>(memory.body_a)];
  const BodyWork& b = work.bodies[static_cast<std::size_t>(memory.body_b)];
  work.patches.resize(work.patches.size() + 1);
  Patch& patch = work.patches.back();
  patch.is_kept = true;
  work.contacts.resize(work.contacts.size() + static_cast<std::size_t>(patch.contact_count));
  bool touches = false;
  for (int i = patch.first_contact; i < patch.first_contact + patch.contact_count; ++i) {
    Contact& contact = work.contacts[static_cast<std::size_t>(i)];
    contact.approach = approach_at(contact.p_WQ, patch.n, a, b);
    touches |= is_touching(contact, dt);
  }
  return touches;
}

bool can_keep(const PairMemory& memory, double reach, const Scratch& work) {
  if (memory.patch < 0 || static_cast<std::size_t>(memory.patch) != work.patches.size()) return false;
  const Patch& patch = *(work.patches.begin() + memory.patch);  // of the last step, still at its place
  return static_cast<std::size_t>(patch.first_contact) == work.contacts.size() && reach >= patch.reach_from &&
         reach < patch.reach_to;
}

/// Of the stiffness of a whole face, for boxes whose faces overlap by this much.
double share_of(const ContactLaw& law, double face_area) {
  return face_area < law.full_area ? std::max(law.edge_share, face_area / law.full_area) : 1.0;
}

/// Writes the pair's points that can matter within this step, and forgets the impulses of the others. Says what of them
/// all the walk over the pairs has to know.
PairVisit find_contacts(const PairBodies& bodies, double reach, double dt, const Scratch& work, PairState& pair,
                        Contact* contacts) {
  const BodyWork& a = work.bodies[static_cast<std::size_t>(bodies.a)];
  const BodyWork& b = work.bodies[static_cast<std::size_t>(bodies.b)];
  const Vector3 n = a.R_WB * pair.n_A;
  PairVisit visit;
  visit.count = 0;
  visit.clearance = pair.is_corner_pair ? 0.0 : pair.margin;
  visit.reach_to = pair.margin;
  for (int i = 0; i < pair.count; ++i) {
    const PairPoint& point = pair.points[static_cast<std::size_t>(i)];
    const Vector3 p_WA = a.R_WB * point.p_A + a.p_WB;
    const Vector3 p_WB = b.R_WB * point.p_B + b.p_WB;
    const double phi = n.dot(p_WB - p_WA);
    visit.clearance = std::min(visit.clearance, phi);
    if (phi > reach) {
      pair.impulses[static_cast<std::size_t>(i)] = {};
      visit.reach_to = std::min(visit.reach_to, phi);
      continue;
    }
    visit.reach_from = std::max(visit.reach_from, phi);
    const Vector3 p_WQ = 0.5 * (p_WA + p_WB);
    Contact& contact = contacts[visit.count++];
    contact = {p_WQ, phi, approach_at(p_WQ, n, a, b), 0, i, false};
    visit.touches |= is_touching(contact, dt);
  }
  if (visit.count == 0) pair.turning = {};
  return visit;
}

/// For the contacts of one more pair.
bool has_room(const Scratch& work) {
  return work.contacts.capacity() - work.contacts.size() >= geometry::kMaxManifoldPoints;
}

/// Takes room for the contacts of a visit. Returns whether one of them touches.
bool place_contacts(const PairBodies& bodies, std::uint32_t index, const PairVisit& visit, Scratch& work) {
  PairMemory& memory = work.pair_memories[index];
  memory = {bodies.a, bodies.b, -1, visit.clearance, work.stamp + 1};
  if (visit.count == 0) return false;
  work.has_too_many_contacts |= !has_room(work);
  if (work.has_too_many_contacts) return visit.touches;
  const std::size_t first = work.contacts.size();
  memory.patch = static_cast<int>(work.patches.size());
  work.contacts.resize(first + static_cast<std::size_t>(visit.count));
  work.patches.resize(work.patches.size() + 1);
  Patch& patch = work.patches.back();
  patch.is_kept = false;
  patch.pair = index;
  patch.first_contact = static_cast<int>(first);
  patch.contact_count = visit.count;
  return visit.touches;
}

/// A patch that has its place, with contacts that are in theirs.
void fill_patch(const WorldModel& model, const PairBodies& bodies, const PairState& pair, const PairVisit& visit,
                int index, Scratch& work) {
  const Matrix3& R_WA = work.bodies[static_cast<std::size_t>(bodies.a)].R_WB;
  const Matrix3& R_WB = work.bodies[static_cast<std::size_t>(bodies.b)].R_WB;
  Patch& patch = work.patches[static_cast<std::size_t>(index)];
  const std::uint32_t pair_index = patch.pair;
  const int first_contact = patch.first_contact;
  patch = Patch{};
  patch.pair = pair_index;
  patch.body_a = bodies.a;
  patch.body_b = bodies.b;
  patch.first_contact = first_contact;
  patch.contact_count = visit.count;
  patch.reach_from = visit.reach_from;
  patch.reach_to = visit.reach_to;
  patch.n = R_WA * pair.n_A;
  patch.t1 = R_WA * pair.t_A;
  patch.t2 = patch.n.cross(patch.t1);
  patch.law = static_cast<std::size_t>(bodies.geom_a.material * model.material_count + bodies.geom_b.material);
  patch.share = share_of(model.laws[patch.law], pair.face_area);
  patch.row_count = visit.count + count_turning_rows(model.laws[patch.law]);
  patch.belt_W = R_WB * bodies.geom_b.surface_velocity - R_WA * bodies.geom_a.surface_velocity;
  patch.has_belt = !patch.belt_W.isZero(0.0);
  Contact* const contacts = work.contacts.begin() + first_contact;
  for (int i = 0; i < visit.count; ++i) contacts[i].patch = index;
}

/// Adds the pair's contacts. Returns whether one of them touches.
bool add_contacts(const WorldModel& model, const PairBodies& bodies, std::uint32_t index, double reach, PairState& pair,
                  Scratch& work) {
  Contact* const contacts = has_room(work) ? work.contacts.room(geometry::kMaxManifoldPoints) : work.no_room.data();
  const PairVisit visit = find_contacts(bodies, reach, model.settings.dt, work, pair, contacts);
  const bool touches = place_contacts(bodies, index, visit, work);
  const int patch = work.pair_memories[index].patch;
  if (patch >= 0) fill_patch(model, bodies, pair, visit, patch, work);
  return touches;
}

/// Takes back the contacts that the pair has just added.
void forget_contacts(std::uint32_t index, Scratch& work) {
  PairMemory& memory = work.pair_memories[index];
  work.pair_done[index] = 0;
  memory.stamp = 0;
  if (memory.patch < 0) return;
  memory.patch = -1;
  work.contacts.resize(static_cast<std::size_t>(work.patches.back().first_contact));
  work.patches.resize(work.patches.size() - 1);
}

PairMemory memory_of(const WorldModel& model, const PairState& pair) {
  return {model.geoms[pair.geom_a].body, model.geoms[pair.geom_b].body, -1, -1.0, 0};
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
    work.is_moving[i] = 1;
    work.bodies[i].active = work.active_count;
    work.active[static_cast<std::size_t>(work.active_count++)] = static_cast<int>(i);
  }
}

namespace {

/// Whether the law of the pair bears on edges or faces.
bool is_face(const WorldModel& model, const PairBodies& bodies) {
  return model.law(bodies.geom_a.material, bodies.geom_b.material).bearing != Bearing::Corners;
}

/// A held body may go through what is listed as not touching it.
bool ignores_held(const PairBodies& bodies, const WorldInput& input) {
  const int held = input.held.index;
  return held >= 0 && ((bodies.a == held && !bodies.geom_b.touches_held_body) ||
                       (bodies.b == held && !bodies.geom_a.touches_held_body));
}

/// Whether the pair stands where it stood in the last step, so that what the workspace remembers of it holds.
bool is_same(const PairMemory& memory, const Scratch& work) {
  return memory.stamp >= std::max(work.still_since[static_cast<std::size_t>(memory.body_a)],
                                  work.still_since[static_cast<std::size_t>(memory.body_b)]);
}

/// Whether a pair that stands where it stood is too far apart to matter.
bool stays_clear(const PairMemory& memory, double reach) { return memory.patch < 0 && memory.clearance > reach; }

/// Visits of the pairs whose bodies move, side by side: of everything but the order in which their contacts lie. What
/// sleepers that wake bring in is found later.
void visit_pairs(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work, double reach,
                 double margin) {
  work.has_visits = is_shared(work.pool, state.pairs.size());
  if (!work.has_visits) return;
  work.visits.resize(state.pairs.size());
  for_ranges(work.pool, state.pairs.size(), [&](std::size_t first, std::size_t end) {
    PairContacts found;
    for (std::size_t i = first; i < end; ++i) {
      PairState& pair = state.pairs[i];
      PairMemory& memory = work.pair_memories[i];
      work.visits[i].count = PairVisit::kNone;
      if (!work.knows_pairs) memory = memory_of(model, pair);
      const auto a = static_cast<std::size_t>(memory.body_a), b = static_cast<std::size_t>(memory.body_b);
      if (work.is_moving[a] == 0 && work.is_moving[b] == 0) continue;
      const PairBodies bodies = bodies_of(model, pair);
      if (ignores_held(bodies, input) || (is_same(memory, work) && stays_clear(memory, reach))) continue;
      refresh_manifold(bodies, state, reach, margin, is_face(model, bodies), static_cast<std::uint32_t>(i), work, pair);
      work.visits[i] = find_contacts(bodies, reach, model.settings.dt, work, pair, found.data());
    }
  });
}

/// The contacts of visited pairs, which have their places now. They are found once more, in place: cheaper than to keep
/// them all and copy them on one thread.
void fill_visited(const WorldModel& model, double reach, WorldState& state, Scratch& work) {
  if (!work.has_visits || work.has_too_many_contacts) return;
  for_ranges(work.pool, work.patches.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
      const Patch& patch = work.patches[i];
      if (patch.is_kept || work.visits[patch.pair].count == PairVisit::kNone) continue;
      PairState& pair = state.pairs[patch.pair];
      const PairBodies bodies = bodies_of(model, pair);
      Contact* const contacts = work.contacts.begin() + patch.first_contact;
      const PairVisit visit = find_contacts(bodies, reach, model.settings.dt, work, pair, contacts);
      fill_patch(model, bodies, pair, visit, static_cast<int>(i), work);
    }
  });
}

/// Whether the pair may end the step inside each other although it has no contacts at its start.
bool is_rigid_corner_pair(const WorldModel& model, const PairBodies& bodies, const PairState& pair) {
  return pair.is_corner_pair && model.law(bodies.geom_a.material, bodies.geom_b.material).stiffness <= 0.0;
}

/// One pair. Returns whether it touches.
bool visit_pair(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work, std::uint32_t index,
                double reach, double margin) {
  PairState& pair = state.pairs[index];
  const PairBodies bodies = bodies_of(model, pair);
  const bool was_visited = work.has_visits && work.visits[index].count != PairVisit::kNone;
  if (!was_visited && ignores_held(bodies, input)) {
    pair.count = 0;
    pair.is_known = false;
    work.pair_memories[index] = {bodies.a, bodies.b, -1, -1.0, 0};
    return false;
  }
  if (!was_visited) refresh_manifold(bodies, state, reach, margin, is_face(model, bodies), index, work, pair);
  work.has_corner_pairs |= is_rigid_corner_pair(model, bodies, pair);
  return was_visited ? place_contacts(bodies, index, work.visits[index], work)
                     : add_contacts(model, bodies, index, reach, pair, work);
}

/// One walk over the pairs that were not looked at before. Whether something woke: then others matter.
bool walk_pairs(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work, double reach,
                double margin) {
  bool has_woken = false;
  for (std::uint32_t i = 0; i < state.pairs.size(); ++i) {
    if (work.pair_done[i] != 0) continue;
    PairMemory& memory = work.pair_memories[i];
    if (!work.knows_pairs && !work.has_visits) memory = memory_of(model, state.pairs[i]);
    const auto a = static_cast<std::size_t>(memory.body_a), b = static_cast<std::size_t>(memory.body_b);
    if (work.is_moving[a] == 0 && work.is_moving[b] == 0) continue;
    work.pair_done[i] = 1;
    const bool is_held = memory.body_a == input.held.index || memory.body_b == input.held.index;
    const bool stands = is_same(memory, work) && !is_held;
    if (stands && stays_clear(memory, reach)) continue;
    // Contacts can stand where they stood only if they were there in the last step.
    const bool touches = stands && memory.stamp == work.stamp && can_keep(memory, reach, work)
                             ? keep_contacts(memory, model.settings.dt, work)
                             : visit_pair(model, input, state, work, i, reach, margin);
    if (!touches) {
      // A sleeper that a moving kinematic body comes near but does not reach: nothing to solve, unless it is woken.
      if (work.bodies[a].active < 0 && work.bodies[b].active < 0) forget_contacts(i, work);
      continue;
    }
    for (const std::size_t k : {a, b}) {
      if (!is_sleeping(state.bodies[k], model.bodies[k])) continue;
      wake_group(model, state, work, state.bodies[k].sleep_group);
      has_woken = true;
    }
  }
  return has_woken;
}

/// The deepest contacts at the start of the step.
void report_depth(const WorldModel& model, const Scratch& work, StepReport& report) {
  for (const Contact& contact : work.contacts) {
    const bool is_deeper = -contact.phi > std::min(report.worst_penetration, report.worst_compliant_depth);
    if (!is_deeper) continue;
    const Patch& patch = work.patches[static_cast<std::size_t>(contact.patch)];
    const bool is_rigid = model.laws[patch.law].stiffness <= 0.0;
    double& worst = is_rigid ? report.worst_penetration : report.worst_compliant_depth;
    if (!(-contact.phi > worst)) continue;
    worst = -contact.phi;
    BodyPair& pair = is_rigid ? report.worst_penetration_pair : report.worst_compliant_pair;
    pair.a = BodyId{patch.body_a};
    pair.b = BodyId{patch.body_b};
  }
}

}  // namespace

void detect_contacts(const WorldModel& model, const WorldInput& input, WorldState& state, Scratch& work,
                     StepReport& report) {
  const double dt = model.settings.dt;
  double fastest = 0.0;
  for (std::size_t i = 0; i < work.bodies.size(); ++i) {
    const BodyWork& body = work.bodies[i];
    work.is_moving[i] = body.is_moving ? 1 : 0;
    if (!body.has_same_pose) work.still_since[i] = work.stamp + 1;
    if (body.is_moving) fastest = std::max(fastest, body.speed);
  }
  // A body can be pushed by another one, so the fastest of all bounds what may close a gap in one step.
  const double reach = dt * (2.0 * fastest + 2.0 * dt * model.gravity.norm()) + 2e-5;
  const double margin = std::max(model.settings.contact_margin, 1.5 * reach);
  work.patches.clear();
  work.contacts.clear();
  work.has_too_many_contacts = work.has_corner_pairs = false;
  work.lost_impulses.all.clear();
  work.pair_memories.resize(state.pairs.size());
  work.pair_done.resize(state.pairs.size());
  std::fill(work.pair_done.begin(), work.pair_done.end(), char{0});
  visit_pairs(model, input, state, work, reach, margin);
  while (walk_pairs(model, input, state, work, reach, margin)) {  // waking a group brings its pairs in
  }
  fill_visited(model, reach, state, work);
  mark_covered_contacts(model, state, work);
  bear_on_faces(model, state, work);
  report_depth(model, work, report);
}

}  // namespace snug::physics::internal
