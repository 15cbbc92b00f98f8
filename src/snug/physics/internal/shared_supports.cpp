// Shared supports: a face that lies on several fixed geoms in one plane bears on the rim of them all, as on one slab.
#include <algorithm>
#include <cmath>

#include "snug/physics/internal/face_loads.hpp"
#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

constexpr double kParallel = 1e-9;  ///< 1 - cosine between normals of one plane: 45 urad
constexpr double kLeans = 5e-7;     ///< 1 - cosine between a face and the support that it lies on: 1 mrad
constexpr double kFlush = 1e-6;     ///< m, between supports of one plane, and between points of one face
constexpr double kOnRim = 1e-7;     ///< m, a point as near to the rim, or inside, bears nothing

/// Whether the patch may share what it bears with others: rigid, between a moving body and one that stands still. Where
/// edges have a friction of their own, it counts how many points a patch has.
bool may_share(const WorldModel& model, const Scratch& work, const Patch& patch) {
  const BodyWork& a = work.bodies[static_cast<std::size_t>(patch.body_a)];
  const BodyWork& b = work.bodies[static_cast<std::size_t>(patch.body_b)];
  if ((a.active >= 0) == (b.active >= 0) || a.is_moving == b.is_moving || patch.is_swept) return false;
  const int fixed = a.active >= 0 ? patch.body_b : patch.body_a;
  const ContactLaw& law = model.laws[patch.law];
  return model.bodies[static_cast<std::size_t>(fixed)].kind != BodyKind::Dynamic && law.stiffness <= 0.0 &&
         !law.edge_friction;
}

/// A patch seen from the moving body.
struct View {
  bool is_b = false;  ///< the moving body is B of the pair
  int moving = 0, fixed = 0;
  Vector3 n_W;  ///< from the support to the body
};

View view_of(const Scratch& work, const Patch& patch) {
  const bool is_b = work.bodies[static_cast<std::size_t>(patch.body_b)].active >= 0;
  return {is_b, is_b ? patch.body_b : patch.body_a, is_b ? patch.body_a : patch.body_b,
          is_b ? patch.n : Vector3(-patch.n)};
}

/// The normal of the support's own face, W. That of the patch may be the normal of the body's face instead, which leans
/// against the support where two of its corners stand off by some micrometres.
Vector3 support_normal(const WorldModel& model, const WorldState& state, const Scratch& work, const Patch& patch) {
  const View view = view_of(work, patch);
  const PairState& pair = state.pairs[patch.pair];
  const WorldModel::GeomRef& ref = model.geoms[view.is_b ? pair.geom_a : pair.geom_b];
  const Geom& geom = model.bodies[static_cast<std::size_t>(ref.body)].geoms[static_cast<std::size_t>(ref.geom)];
  if (!std::holds_alternative<geometry::Box>(geom.shape)) return view.n_W;
  const Matrix3 axes = work.bodies[static_cast<std::size_t>(view.fixed)].R_WB * geom.X_BG.R;
  for (int i = 0; i < 3; ++i) {
    const double along = axes.col(i).dot(view.n_W);
    if (1.0 - std::abs(along) <= kLeans) return std::copysign(1.0, along) * axes.col(i);
  }
  return view.n_W;
}

/// Where the plane of a support lies along the normal, m.
double height_of(const WorldState& state, const Scratch& work, const Patch& patch, const Vector3& n_W) {
  const View view = view_of(work, patch);
  const BodyWork& fixed = work.bodies[static_cast<std::size_t>(view.fixed)];
  const Contact& contact = work.contacts[static_cast<std::size_t>(patch.first_contact)];
  const PairPoint& point = state.pairs[patch.pair].points[static_cast<std::size_t>(contact.point)];
  return n_W.dot(fixed.p_WB + fixed.R_WB * (view.is_b ? point.p_A : point.p_B));
}

double distance(const SupportPoint& p, const SupportPoint& q) { return std::hypot(p.x - q.x, p.y - q.y); }

/// Distance of r to the left of the line from p to q, m.
double left_of(const SupportPoint& p, const SupportPoint& q, const SupportPoint& r) {
  return ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x)) / distance(p, q);
}

/// Whether all points are of one plane, which gaps then are linear over: height = h0 + g . (x, y).
bool is_flat(const std::vector<SupportPoint>& points) {
  // The plane of least squares, about the mean.
  Vector3 mean = Vector3::Zero();
  for (const SupportPoint& p : points) mean += Vector3(p.x, p.y, p.height) / static_cast<double>(points.size());
  double xx = 0.0, xy = 0.0, yy = 0.0, xh = 0.0, yh = 0.0;
  for (const SupportPoint& p : points) {
    const double x = p.x - mean.x(), y = p.y - mean.y(), h = p.height - mean.z();
    xx += x * x, xy += x * y, yy += y * y, xh += x * h, yh += y * h;
  }
  const double ridge = 1e-12 * (xx + yy);  // points on a line: any plane through it
  const double det = (xx + ridge) * (yy + ridge) - xy * xy;
  if (!(det > 0.0)) return false;
  const double gx = ((yy + ridge) * xh - xy * yh) / det, gy = ((xx + ridge) * yh - xy * xh) / det;
  return std::all_of(points.begin(), points.end(), [&](const SupportPoint& p) {
    return std::abs(p.height - mean.z() - gx * (p.x - mean.x()) - gy * (p.y - mean.y())) <= kFlush;
  });
}

/// The next corner of the convex hull behind `from`, counter-clockwise: no point lies to the right of the line there,
/// none on it farther away. -1: all points are where `from` is.
int next_corner(const std::vector<SupportPoint>& points, const SupportPoint& from) {
  int next = -1;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double reach = distance(from, points[i]);
    if (reach <= kOnRim) continue;
    const auto index = static_cast<int>(i);
    if (next < 0) {
      next = index;
      continue;
    }
    const SupportPoint& known = points[static_cast<std::size_t>(next)];
    const double left = left_of(from, known, points[i]);
    const double farther = reach - distance(from, known);
    const bool is_beyond = std::abs(left) <= kOnRim && farther > kOnRim;
    const bool is_same = distance(known, points[i]) <= kOnRim && points[i].rank < known.rank;
    if (left < -kOnRim || is_beyond || is_same) next = index;
  }
  return next;
}

/// Corners of the convex hull stay; all others are covered. Of points in one place that of the least rank stays.
void cover_inner_points(std::vector<SupportPoint>& points, Scratch& work) {
  double x = 0.0, y = 0.0;
  for (SupportPoint& p : points) {
    x += p.x / static_cast<double>(points.size()), y += p.y / static_cast<double>(points.size());
    work.contacts[static_cast<std::size_t>(p.contact)].is_covered = true;
  }
  const auto before = [&](const SupportPoint& p, const SupportPoint& q) {  // the farthest from the mean is a corner
    const double far_p = std::hypot(p.x - x, p.y - y), far_q = std::hypot(q.x - x, q.y - y);
    return std::abs(far_p - far_q) > kOnRim ? far_p > far_q : p.rank < q.rank;
  };
  const auto first = std::min_element(points.begin(), points.end(), before);
  int corner = static_cast<int>(first - points.begin());
  for (std::size_t count = 0; corner >= 0 && count < points.size(); ++count) {
    const SupportPoint& at = points[static_cast<std::size_t>(corner)];
    work.contacts[static_cast<std::size_t>(at.contact)].is_covered = false;
    corner = next_corner(points, at);
    if (corner >= 0 && distance(points[static_cast<std::size_t>(corner)], *first) <= kOnRim) break;
  }
}

/// Columns n, t1, t2 of a patch, for the impulse on the moving body.
Matrix3 axes_of(const Patch& patch, bool is_b) {
  Matrix3 axes;
  axes << patch.n, patch.t1, patch.t2;
  return is_b ? axes : Matrix3(-axes);
}

/// The nearest point that bears, if any does.
const SupportPoint* find_nearest_bearing(const std::vector<SupportPoint>& points, const SupportPoint& from,
                                         const Scratch& work) {
  const SupportPoint* nearest = nullptr;
  for (const SupportPoint& to : points) {
    if (work.contacts[static_cast<std::size_t>(to.contact)].is_covered) continue;
    if (nearest == nullptr || distance(from, to) < distance(from, *nearest)) nearest = &to;
  }
  return nearest;
}

/// An impulse on the moving body, W, is added to what the contact starts from.
void add_impulse(const Vector3& impulse, const SupportPoint& to, WorldState& state, Scratch& work) {
  const Contact& contact = work.contacts[static_cast<std::size_t>(to.contact)];
  Patch& patch = work.patches[static_cast<std::size_t>(contact.patch)];
  Eigen::Map<Vector3> taken(state.pairs[patch.pair].impulses[static_cast<std::size_t>(contact.point)].data());
  taken += axes_of(patch, view_of(work, patch).is_b).transpose() * impulse;
  patch.is_kept = false;  // its rows begin from the state
}

/// A covered contact that bore in the step before, as a corner that has slid to the next support, gives its impulse to
/// the nearest that bears: the search for the impulses starts where it ended.
void hand_on_impulses(const std::vector<SupportPoint>& points, WorldState& state, Scratch& work) {
  for (const SupportPoint& from : points) {
    const Contact& covered = work.contacts[static_cast<std::size_t>(from.contact)];
    if (!covered.is_covered) continue;
    Patch& patch = work.patches[static_cast<std::size_t>(covered.patch)];
    auto& impulse = state.pairs[patch.pair].impulses[static_cast<std::size_t>(covered.point)];
    if (impulse[0] == 0.0) continue;
    Eigen::Map<Vector3> given(impulse.data());
    const Vector3 on_moving = axes_of(patch, view_of(work, patch).is_b) * given;
    add_impulse(on_moving, *find_nearest_bearing(points, from, work), state, work);
    given.setZero();
    patch.is_kept = false;
  }
}

/// Axes along a plane and from it, in the frame of the moving body: one frame for all of its patches.
struct PlaneAxes {
  Vector3 ex, ey, n;
};

PlaneAxes axes_of_plane(const Scratch& work, const View& view) {
  const Vector3 n = work.bodies[static_cast<std::size_t>(view.moving)].R_WB.transpose() * view.n_W;
  int smallest = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(n[i]) < std::abs(n[smallest])) smallest = i;
  const Vector3 ex = n.cross(Vector3::Unit(smallest)).normalized();
  return {ex, n.cross(ex), n};
}

/// Points of the patches of one plane.
void add_points(const WorldState& state, const Scratch& work, const Patch& patch, const PlaneAxes& axes, int rank,
                std::vector<SupportPoint>& points) {
  const bool is_b = view_of(work, patch).is_b;
  for (int i = patch.first_contact; i < patch.first_contact + patch.contact_count; ++i) {
    const PairPoint& point =
        state.pairs[patch.pair].points[static_cast<std::size_t>(work.contacts[static_cast<std::size_t>(i)].point)];
    const Vector3& p = is_b ? point.p_B : point.p_A;
    points.push_back({axes.ex.dot(p), axes.ey.dot(p), axes.n.dot(p), i, rank});
  }
}

/// The same for what a corner bore on a support that it has left in this step. `only`: the pair of the last support,
/// which keeps what it lost itself to itself, or -1.
void hand_on_lost(const std::vector<SupportPoint>& points, const View& view, const PlaneAxes& axes, std::int64_t only,
                  WorldState& state, Scratch& work) {
  constexpr double kSamePlane = 1e-5;  // m
  for (const LostImpulse& lost : work.lost_impulses.all) {
    if (lost.moving != view.moving || lost.pair == only || 1.0 - view.n_W.dot(lost.n_W) > 4.0 * kLeans) continue;
    const SupportPoint from{axes.ex.dot(lost.p), axes.ey.dot(lost.p), axes.n.dot(lost.p), -1, -1};
    if (std::abs(from.height - points.front().height) > kSamePlane) continue;
    add_impulse(lost.impulse, *find_nearest_bearing(points, from, work), state, work);
  }
}

/// A body that has come to lie on one support alone.
void take_lost(const Patch& patch, SharedSupports& shared, WorldState& state, Scratch& work) {
  if (work.lost_impulses.all.empty()) return;
  const View view = view_of(work, patch);
  const PlaneAxes axes = axes_of_plane(work, view);
  shared.points.clear();
  add_points(state, work, patch, axes, 0, shared.points);
  hand_on_lost(shared.points, view, axes, patch.pair, state, work);
}

/// The order of supports in space, which does not depend on the order of the file.
bool comes_before(const Scratch& work, int body, int other) {
  const Vector3& p = work.bodies[static_cast<std::size_t>(body)].p_WB;
  const Vector3& q = work.bodies[static_cast<std::size_t>(other)].p_WB;
  return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
}

/// Whether all surfaces of a plane run with the same velocity under the moving body, under one law.
bool run_alike(const WorldModel& model, const Scratch& work, const std::vector<int>& plane) {
  const Patch& first = work.patches[static_cast<std::size_t>(plane.front())];
  const auto belt_of = [&work](const Patch& p) { return view_of(work, p).is_b ? p.belt_W : Vector3(-p.belt_W); };
  return std::all_of(plane.begin(), plane.end(), [&](int index) {
    const Patch& patch = work.patches[static_cast<std::size_t>(index)];
    return model.laws[patch.law] == model.laws[first.law] && (belt_of(patch) - belt_of(first)).isZero(1e-12);
  });
}

/// Of laws that bear on edges or faces, on surfaces that do not run alike: every point bears, each support in
/// proportion to what lies on it.
void even_plane(const WorldModel& model, SharedSupports& shared, WorldState& state, Scratch& work) {
  shared.loads.clear();
  std::size_t first = 0;
  for (const int index : shared.plane) {
    const auto count = static_cast<std::size_t>(work.patches[static_cast<std::size_t>(index)].contact_count);
    for (std::size_t i = first; i < first + count; ++i) {
      const Contact& contact = work.contacts[static_cast<std::size_t>(shared.points[i].contact)];
      const Patch& patch = work.patches[static_cast<std::size_t>(index)];
      const double load = state.pairs[patch.pair].impulses[static_cast<std::size_t>(contact.point)][0];
      shared.loads.push_back({shared.points[i].x, shared.points[i].y, load, 0.0, bears(model, contact, load)});
    }
    weigh_by_area({shared.loads.data() + first, count});
    first += count;
  }
  if (!even_loads(shared.loads)) return;
  for (std::size_t i = 0; i < shared.loads.size(); ++i) {
    const Contact& contact = work.contacts[static_cast<std::size_t>(shared.points[i].contact)];
    Patch& patch = work.patches[static_cast<std::size_t>(contact.patch)];
    double& load = state.pairs[patch.pair].impulses[static_cast<std::size_t>(contact.point)][0];
    if (load == shared.loads[i].load) continue;
    load = shared.loads[i].load;
    patch.is_kept = false;
  }
}

/// Normal and tangents of a patch, and what depends on them. Its rows no longer stand as in the step before.
void set_axes(const Vector3& n, const Vector3& t1, Patch& patch, Scratch& work) {
  patch.n = n, patch.t1 = t1, patch.t2 = n.cross(t1);
  patch.is_kept = false;
  const BodyWork& a = work.bodies[static_cast<std::size_t>(patch.body_a)];
  const BodyWork& b = work.bodies[static_cast<std::size_t>(patch.body_b)];
  for (int i = patch.first_contact; i < patch.first_contact + patch.contact_count; ++i) {
    Contact& contact = work.contacts[static_cast<std::size_t>(i)];
    contact.approach = n.dot((b.velocity_start + b.angular_start.cross(contact.p_WQ - b.p_WBcm)) -
                             (a.velocity_start + a.angular_start.cross(contact.p_WQ - a.p_WBcm)));
  }
}

/// The axes of the pair, should the patch of the step before have had those of a plane.
void restore_axes(const WorldState& state, Patch& patch, Scratch& work) {
  const PairState& pair = state.pairs[patch.pair];
  const Matrix3& R_WA = work.bodies[static_cast<std::size_t>(patch.body_a)].R_WB;
  const Vector3 n = R_WA * pair.n_A;
  if (patch.n != n) set_axes(n, R_WA * pair.t_A, patch, work);
}

/// One normal for all patches of a plane: with several, no velocity of a face that slides keeps more than three of its
/// corners in touch, and these bear all.
void align_axes(const SharedSupports& shared, const Vector3& n_W, Scratch& work) {
  for (const int index : shared.plane) {
    Patch& patch = work.patches[static_cast<std::size_t>(index)];
    const Vector3 n = view_of(work, patch).is_b ? n_W : Vector3(-n_W);
    if (patch.n != n) set_axes(n, (patch.t1 - n.dot(patch.t1) * n).normalized(), patch, work);
  }
}

/// Geom of the moving body.
std::uint32_t moving_geom(const WorldState& state, const Scratch& work, const Patch& patch) {
  const PairState& pair = state.pairs[patch.pair];
  return view_of(work, patch).is_b ? pair.geom_b : pair.geom_a;
}

/// What bears, counter-clockwise about its mean in the axes of the geom, as the corners of a box on one slab lie.
void order_corners(const WorldModel& model, const WorldState& state, SharedSupports& shared, Scratch& work) {
  Patch& first = work.patches[static_cast<std::size_t>(*std::min_element(shared.plane.begin(), shared.plane.end()))];
  const std::uint32_t geom = moving_geom(state, work, first);
  for (const int index : shared.plane) {
    const Patch& patch = work.patches[static_cast<std::size_t>(index)];
    if (moving_geom(state, work, patch) != geom) return;
  }
  const WorldModel::GeomRef& ref = model.geoms[geom];
  const Matrix3& R_BG =
      model.bodies[static_cast<std::size_t>(ref.body)].geoms[static_cast<std::size_t>(ref.geom)].X_BG.R;
  const View view = view_of(work, first);
  const Matrix3 R_WG = work.bodies[static_cast<std::size_t>(view.moving)].R_WB * R_BG;
  int axis = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(R_WG.col(i).dot(view.n_W)) > std::abs(R_WG.col(axis).dot(view.n_W))) axis = i;
  const Vector3 ex = R_WG.col((axis + 1) % 3), ey = R_WG.col((axis + 2) % 3);
  const std::size_t begin = shared.order.size();
  Vector3 mean = Vector3::Zero();
  for (const SupportPoint& point : shared.points) {
    const Contact& contact = work.contacts[static_cast<std::size_t>(point.contact)];
    if (contact.is_covered) continue;
    shared.order.push_back(point.contact);
    mean += contact.p_WQ;
  }
  mean /= static_cast<double>(shared.order.size() - begin);
  const auto from = shared.order.begin() + static_cast<std::ptrdiff_t>(begin);
  std::sort(from, shared.order.end());
  shared.ascending.insert(shared.ascending.end(), from, shared.order.end());
  const auto angle_of = [&](int contact) {
    const Vector3 p = work.contacts[static_cast<std::size_t>(contact)].p_WQ - mean;
    return std::atan2(ey.dot(p), ex.dot(p));
  };
  std::sort(from, shared.order.end(), [&](int p, int q) {
    const double angle_p = angle_of(p), angle_q = angle_of(q);
    return angle_p != angle_q ? angle_p < angle_q : p < q;
  });
  first.plane = static_cast<int>(shared.orders.size());
  shared.orders.push_back({begin, shared.order.size()});
}

/// The supports of one body that lie in the plane of the first of the chain, taken off the chain.
void share_plane(const WorldModel& model, WorldState& state, Scratch& work, int& chain) {
  SharedSupports& shared = work.shared_supports;
  shared.points.clear();
  shared.plane.clear();
  const Patch& first = work.patches[static_cast<std::size_t>(chain)];
  if (shared.next[static_cast<std::size_t>(chain)] < 0) {  // the only support
    take_lost(first, shared, state, work);
    chain = -1;
    return;
  }
  const Vector3 n_W = support_normal(model, state, work, first);
  const double height = height_of(state, work, first, n_W);
  int* link = &chain;
  while (*link >= 0) {
    const int index = *link;
    const Patch& patch = work.patches[static_cast<std::size_t>(index)];
    const bool is_near = 1.0 - n_W.dot(view_of(work, patch).n_W) <= 4.0 * kLeans;  // else not worth a closer look
    if (!is_near || 1.0 - n_W.dot(support_normal(model, state, work, patch)) > kParallel ||
        std::abs(height_of(state, work, patch, n_W) - height) > kFlush) {
      link = &shared.next[static_cast<std::size_t>(index)];
      continue;
    }
    *link = shared.next[static_cast<std::size_t>(index)];
    shared.plane.push_back(index);
  }
  if (shared.plane.size() < 2) return take_lost(first, shared, state, work);
  const auto fixed_of = [&](int index) { return view_of(work, work.patches[static_cast<std::size_t>(index)]).fixed; };
  std::sort(shared.plane.begin(), shared.plane.end(), [&](int p, int q) {
    if (comes_before(work, fixed_of(p), fixed_of(q))) return true;
    return !comes_before(work, fixed_of(q), fixed_of(p)) && p < q;
  });
  const PlaneAxes axes =
      axes_of_plane(work, view_of(work, work.patches[static_cast<std::size_t>(shared.plane.front())]));
  for (std::size_t i = 0; i < shared.plane.size(); ++i) {
    const Patch& patch = work.patches[static_cast<std::size_t>(shared.plane[i])];
    add_points(state, work, patch, axes, static_cast<int>(i), shared.points);
  }
  if (!is_flat(shared.points)) return;
  align_axes(shared, n_W, work);
  const bool are_faces = std::all_of(shared.plane.begin(), shared.plane.end(), [&](int index) {
    return model.laws[work.patches[static_cast<std::size_t>(index)].law].bearing != Bearing::Corners;
  });
  if (are_faces && !run_alike(model, work, shared.plane)) {
    even_plane(model, shared, state, work);
    return;
  }
  cover_inner_points(shared.points, work);
  if (are_faces) {
    shared.contacts.clear();
    for (const SupportPoint& point : shared.points) shared.contacts.push_back(point.contact);
    if (bear_on_plane(model, shared.plane, shared.contacts, state, work)) return;
  }
  hand_on_impulses(shared.points, state, work);
  hand_on_lost(shared.points, view_of(work, first), axes, -1, state, work);
  order_corners(model, state, shared, work);
}

}  // namespace

void arrange_planes(const Island& island, bool is_as_one_slab, Scratch& work) {
  const SharedSupports& shared = work.shared_supports;
  if (shared.orders.empty()) return;
  const auto row_of = [&work](int contact) -> Row& {
    const Patch& patch = work.patches[static_cast<std::size_t>(work.contacts[static_cast<std::size_t>(contact)].patch)];
    return *(work.rows.begin() + patch.first_row + (contact - patch.first_contact));
  };
  for (int i = island.first_patch; i < island.end_patch; ++i) {
    const int plane = work.patches[static_cast<std::size_t>(work.patch_order[static_cast<std::size_t>(i)])].plane;
    if (plane < 0) continue;
    const PlaneOrder& of = shared.orders[static_cast<std::size_t>(plane)];
    const std::vector<int>& wanted = is_as_one_slab ? shared.order : shared.ascending;
    for (std::size_t k = of.first; k < of.end; ++k) {
      Row& place = row_of(shared.ascending[k]);
      for (std::size_t other = k; place.contact != wanted[k] && other < of.end; ++other) {
        Row& row = row_of(shared.ascending[other]);
        if (row.contact == wanted[k]) std::swap(place, row);
      }
    }
  }
}

SharedSupports::SharedSupports(std::size_t bodies, std::size_t patches, std::size_t contact_count)
    : first(bodies, -1), next(patches) {
  plane.reserve(patches);
  points.reserve(contact_count);
  loads.reserve(contact_count);
  contacts.reserve(contact_count);
  orders.reserve(patches);
  order.reserve(contact_count);
  ascending.reserve(contact_count);
  touched.reserve(bodies);
}

void mark_covered_contacts(const WorldModel& model, WorldState& state, Scratch& work) {
  SharedSupports& shared = work.shared_supports;
  shared.touched.clear();
  shared.next.resize(work.patches.size());
  shared.orders.clear();
  shared.order.clear();
  shared.ascending.clear();
  auto& lost = work.lost_impulses.all;
  std::sort(lost.begin(), lost.end(), [](const LostImpulse& p, const LostImpulse& q) {  // whichever thread was first
    return std::pair(p.pair, p.point) < std::pair(q.pair, q.point);
  });
  for (std::size_t i = 0; i < work.patches.size(); ++i) {
    Patch& patch = work.patches[i];
    patch.is_shared = false;
    patch.plane = -1;
    if (!may_share(model, work, patch)) continue;
    for (int k = patch.first_contact; k < patch.first_contact + patch.contact_count; ++k)
      work.contacts[static_cast<std::size_t>(k)].is_covered = false;
    if (patch.is_kept) restore_axes(state, patch, work);
    const int moving = view_of(work, patch).moving;
    int& first = shared.first[static_cast<std::size_t>(moving)];
    if (first < 0) shared.touched.push_back(moving);
    shared.next[i] = first;
    first = static_cast<int>(i);
  }
  for (const int body : shared.touched) {
    int& chain = shared.first[static_cast<std::size_t>(body)];
    while (chain >= 0) share_plane(model, state, work, chain);
  }
}

}  // namespace snug::physics::internal
