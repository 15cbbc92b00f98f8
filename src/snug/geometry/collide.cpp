// collide: brings a pair into its own order and sends it to the algorithm for its kinds.
#include <algorithm>

#include "snug/geometry/internal/box_box.hpp"
#include "snug/geometry/internal/capsule_capsule.hpp"
#include "snug/geometry/internal/cylinder_pair.hpp"
#include "snug/geometry/internal/polytope_pair.hpp"
#include "snug/geometry/manifold.hpp"

namespace snug::geometry {

namespace {

using internal::Axis;
using internal::PairCall;
using internal::Polytope;
using internal::PolytopeStorage;

/// Boxes, then hulls, capsules, cylinders: the general algorithm wants the capsule second, that of cylinders theirs.
int rank(const Shape& shape) noexcept {
  if (std::holds_alternative<Box>(shape)) return 0;
  if (std::holds_alternative<ConvexHull>(shape)) return 1;
  return std::holds_alternative<Capsule>(shape) ? 2 : 3;
}

/// -1, 0, 1 by the first number in which the two differ.
int compare(const double* a, const double* b, int count) noexcept {
  for (int i = 0; i < count; ++i) {
    if (a[i] < b[i]) return -1;
    if (a[i] > b[i]) return 1;
  }
  return 0;
}

int compare_shapes(const Shape& A, const Shape& B) noexcept {
  if (const Box* box = std::get_if<Box>(&A)) {
    // The larger first: of two faces that tie the first is cut with, and a larger one needs fewer cuts.
    return compare(std::get_if<Box>(&B)->half.data(), box->half.data(), 3);
  }
  if (const Capsule* a = std::get_if<Capsule>(&A)) {
    const Capsule* b = std::get_if<Capsule>(&B);
    if (a->radius != b->radius) return a->radius < b->radius ? -1 : 1;
    return compare(&a->half_length, &b->half_length, 1);
  }
  if (const Cylinder* a = std::get_if<Cylinder>(&A)) {
    const Cylinder* b = std::get_if<Cylinder>(&B);
    if (a->radius != b->radius) return a->radius < b->radius ? -1 : 1;
    return compare(&a->half_length, &b->half_length, 1);
  }
  const ConvexHull& a = *std::get_if<ConvexHull>(&A);
  const ConvexHull& b = *std::get_if<ConvexHull>(&B);
  if (a.vertices.size() != b.vertices.size()) return a.vertices.size() < b.vertices.size() ? -1 : 1;
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    if (const int order = compare(a.vertices[v].data(), b.vertices[v].data(), 3); order != 0) return order;
  }
  return 0;
}

/// Whether B goes first. Decides only ties; it makes both argument orders give the same bytes.
bool is_swapped(const Shape& A, const Pose& X_WA, const Shape& B, const Pose& X_WB) noexcept {
  const int rank_A = rank(A);
  const int rank_B = rank(B);
  if (rank_A != rank_B) return rank_A > rank_B;
  int order = compare_shapes(A, B);
  if (order == 0) order = compare(X_WA.p.data(), X_WB.p.data(), 3);
  if (order == 0) order = compare(X_WA.R.data(), X_WB.R.data(), 9);
  return order > 0;
}

Polytope view(const Shape& shape, const Pose& X, PolytopeStorage& room) noexcept {
  if (const Box* box = std::get_if<Box>(&shape)) return Polytope(*box, X, room);
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) return Polytope(*capsule, X, room);
  return Polytope(*std::get_if<ConvexHull>(&shape), X, room);
}

/// Pose of B in A.
Pose relative_pose(const PairCall& call) noexcept {
  const Matrix3 R_AW = call.X_WA.R.transpose();
  return {R_AW * call.X_WB.R, R_AW * (call.X_WB.p - call.X_WA.p)};
}

/// B is a cylinder; A is any shape.
void collide_cylinder(const Shape& A, const Cylinder& B, const PairCall& call, Axis& axis, Manifold& out) noexcept {
  const Pose X_AB = relative_pose(call);
  if (const Cylinder* cylinder = std::get_if<Cylinder>(&A)) {
    internal::collide_cylinders(*cylinder, B, X_AB, call, out);
    return;
  }
  PolytopeStorage room;
  const Polytope shape_A = view(A, Pose{}, room);
  const Capsule* capsule = std::get_if<Capsule>(&A);
  internal::collide_polytope_cylinder(shape_A, capsule != nullptr ? capsule->radius : 0.0, B, X_AB, call, axis, out);
}

void collide_general(const Shape& A, const Shape& B, const PairCall& call, Axis& axis, Manifold& out) noexcept {
  PolytopeStorage room_A;
  PolytopeStorage room_B;
  const Polytope shape_A = view(A, Pose{}, room_A);
  const Polytope shape_B = view(B, relative_pose(call), room_B);
  const Capsule* capsule = std::get_if<Capsule>(&B);
  internal::collide_polytopes({shape_A, shape_B, capsule != nullptr ? capsule->radius : 0.0}, call, axis, out);
}

}  // namespace

void collide(const Shape& A, const Pose& X_WA, const Shape& B, const Pose& X_WB, double margin, PairCache& cache,
             Manifold& out) noexcept {
  out.count = 0;
  out.face_area = std::numeric_limits<double>::infinity();
  out.is_corner_pair = false;
  const bool swapped = is_swapped(A, X_WA, B, X_WB);
  const Shape& first = swapped ? B : A;
  const Shape& second = swapped ? A : B;
  const PairCall call{swapped ? X_WB : X_WA, swapped ? X_WA : X_WB, margin, swapped};
  Axis axis = internal::decode(cache);
  if (swapped) axis = flipped(axis);
  const Box* box_A = std::get_if<Box>(&first);
  const Box* box_B = std::get_if<Box>(&second);
  if (box_A != nullptr && box_B != nullptr) {
    internal::collide_boxes(*box_A, *box_B, call, axis, out);
  } else if (const Cylinder* cylinder = std::get_if<Cylinder>(&second)) {
    collide_cylinder(first, *cylinder, call, axis, out);
  } else if (rank(first) == 2) {
    internal::collide_capsules(*std::get_if<Capsule>(&first), *std::get_if<Capsule>(&second), call, out);
  } else {
    collide_general(first, second, call, axis, out);
  }
  cache = internal::encode(swapped ? flipped(axis) : axis);
}

}  // namespace snug::geometry
