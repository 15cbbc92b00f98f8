// World: the derived parts of a model, states, and what can be asked of them.
#include "snug/physics/world.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <cmath>

#include "snug/core/hash.hpp"
#include "snug/physics/internal/scratch.hpp"

namespace snug::physics {
namespace {

double radius_of(const Geom& geom, const Vector3& p_BBcm) {
  using geometry::Box;
  using geometry::Capsule;
  using geometry::Cylinder;
  const Vector3 p_BcmG = geom.X_BG.p - p_BBcm;
  if (const auto* box = std::get_if<Box>(&geom.shape)) return p_BcmG.norm() + box->half.norm();
  if (const auto* capsule = std::get_if<Capsule>(&geom.shape)) {
    return p_BcmG.norm() + capsule->half_length + capsule->radius;
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&geom.shape)) {
    return p_BcmG.norm() + std::hypot(cylinder->half_length, cylinder->radius);
  }
  double radius = 0.0;
  for (const Vector3& vertex : std::get<geometry::ConvexHull>(geom.shape).vertices) {
    radius = std::max(radius, (geom.X_BG * vertex - p_BBcm).norm());
  }
  return radius;
}

WorldModel::MassProperties mass_properties_of(const BodyModel& body) {
  WorldModel::MassProperties mass;
  const Vector3 com = body.kind == BodyKind::Dynamic ? body.inertia.com : Vector3(Vector3::Zero());
  for (const Geom& geom : body.geoms) mass.radius = std::max(mass.radius, radius_of(geom, com));
  if (body.geoms.empty()) {  // nothing to touch with, but its turning still counts in tolerances
    mass.radius = std::sqrt(body.inertia.inertia.trace() / body.inertia.mass);
  }
  if (body.kind != BodyKind::Dynamic) return mass;
  mass.inverse_mass = 1.0 / body.inertia.mass;
  const Matrix3& inertia = body.inertia.inertia;
  if (inertia.isDiagonal(1e-15)) {
    mass.inverse_inertia = inertia.diagonal().cwiseInverse();
    return mass;
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(inertia);
  mass.inverse_inertia = eigen.eigenvalues().cwiseInverse();
  mass.R_BI = eigen.eigenvectors();
  if (mass.R_BI.determinant() < 0.0) mass.R_BI.col(0) *= -1.0;
  return mass;
}

}  // namespace

bool BodyState::operator==(const BodyState& other) const {
  return p_WBcm == other.p_WBcm && quat_WB.coeffs() == other.quat_WB.coeffs() && velocity == other.velocity &&
         angular_velocity == other.angular_velocity && slow_time == other.slow_time &&
         sleep_group == other.sleep_group && is_present == other.is_present;
}

bool PairState::operator==(const PairState& other) const {
  return geom_a == other.geom_a && geom_b == other.geom_b && cache == other.cache && count == other.count &&
         is_known == other.is_known && p_AB == other.p_AB && quat_AB.coeffs() == other.quat_AB.coeffs() &&
         is_corner_pair == other.is_corner_pair && margin == other.margin && face_area == other.face_area &&
         n_A == other.n_A && t_A == other.t_A && turning == other.turning &&
         std::equal(points.begin(), points.begin() + count, other.points.begin()) &&
         std::equal(impulses.begin(), impulses.begin() + count, other.impulses.begin());
}

void WorldModel::finalize() {
  SNUG_CHECK(laws.size() == static_cast<std::size_t>(material_count * material_count), "contact law table incomplete");
  geoms.clear();
  first_geom.assign(1, 0);
  masses.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].kind != BodyKind::Dynamic) bodies[i].inertia.com.setZero();
    masses.push_back(mass_properties_of(bodies[i]));
    for (std::size_t g = 0; g < bodies[i].geoms.size(); ++g) {
      geoms.push_back({static_cast<int>(i), static_cast<int>(g)});
    }
    first_geom.push_back(static_cast<int>(geoms.size()));
  }
  const std::size_t all = geoms.size() * geoms.size() / 2 + 1;
  pair_capacity = std::min(all, geoms.size() * 48 + 64);
}

WorldState make_state(const WorldModel& model) {
  WorldState state;
  state.bodies.resize(model.bodies.size());
  state.fat_boxes.resize(model.geoms.size());
  state.pairs = BoundedVector<PairState>(model.pair_capacity);
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const BodyModel& body = model.bodies[i];
    state.bodies[i].quat_WB = Quaternion(body.X_WB.R).normalized();
    state.bodies[i].p_WBcm = body.X_WB * body.inertia.com;
  }
  return state;
}

Workspace::Workspace(const WorldModel& model, int threads)
    : scratch_(std::make_unique<internal::Scratch>(model, threads)) {}
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

std::span<const ContactReport> Workspace::contacts() const {
  if (!scratch_->has_reports) internal::report_contacts(*scratch_);
  return {scratch_->reports.begin(), scratch_->reports.size()};
}

namespace {

/// A box touches about ten others with four points each; small worlds get space for every pair.
std::size_t contact_capacity_of(const WorldModel& model) {
  return std::min<std::size_t>(8 * model.pair_capacity, 4096 + 96 * model.geoms.size());
}

}  // namespace

internal::Scratch::Scratch(const WorldModel& model, int threads) : pool(threads) {
  const std::size_t n = model.bodies.size();
  const std::size_t geom_count = model.geoms.size();
  const std::size_t contact_capacity = contact_capacity_of(model);
  static std::atomic<std::uint64_t> scratches{0};
  stamp = (++scratches) << 40;
  memories.resize(n);
  pair_memories = BoundedVector<PairMemory>(model.pair_capacity);
  if (pool.size() > 1) visits = BoundedVector<PairVisit>(model.pair_capacity);
  bodies.resize(n);
  ends.resize(n);
  active.resize(n);
  carriers.reserve(n);
  whitening.resize(n);
  dense_whitening = BoundedVector<Matrix6>(n);
  last_torque.resize(n);
  centres.resize(n);
  u.resize(6 * n + 2);
  shift.resize(6 * n + 2);
  parent.resize(n);
  island_of_root.resize(n);
  contacts = BoundedVector<Contact>(contact_capacity);
  patches = BoundedVector<Patch>(std::min(model.pair_capacity, contact_capacity));
  patch_order = BoundedVector<int>(patches.capacity());
  shared_supports = SharedSupports(n, patches.capacity(), contact_capacity);
  lost_impulses.all = BoundedVector<LostImpulse>(contact_capacity);
  const bool resists =
      std::any_of(model.laws.begin(), model.laws.end(), [](const auto& l) { return l.resists_turning(); });
  const std::size_t row_capacity = contact_capacity + (resists ? kMaxTurningRows * patches.capacity() : 0);
  if (std::any_of(model.laws.begin(), model.laws.end(), [](const auto& l) { return l.bearing != Bearing::Corners; }))
    friction_points.resize(contact_capacity);
  rows = BoundedVector<Row>(row_capacity);
  reports = BoundedVector<ContactReport>(contact_capacity);
  islands.resize(n + 1);
  island_order.resize(n + 1);
  workers.reserve(static_cast<std::size_t>(pool.size()));
  for (int i = 0; i < pool.size(); ++i) {
    NewtonScratch newton(n, row_capacity);
    newton.group.centres = centres.data();
    PositionCorrection positions(n, row_capacity, newton.open_group.room());
    workers.push_back({std::move(newton), std::move(positions), {}, {}});
    workers.back().element_bodies.reserve(n);
  }
  solver_threads.pool = &pool;
  for (IslandWorker& worker : workers) solver_threads.scratches.push_back(&worker.newton);
  keys.reserve(2 * model.pair_capacity + 1);
  old_keys.reserve(model.pair_capacity);
  new_keys.reserve(model.pair_capacity + 1);
  pair_origin = BoundedVector<int>(model.pair_capacity);
  moved.reserve(geom_count);
  is_moved.resize(geom_count);
  sweep_order.resize(geom_count);
  for (std::size_t i = 0; i < geom_count; ++i) sweep_order[i] = static_cast<int>(i);
  pair_done = BoundedVector<char>(model.pair_capacity);
  is_moving.resize(n);
  still_since.resize(n);
  for (const BodyModel& body : model.bodies) {
    for (const Geom& geom : body.geoms) has_belts |= !geom.surface_velocity.isZero(0.0);
  }
}

Pose pose_of(const WorldModel& model, const WorldState& state, BodyId body) {
  const BodyState& b = state.bodies[static_cast<std::size_t>(body.index)];
  const Matrix3 R_WB = b.quat_WB.toRotationMatrix();
  return {R_WB, b.p_WBcm - R_WB * model.bodies[static_cast<std::size_t>(body.index)].inertia.com};
}

Twist twist_of(const WorldModel& model, const WorldState& state, BodyId body) {
  const BodyState& b = state.bodies[static_cast<std::size_t>(body.index)];
  const Vector3 p_BoBcm_W = b.quat_WB * model.bodies[static_cast<std::size_t>(body.index)].inertia.com;
  return {b.velocity - b.angular_velocity.cross(p_BoBcm_W), b.angular_velocity};
}

namespace {

/// Group -1: all.
void wake_sleepers(WorldState& state, int group) {
  for (BodyState& other : state.bodies) {
    if (other.sleep_group < 0 || (group >= 0 && other.sleep_group != group)) continue;
    other.sleep_group = -1;
    other.slow_time = 0.0;
  }
}

}  // namespace

void wake(WorldState& state, BodyId body) {
  const int group = state.bodies[static_cast<std::size_t>(body.index)].sleep_group;
  if (group >= 0) wake_sleepers(state, group);
}

void set_pose(const WorldModel& model, WorldState& state, BodyId body, const Pose& X_WB) {
  wake_sleepers(state, state.bodies[static_cast<std::size_t>(body.index)].sleep_group);
  BodyState& b = state.bodies[static_cast<std::size_t>(body.index)];
  b.quat_WB = Quaternion(X_WB.R).normalized();
  b.p_WBcm = X_WB * model.bodies[static_cast<std::size_t>(body.index)].inertia.com;
  b.slow_time = 0.0;
  for (int g = model.first_geom[static_cast<std::size_t>(body.index)];
       g < model.first_geom[static_cast<std::size_t>(body.index) + 1]; ++g) {
    state.fat_boxes[static_cast<std::size_t>(g)] = FatBox();  // found anew in the next step
  }
}

void set_twist(const WorldModel& model, WorldState& state, BodyId body, const Twist& V_WB) {
  wake(state, body);
  BodyState& b = state.bodies[static_cast<std::size_t>(body.index)];
  const Vector3 p_BoBcm_W = b.quat_WB * model.bodies[static_cast<std::size_t>(body.index)].inertia.com;
  b.velocity = V_WB.linear + V_WB.angular.cross(p_BoBcm_W);
  b.angular_velocity = V_WB.angular;
  b.slow_time = 0.0;
}

void set_present(WorldState& state, BodyId body, bool is_present) {
  if (is_present) {
    wake(state, body);
  } else {
    wake_sleepers(state, state.bodies[static_cast<std::size_t>(body.index)].sleep_group);
  }
  state.bodies[static_cast<std::size_t>(body.index)].is_present = is_present;
}

void set_lost(WorldState& state, BodyId body) { state.bodies[static_cast<std::size_t>(body.index)].is_present = false; }

std::vector<ContactReport> bearing_contacts(const WorldModel& model, const WorldState& state) {
  std::vector<ContactReport> reports;
  for (const PairState& pair : state.pairs) {
    const WorldModel::GeomRef& geom_a = model.geoms[pair.geom_a];
    const WorldModel::GeomRef& geom_b = model.geoms[pair.geom_b];
    const BodyId a{geom_a.body}, b{geom_b.body};
    if (!state.bodies[static_cast<std::size_t>(a.index)].is_present) continue;
    if (!state.bodies[static_cast<std::size_t>(b.index)].is_present) continue;
    const Pose X_WA = pose_of(model, state, a), X_WB = pose_of(model, state, b);
    const auto material_of = [&model](const WorldModel::GeomRef& ref) {
      return model.bodies[static_cast<std::size_t>(ref.body)].geoms[static_cast<std::size_t>(ref.geom)].material;
    };
    const double mu = model.law(material_of(geom_a), material_of(geom_b)).friction;
    const Vector3 n = X_WA.R * pair.n_A, t1 = X_WA.R * pair.t_A, t2 = n.cross(t1);
    for (int i = 0; i < pair.count; ++i) {
      const auto& impulse = pair.impulses[static_cast<std::size_t>(i)];
      if (!(impulse[0] > 0.0)) continue;
      const PairPoint& point = pair.points[static_cast<std::size_t>(i)];
      const Vector3 p_WA = X_WA * point.p_A, p_WB = X_WB * point.p_B;
      const Vector3 force = (impulse[0] * n + impulse[1] * t1 + impulse[2] * t2) / model.settings.dt;
      const bool slides = internal::is_at_friction_limit(mu, impulse[0], impulse[1], impulse[2]);
      reports.push_back({a, b, 0.5 * (p_WA + p_WB), n, force, n.dot(p_WB - p_WA), slides});
    }
  }
  return reports;
}

double kinetic_energy(const WorldModel& model, const WorldState& state) {
  double energy = 0.0;
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const BodyState& body = state.bodies[i];
    if (model.bodies[i].kind != BodyKind::Dynamic || !body.is_present) continue;
    const Vector3 w = model.masses[i].R_BI.transpose() * (body.quat_WB.conjugate() * body.angular_velocity);
    energy += 0.5 * body.velocity.squaredNorm() / model.masses[i].inverse_mass +
              0.5 * w.cwiseAbs2().cwiseQuotient(model.masses[i].inverse_inertia).sum();
  }
  return energy;
}

double potential_energy(const WorldModel& model, const WorldState& state) {
  double energy = 0.0;
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    if (model.bodies[i].kind != BodyKind::Dynamic || !state.bodies[i].is_present) continue;
    energy -= model.bodies[i].inertia.mass * model.gravity.dot(state.bodies[i].p_WBcm);
  }
  return energy;
}

std::uint64_t hash_of(const WorldState& state) {
  Hash hash;
  const auto add = [&hash](const Vector3& v) { hash.add(v.x()), hash.add(v.y()), hash.add(v.z()); };
  hash.add(static_cast<std::uint64_t>(state.step_index));
  for (const BodyState& body : state.bodies) {
    add(body.p_WBcm);
    for (int i = 0; i < 4; ++i) hash.add(body.quat_WB.coeffs()[i]);
    add(body.velocity);
    add(body.angular_velocity);
    hash.add(body.slow_time);
    hash.add(static_cast<std::uint64_t>(body.sleep_group + 1));
    hash.add(static_cast<std::uint64_t>(body.is_present));
  }
  for (const FatBox& box : state.fat_boxes) add(box.lower), add(box.upper);
  for (const PairState& pair : state.pairs) {
    hash.add((static_cast<std::uint64_t>(pair.geom_a) << 32) | pair.geom_b);
    hash.add((static_cast<std::uint64_t>(pair.count) << 33) | (static_cast<std::uint64_t>(pair.is_known) << 32) |
             pair.cache.features);
    add(pair.p_AB);
    hash.add(pair.margin);  // face_area and is_corner_pair follow from p_AB, quat_AB and this
    add(pair.n_A), add(pair.t_A);
    for (int i = 0; i < 4; ++i) hash.add(pair.quat_AB.coeffs()[i]);
    for (int i = 0; i < pair.count; ++i) {
      const PairPoint& point = pair.points[static_cast<std::size_t>(i)];
      add(point.p_A), add(point.p_B);
      for (const double part : pair.impulses[static_cast<std::size_t>(i)]) hash.add(part);
      hash.add(static_cast<std::uint64_t>(point.feature));
    }
    if (pair.turning == PairTurning{}) continue;
    hash.add(pair.turning.pressed);
    add(pair.turning.moment);
  }
  return hash.value();
}

}  // namespace snug::physics
