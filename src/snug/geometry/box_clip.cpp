// BoxClip: corners of the overlap of a rectangle and a parallelogram, found in closed form, with their heights.
//
// The corners are those of the parallelogram inside the rectangle, those of the rectangle inside the parallelogram,
// and the crossings of their sides. Rounding may give a corner twice, never drop it; what comes twice is merged.
#include <cmath>

#include "snug/geometry/internal/box_clip.hpp"
#include "snug/geometry/internal/box_topology.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

/// The incident face as a parallelogram c +- e1 +- e2 in (u, v), with height.
struct Parallelogram {
  int axis;       ///< of the incident box
  bool positive;  ///< which of its two faces
  double cu, cv, c_phi;
  double e1u, e1v, e1_phi;  ///< half side along the next axis
  double e2u, e2v, e2_phi;  ///< half side along the axis after that
};

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

/// Slack for corners on the rim of the other face, m and in units of half sides: twice beats never.
constexpr double kOnRim = 1e-12;

int sign_bit(bool positive, int bit) noexcept { return positive ? 1 << bit : 0; }

/// Collects corners: names them and merges those that coincide.
class Collector {
 public:
  Collector(const BoxFacePair& pair, const Parallelogram& inc, BoxPolygon& out)
      : pair_(pair),
        inc_(inc),
        out_(out),
        ax_(pair.face / 2),
        au_(next(ax_)),
        av_(next(au_)),
        k1_(next(inc.axis)),
        k2_(next(k1_)),
        hu_(pair.half_ref[au_]),
        hv_(pair.half_ref[av_]),
        snap1_(kSnap / pair.half_inc[k1_]),
        snap2_(kSnap / pair.half_inc[k2_]) {
    ref_base_ = sign_bit((pair.face & 1) != 0, ax_);
    inc_base_ = sign_bit(inc.positive, inc.axis);
  }

  void collect() {
    place_incident_corners();
    if ((beyond_[0] & beyond_[1] & beyond_[2] & beyond_[3]) != 0) return;  // beside each other
    add_incident_corners();
    if ((beyond_[0] | beyond_[1] | beyond_[2] | beyond_[3]) == 0) return;  // nothing sticks out
    invert();
    add_reference_corners();
    for (int side = 0; side < 4; ++side) add_crossings(side);
  }

 private:
  void invert() {
    const double inverse = 1.0 / (inc_.e1u * inc_.e2v - inc_.e1v * inc_.e2u);
    su_ = inc_.e2v * inverse;
    sv_ = -inc_.e2u * inverse;
    tu_ = -inc_.e1v * inverse;
    tv_ = inc_.e1u * inverse;
    // Used only where the side is not parallel to the rim; infinite otherwise.
    per_u_ = {1.0 / inc_.e1u, 1.0 / inc_.e2u};
    per_v_ = {1.0 / inc_.e1v, 1.0 / inc_.e2v};
  }

  struct Place {
    double u, v, phi;
  };

  void place_incident_corners() {
    for (std::size_t i = 0; i < 4; ++i) {
      const double s1 = i == 1 || i == 2 ? 1.0 : -1.0;
      const double s2 = i >= 2 ? 1.0 : -1.0;
      Place& p = corners_[i];
      p.u = inc_.cu + s1 * inc_.e1u + s2 * inc_.e2u;
      p.v = inc_.cv + s1 * inc_.e1v + s2 * inc_.e2v;
      p.phi = inc_.c_phi + s1 * inc_.e1_phi + s2 * inc_.e2_phi;
      // One bit for each side of the rectangle that the corner is beyond.
      beyond_[i] = (p.u > hu_ ? 1U : 0U) | (p.v > hv_ ? 2U : 0U) | (p.u < -hu_ ? 4U : 0U) | (p.v < -hv_ ? 8U : 0U);
    }
  }

  void add_incident_corners() {
    for (int i = 0; i < 4; ++i) {
      if (beyond_[static_cast<std::size_t>(i)] != 0) continue;
      const Place& p = corners_[static_cast<std::size_t>(i)];
      add(p, near_reference(p), incident_vertex(i), 0, 0);
    }
  }

  void add_reference_corners() {
    for (int i = 0; i < 4; ++i) {
      const double u = (i & 1) != 0 ? hu_ : -hu_;
      const double v = (i & 2) != 0 ? hv_ : -hv_;
      const double s = su_ * (u - inc_.cu) + sv_ * (v - inc_.cv);
      const double t = tu_ * (u - inc_.cu) + tv_ * (v - inc_.cv);
      if (!(std::abs(s) <= 1.0 + kOnRim && std::abs(t) <= 1.0 + kOnRim)) continue;
      const int ref = ref_base_ | sign_bit(u > 0.0, au_) | sign_bit(v > 0.0, av_);
      add({u, v, inc_.c_phi + s * inc_.e1_phi + t * inc_.e2_phi}, ref, near_incident(s, t), 0, 0);
    }
  }

  /// Where side `side` of the incident face enters and leaves the rectangle.
  void add_crossings(int side) {
    const unsigned start_beyond = beyond_[static_cast<std::size_t>(side)];
    const unsigned end_beyond = beyond_[static_cast<std::size_t>((side + 1) & 3)];
    if ((start_beyond | end_beyond) == 0 || (start_beyond & end_beyond) != 0) return;
    const Place& from = corners_[static_cast<std::size_t>(side)];
    const double along = side < 2 ? 2.0 : -2.0;
    const bool first = (side & 1) == 0;
    const double du = along * (first ? inc_.e1u : inc_.e2u);
    const double dv = along * (first ? inc_.e1v : inc_.e2v);
    const double per_along = side < 2 ? 0.5 : -0.5;
    double enter = 0.0;
    double leave = 1.0;
    int enters_by = -1;
    int leaves_by = -1;
    if (!cut(from.u, du, per_along * per_u_[static_cast<std::size_t>(side & 1)], hu_, 0, enter, enters_by, leave,
             leaves_by))
      return;
    if (!cut(from.v, dv, per_along * per_v_[static_cast<std::size_t>(side & 1)], hv_, 1, enter, enters_by, leave,
             leaves_by))
      return;
    if (enter > leave) return;
    const double d_phi = along * (first ? inc_.e1_phi : inc_.e2_phi);
    if (start_beyond != 0 && enters_by >= 0) {
      add_crossing({from.u + enter * du, from.v + enter * dv, from.phi + enter * d_phi}, enter, enters_by, side);
    }
    if (end_beyond != 0 && leaves_by >= 0) {
      add_crossing({from.u + leave * du, from.v + leave * dv, from.phi + leave * d_phi}, leave, leaves_by, side);
    }
  }

  /// Narrows the stretch to |start + t d| <= limit. Sides are 0: u positive, 1: v positive, 2: u negative,
  /// 3: v negative. False when nothing is left.
  static bool cut(double start, double d, double inverse, double limit, int side, double& enter, int& enters_by,
                  double& leave, int& leaves_by) {
    if (std::abs(d) <= kOnRim) return std::abs(start) <= limit + kOnRim;
    const bool rising = d > 0.0;
    const double in = ((rising ? -limit : limit) - start) * inverse;
    const double out = ((rising ? limit : -limit) - start) * inverse;
    if (in > enter) {
      enter = in;
      enters_by = rising ? side + 2 : side;
    }
    if (out < leave) {
      leave = out;
      leaves_by = rising ? side : side + 2;
    }
    return true;
  }

  /// `at`: 0 at the start of the incident side, 1 at its end.
  void add_crossing(Place p, double at, int ref_side, int inc_side) {
    // Exactly on the side.
    if (ref_side == 0 || ref_side == 2) p.u = ref_side == 0 ? hu_ : -hu_;
    if (ref_side == 1 || ref_side == 3) p.v = ref_side == 1 ? hv_ : -hv_;
    add(p, near_reference(p), near_end(at, inc_side), reference_edge(ref_side), incident_edge(inc_side));
  }

  int near_reference(const Place& p) const {
    if (std::abs(p.u) < hu_ - kSnap || std::abs(p.v) < hv_ - kSnap) return -1;
    return ref_base_ | sign_bit(p.u > 0.0, au_) | sign_bit(p.v > 0.0, av_);
  }
  int near_incident(double s, double t) const {
    if (std::abs(s) < 1.0 - snap1_ || std::abs(t) < 1.0 - snap2_) return -1;
    if (std::abs(s) > 1.0 + snap1_ || std::abs(t) > 1.0 + snap2_) return -1;
    return inc_base_ | sign_bit(s > 0.0, k1_) | sign_bit(t > 0.0, k2_);
  }
  int near_end(double at, int side) const {
    const double snap = 0.5 * ((side & 1) == 0 ? snap1_ : snap2_);
    if (at > snap && at < 1.0 - snap) return -1;
    return incident_vertex(at > 0.5 ? (side + 1) & 3 : side);
  }
  int incident_vertex(int corner) const {
    return inc_base_ | sign_bit(corner == 1 || corner == 2, k1_) | sign_bit(corner >= 2, k2_);
  }
  int reference_edge(int side) const {
    const bool positive = (pair_.face & 1) != 0;
    if (side == 0 || side == 2) return box_edge(av_, positive, side == 0);
    return box_edge(au_, side == 1, positive);
  }
  /// Sides 0 and 2 run along k1 (at k2 negative, positive), 1 and 3 along k2 (at k1 positive, negative).
  int incident_edge(int side) const {
    if (side == 0 || side == 2) return box_edge(k1_, side == 2, inc_.positive);
    return box_edge(k2_, inc_.positive, side == 1);
  }

  /// `ref` and `inc`: the vertex of either box that the corner is or is near to, or -1.
  void add(const Place& p, int ref, int inc, int ref_edge, int inc_edge) {
    out_.least_phi = out_.count == 0 ? p.phi : std::min(out_.least_phi, p.phi);
    // Only near a vertex can two corners coincide; a lone vertex knows only itself.
    if ((ref >= 0 || inc >= 0) && joins_another(p)) return;
    if (out_.count == static_cast<int>(out_.points.size())) return;
    BoxClipPoint& point = out_.points[static_cast<std::size_t>(out_.count++)];
    point.u = p.u;
    point.v = p.v;
    point.phi = p.phi;
    name(ref, inc, ref_edge, inc_edge, point);
  }

  /// True when the corner coincides with a point, which then takes the deeper place of the two.
  bool joins_another(const Place& p) {
    for (int i = 0; i < out_.count; ++i) {
      BoxClipPoint& point = out_.points[static_cast<std::size_t>(i)];
      if (std::abs(p.u - point.u) > kMerge || std::abs(p.v - point.v) > kMerge) continue;
      if (p.phi < point.phi) {
        point.u = p.u;
        point.v = p.v;
        point.phi = p.phi;
      }
      return true;
    }
    return false;
  }

  void name(int ref, int inc, int ref_edge, int inc_edge, BoxClipPoint& point) {
    // A corner of both boxes at once takes its name from one of them, always the same.
    const bool by_ref = ref >= 0 && (inc < 0 || pair_.name_ref_first);
    const int vertex = by_ref ? ref : inc;
    if (vertex < 0) {
      point.code_ref = edge_code(ref_edge);
      point.code_inc = edge_code(inc_edge);
      return;
    }
    point.code_ref = by_ref ? vertex_code(vertex) : face_code(pair_.face);
    point.code_inc = by_ref ? face_code(box_face(inc_.axis, inc_.positive)) : vertex_code(vertex);
    // Up to four corners can lie around one vertex; they differ in these bits.
    const int slot = (by_ref ? 0 : 16) + 2 * vertex;
    const std::uint32_t order = static_cast<std::uint32_t>(used_ >> slot & 3U);
    used_ += std::uint64_t{1} << slot;
    point.code_inc |= order * kSecond;
  }

  const BoxFacePair& pair_;
  const Parallelogram& inc_;
  BoxPolygon& out_;
  int ax_, au_, av_, k1_, k2_;
  double hu_, hv_;
  double snap1_, snap2_;                              ///< kSnap in units of the incident half sides
  double su_ = 0.0, sv_ = 0.0, tu_ = 0.0, tv_ = 0.0;  ///< (u, v) to the parallelogram's own coordinates
  std::array<double, 2> per_u_{}, per_v_{};           ///< 1 / half side
  int ref_base_ = 0;                                  ///< vertex bits that all corners of the face share
  int inc_base_ = 0;
  std::array<Place, 4> corners_;  ///< of the incident face
  std::array<unsigned, 4> beyond_{};
  std::uint64_t used_ = 0;  ///< how often each vertex has given its name, two bits each
};

}  // namespace

void clip_box_face(const BoxFacePair& pair, BoxPolygon& out) noexcept {
  out.count = 0;
  out.least_phi = 0.0;
  const Parallelogram inc = project(pair, pair.face / 2);
  Collector(pair, inc, out).collect();
}

}  // namespace snug::geometry::internal
