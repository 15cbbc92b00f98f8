// BoxClip: Sutherland-Hodgman in the plane of the reference face, with the height carried along.
#include <cmath>

#include "snug/geometry/internal/box_clip.hpp"
#include "snug/geometry/internal/box_topology.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

/// A corner and the label of the side that leaves it: 0-3 sides of the incident face, 4-7 of the reference face.
struct Corner {
  double u, v, phi;
  int label;
};

/// The incident face as a parallelogram c +- e1 +- e2 in (u, v), with height.
struct Parallelogram {
  int axis;       ///< of the incident box
  bool positive;  ///< which of its two faces
  double cu, cv, c_phi;
  double e1u, e1v, e1_phi;  ///< half side along the next axis
  double e2u, e2v, e2_phi;  ///< half side along the axis after that
};

// A polygon of 4 corners cut by 4 lines has at most 8; rounding may add a spurious corner at each cut.
using Corners = std::array<Corner, 16>;

Parallelogram project(const BoxFacePair& pair, int ax) noexcept {
  const int au = next(ax);
  const int av = next(au);
  const double sign = (pair.face & 1) != 0 ? 1.0 : -1.0;
  const Vector3 dots = pair.R_RI.transpose() * pair.n_R;
  Parallelogram result;
  result.axis = 0;
  if (std::abs(dots[1]) > std::abs(dots[0]) + kTie) result.axis = 1;
  if (std::abs(dots[2]) > std::abs(dots[result.axis]) + kTie) result.axis = 2;
  result.positive = dots[result.axis] < 0.0;
  const int k1 = next(result.axis);
  const int k2 = next(k1);
  const double inverse = 1.0 / (sign * pair.n_R[ax]);
  const double nu = pair.n_R[au];
  const double nv = pair.n_R[av];
  const double reach = (result.positive ? 1.0 : -1.0) * pair.half_inc[result.axis];
  const Vector3 c = pair.p_RI + reach * pair.R_RI.col(result.axis);
  const Vector3 e1 = pair.half_inc[k1] * pair.R_RI.col(k1);
  const Vector3 e2 = pair.half_inc[k2] * pair.R_RI.col(k2);
  result.c_phi = (sign * c[ax] - pair.half_ref[ax]) * inverse;
  result.e1_phi = sign * e1[ax] * inverse;
  result.e2_phi = sign * e2[ax] * inverse;
  result.cu = c[au] - result.c_phi * nu;
  result.cv = c[av] - result.c_phi * nv;
  result.e1u = e1[au] - result.e1_phi * nu;
  result.e1v = e1[av] - result.e1_phi * nv;
  result.e2u = e2[au] - result.e2_phi * nu;
  result.e2v = e2[av] - result.e2_phi * nv;
  return result;
}

/// Keeps what has sign * coordinate <= limit. `side` names the new edge.
template <double Corner::*Coordinate>
int cut(const Corners& in, int count, double sign, double limit, int side, Corners& out) noexcept {
  int kept = 0;
  if (count == 0) return 0;
  const Corner* from = &in[static_cast<std::size_t>(count - 1)];
  double d_from = sign * (from->*Coordinate) - limit;
  for (int i = 0; i < count; ++i) {
    const Corner* to = &in[static_cast<std::size_t>(i)];
    const double d_to = sign * (to->*Coordinate) - limit;
    if ((d_from <= 0.0) != (d_to <= 0.0) && kept < 15) {
      const double t = d_from / (d_from - d_to);
      Corner& corner = out[static_cast<std::size_t>(kept++)];
      corner.u = from->u + t * (to->u - from->u);
      corner.v = from->v + t * (to->v - from->v);
      corner.phi = from->phi + t * (to->phi - from->phi);
      corner.*Coordinate = sign * limit;
      corner.label = d_to > 0.0 ? side : from->label;
    }
    if (d_to <= 0.0) out[static_cast<std::size_t>(kept++)] = *to;
    from = to;
    d_from = d_to;
  }
  return kept;
}

/// Names corners of the polygon.
class Namer {
 public:
  Namer(const BoxFacePair& pair, const Parallelogram& inc, int ax, double hu, double hv)
      : pair_(pair), inc_(inc), ax_(ax), au_(next(ax)), hu_(hu), hv_(hv) {
    const double determinant = inc.e1u * inc.e2v - inc.e1v * inc.e2u;
    inverse_ = determinant != 0.0 ? 1.0 / determinant : 0.0;
  }

  /// Name of a corner between the sides `before` and `after`.
  void name(const Corner& corner, int before, int after, BoxClipPoint& point) {
    int ref = vertex_near_reference(corner);
    int inc = vertex_near_incident(corner);
    // A corner of both boxes at once takes its name from one of them, always the same.
    if (ref >= 0 && inc >= 0) (pair_.name_ref_first ? inc : ref) = -1;
    if (ref >= 0 && !used(ref)) return set_reference(ref, point);
    if (inc >= 0 && !used(8 + inc)) return set_incident(inc, point);
    name_by_sides(before, after, point);
    if (ref >= 0 || inc >= 0) point.code_inc |= kSecond;
  }

 private:
  bool used(int bit) {
    const bool was = (used_ >> bit & 1U) != 0;
    used_ |= 1U << bit;
    return was;
  }
  void set_reference(int vertex, BoxClipPoint& point) const {
    point.code_ref = vertex_code(vertex);
    point.code_inc = face_code(box_face(inc_.axis, inc_.positive));
  }
  void set_incident(int vertex, BoxClipPoint& point) const {
    point.code_ref = face_code(pair_.face);
    point.code_inc = vertex_code(vertex);
  }
  int reference_vertex(bool u_positive, bool v_positive) const {
    return box_vertex(ax_, (pair_.face & 1) != 0, u_positive, v_positive);
  }
  int incident_vertex(bool first_positive, bool second_positive) const {
    return box_vertex(inc_.axis, inc_.positive, first_positive, second_positive);
  }
  int vertex_near_reference(const Corner& c) const {
    if (std::abs(std::abs(c.u) - hu_) > kSnap || std::abs(std::abs(c.v) - hv_) > kSnap) return -1;
    return reference_vertex(c.u > 0.0, c.v > 0.0);
  }
  int vertex_near_incident(const Corner& c) const {
    const double du = c.u - inc_.cu;
    const double dv = c.v - inc_.cv;
    const double s = (du * inc_.e2v - dv * inc_.e2u) * inverse_;
    const double t = (inc_.e1u * dv - inc_.e1v * du) * inverse_;
    const double length1 = pair_.half_inc[next(inc_.axis)];
    const double length2 = pair_.half_inc[next(next(inc_.axis))];
    if (std::abs(std::abs(s) - 1.0) * length1 > kSnap || std::abs(std::abs(t) - 1.0) * length2 > kSnap) return -1;
    return incident_vertex(s > 0.0, t > 0.0);
  }
  int reference_edge(int side) const {
    const bool positive = (pair_.face & 1) != 0;
    // Side 4: u = +hu, 5: v = +hv, 6: u = -hu, 7: v = -hv.
    if (side == 4 || side == 6) return box_edge(next(au_), positive, side == 4);
    return box_edge(au_, side == 5, positive);
  }
  int incident_edge(int side) const {
    const int k1 = next(inc_.axis);
    // Sides 0 and 2 run along k1 (at the second axis negative, positive), 1 and 3 along k2.
    if (side == 0 || side == 2) return box_edge(k1, side == 2, inc_.positive);
    return box_edge(next(k1), inc_.positive, side == 1);
  }
  void name_by_sides(int before, int after, BoxClipPoint& point) const {
    if (before < 4 && after < 4) return set_incident(incident_vertex(after == 1 || after == 2, after >= 2), point);
    if (before >= 4 && after >= 4) {
      return set_reference(reference_vertex(before == 4 || after == 4, before == 5 || after == 5), point);
    }
    point.code_ref = edge_code(reference_edge(before < 4 ? after : before));
    point.code_inc = edge_code(incident_edge(before < 4 ? before : after));
  }

  const BoxFacePair& pair_;
  const Parallelogram& inc_;
  int ax_, au_;
  double hu_, hv_;
  double inverse_ = 0.0;
  unsigned used_ = 0;
};

/// True when the corner coincides with the point, which then takes the deeper place of the two.
bool joins(const Corner& corner, BoxClipPoint& point) noexcept {
  if (std::abs(corner.u - point.u) > kMerge || std::abs(corner.v - point.v) > kMerge) return false;
  if (corner.phi < point.phi) {
    point.u = corner.u;
    point.v = corner.v;
    point.phi = corner.phi;
  }
  return true;
}

/// Cuts by those sides of the reference face that the parallelogram reaches beyond.
int cut_by_sides(const Parallelogram& inc, double hu, double hv, Corners& first, Corners& second,
                 Corners** result) noexcept {
  int count = 4;
  Corners* from = &first;
  Corners* to = &second;
  const double reach_u = std::abs(inc.e1u) + std::abs(inc.e2u);
  const double reach_v = std::abs(inc.e1v) + std::abs(inc.e2v);
  if (inc.cu + reach_u > hu) {
    count = cut<&Corner::u>(*from, count, 1.0, hu, 4, *to);
    std::swap(from, to);
  }
  if (inc.cv + reach_v > hv) {
    count = cut<&Corner::v>(*from, count, 1.0, hv, 5, *to);
    std::swap(from, to);
  }
  if (inc.cu - reach_u < -hu) {
    count = cut<&Corner::u>(*from, count, -1.0, hu, 6, *to);
    std::swap(from, to);
  }
  if (inc.cv - reach_v < -hv) {
    count = cut<&Corner::v>(*from, count, -1.0, hv, 7, *to);
    std::swap(from, to);
  }
  *result = from;
  return count;
}

}  // namespace

void clip_box_face(const BoxFacePair& pair, BoxPolygon& out) noexcept {
  const int ax = pair.face / 2;
  const double hu = pair.half_ref[next(ax)];
  const double hv = pair.half_ref[next(next(ax))];
  const Parallelogram inc = project(pair, ax);
  Corners first;
  Corners second;
  for (int i = 0; i < 4; ++i) {
    const double s1 = i == 1 || i == 2 ? 1.0 : -1.0;
    const double s2 = i >= 2 ? 1.0 : -1.0;
    first[static_cast<std::size_t>(i)] = {inc.cu + s1 * inc.e1u + s2 * inc.e2u, inc.cv + s1 * inc.e1v + s2 * inc.e2v,
                                          inc.c_phi + s1 * inc.e1_phi + s2 * inc.e2_phi, i};
  }
  Corners* corners = nullptr;
  const int count = cut_by_sides(inc, hu, hv, first, second, &corners);
  out.count = 0;
  if (count == 0) return;
  Namer namer(pair, inc, ax, hu, hv);
  out.least_phi = (*corners)[0].phi;
  for (int i = 0; i < count; ++i) {
    const Corner& corner = (*corners)[static_cast<std::size_t>(i)];
    const int before = (*corners)[static_cast<std::size_t>(i == 0 ? count - 1 : i - 1)].label;
    out.least_phi = std::min(out.least_phi, corner.phi);
    if (out.count > 0 && joins(corner, out.points[static_cast<std::size_t>(out.count - 1)])) continue;
    if (out.count > 1 && i == count - 1 && joins(corner, out.points[0])) continue;
    if (out.count == 8) break;
    BoxClipPoint& point = out.points[static_cast<std::size_t>(out.count++)];
    point.u = corner.u;
    point.v = corner.v;
    point.phi = corner.phi;
    namer.name(corner, before, corner.label, point);
  }
}

}  // namespace snug::geometry::internal
