// Clip: Sutherland-Hodgman in space, between planes through the sides of the reference face.
#include <algorithm>
#include <cmath>

#include "snug/geometry/internal/clip.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

/// Labels of sides of the reference face start here; below are sides of the incident face.
constexpr int kRefSide = 1024;

struct Corner {
  Vector3 p;
  int label = 0;  ///< the side that leaves the corner
};

struct Corners {
  int count = 0;
  std::array<Corner, kMaxCorners> at;
  Corner& operator[](int i) { return at[static_cast<std::size_t>(i)]; }
  const Corner& operator[](int i) const { return at[static_cast<std::size_t>(i)]; }
  void add(const Vector3& p, int label) {
    if (count < static_cast<int>(kMaxCorners)) at[static_cast<std::size_t>(count++)] = {p, label};
  }
};

int at(std::span<const int> loop, int i) { return loop[static_cast<std::size_t>(i)]; }

/// Keeps the part below the plane m.(p - o) = 0.
void cut(const Corners& in, const Vector3& o, const Vector3& m, int side, Corners& out) noexcept {
  out.count = 0;
  if (in.count == 0) return;
  const Corner* from = &in[in.count - 1];
  double d_from = m.dot(from->p - o);
  for (int i = 0; i < in.count; ++i) {
    const Corner* to = &in[i];
    const double d_to = m.dot(to->p - o);
    if ((d_from <= 0.0) != (d_to <= 0.0)) {
      const double t = d_from / (d_from - d_to);
      out.add(from->p + t * (to->p - from->p), d_to > 0.0 ? side : from->label);
    }
    if (d_to <= 0.0) out.add(to->p, to->label);
    from = to;
    d_from = d_to;
  }
}

int find_edge(const Polytope& shape, int v, int w) noexcept {
  for (int e = 0; e < shape.edge_count(); ++e) {
    const std::array<int, 4>& edge = shape.edge(e);
    if ((edge[0] == v && edge[1] == w) || (edge[0] == w && edge[1] == v)) return e;
  }
  return 0;
}

/// Names the corners of the clipped polygon and drops those that coincide.
class Namer {
 public:
  Namer(const ClipTask& task, int inc_face)
      : task_(task), inc_face_(inc_face), ref_loop_(task.ref.face(task.face)), m_(task.ref.normal(task.face)) {
    if (inc_face >= 0) inc_loop_ = task.inc.face(inc_face);
    inverse_ = 1.0 / task.n.dot(m_);
  }

  /// Height over the reference face along n.
  [[nodiscard]] double height(const Vector3& p) const { return m_.dot(p - task_.ref.vertex(ref_loop_[0])) * inverse_; }

  void add(const Corner& corner, int before, ClipPolygon& out) const {
    ClipPoint point;
    point.phi = height(corner.p);
    point.p_ref = corner.p - point.phi * task_.n;
    out.least_phi = out.count == 0 ? point.phi : std::min(out.least_phi, point.phi);
    if (joins(point, out)) return;
    name(before, corner.label, point, out);
    out.points[static_cast<std::size_t>(out.count++)] = point;
  }

  /// For the ends of a clipped segment: `inc_code` names the point on it, `side` is the clipping side or -1.
  void add_segment_end(const Vector3& p, std::uint32_t inc_code, int side, ClipPolygon& out) const {
    ClipPoint point;
    point.phi = height(p);
    point.p_ref = p - point.phi * task_.n;
    out.least_phi = out.count == 0 ? point.phi : std::min(out.least_phi, point.phi);
    if (joins(point, out)) return;
    point.code_inc = inc_code;
    point.code_ref =
        side < 0 ? face_code(task_.face) : edge_code(find_edge(task_.ref, at(ref_loop_, side), ref_next(side)));
    out.points[static_cast<std::size_t>(out.count++)] = point;
  }

 private:
  static bool near(const Vector3& a, const Vector3& b, double tolerance) {
    return (a - b).squaredNorm() <= tolerance * tolerance;
  }
  /// True when the point coincides with its neighbour or the first one, which then takes the deeper place of the two.
  static bool joins(const ClipPoint& point, ClipPolygon& out) {
    if (out.count == 0) return false;
    for (const int i : {0, out.count - 1}) {
      ClipPoint& other = out.points[static_cast<std::size_t>(i)];
      if (!near(point.p_ref, other.p_ref, kMerge)) continue;
      if (point.phi < other.phi) {
        other.phi = point.phi;
        other.p_ref = point.p_ref;
      }
      return true;
    }
    return false;
  }
  int ref_next(int side) const { return at(ref_loop_, (side + 1) % static_cast<int>(ref_loop_.size())); }
  int inc_next(int side) const { return at(inc_loop_, (side + 1) % static_cast<int>(inc_loop_.size())); }

  int vertex_near(const Polytope& shape, std::span<const int> loop, const Vector3& p_ref) const {
    for (const int v : loop) {
      const Vector3 foot = shape.vertex(v) - height(shape.vertex(v)) * task_.n;
      if (near(foot, p_ref, kSnap)) return v;
    }
    return -1;
  }

  void name(int before, int after, ClipPoint& point, const ClipPolygon& done) const {
    const bool ref_first = task_.name_ref_first;
    const int first =
        ref_first ? vertex_near(task_.ref, ref_loop_, point.p_ref) : vertex_near(task_.inc, inc_loop_, point.p_ref);
    if (first >= 0) {
      set_vertex(ref_first, first, point);
      if (is_new(point, done)) return;
    } else {
      const int second =
          ref_first ? vertex_near(task_.inc, inc_loop_, point.p_ref) : vertex_near(task_.ref, ref_loop_, point.p_ref);
      if (second >= 0) {
        set_vertex(!ref_first, second, point);
        if (is_new(point, done)) return;
      }
    }
    name_by_sides(before, after, point);
    if (!is_new(point, done)) point.code_inc |= kSecond;
  }
  void set_vertex(bool of_ref, int v, ClipPoint& point) const {
    point.code_ref = of_ref ? vertex_code(v) : face_code(task_.face);
    point.code_inc = of_ref ? face_code(inc_face_) : vertex_code(v);
  }
  void name_by_sides(int before, int after, ClipPoint& point) const {
    if (before < kRefSide && after < kRefSide) return set_vertex(false, at(inc_loop_, after), point);
    if (before >= kRefSide && after >= kRefSide) {
      const int size = static_cast<int>(ref_loop_.size());
      const int a = before - kRefSide;
      const int b = after - kRefSide;
      return set_vertex(true, at(ref_loop_, (a + 1) % size == b ? b : a), point);
    }
    const int ref_side = (before >= kRefSide ? before : after) - kRefSide;
    const int inc_side = before >= kRefSide ? after : before;
    point.code_ref = edge_code(find_edge(task_.ref, at(ref_loop_, ref_side), ref_next(ref_side)));
    point.code_inc = edge_code(find_edge(task_.inc, at(inc_loop_, inc_side), inc_next(inc_side)));
  }
  static bool is_new(const ClipPoint& point, const ClipPolygon& done) {
    for (int i = 0; i < done.count; ++i) {
      const ClipPoint& other = done.points[static_cast<std::size_t>(i)];
      if (other.code_ref == point.code_ref && other.code_inc == point.code_inc) return false;
    }
    return true;
  }

  const ClipTask& task_;
  int inc_face_;
  std::span<const int> ref_loop_;
  std::span<const int> inc_loop_;
  const Vector3& m_;
  double inverse_ = 1.0;
};

/// The stretch of the segment over the face.
void clip_segment(const ClipTask& task, const Namer& namer, ClipPolygon& out) noexcept {
  const bool is_point = task.inc.vertex_count() == 1;
  const Vector3& a = task.inc.vertex(0);
  const Vector3& b = task.inc.vertex(is_point ? 0 : 1);
  const std::span<const int> loop = task.ref.face(task.face);
  double low = 0.0;
  double high = 1.0;
  int low_side = -1;
  int high_side = -1;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Vector3& from = task.ref.vertex(loop[k]);
    const Vector3 m = (task.ref.vertex(loop[(k + 1) % loop.size()]) - from).cross(task.n);
    const double d_a = m.dot(a - from);
    const double d_b = m.dot(b - from);
    if (d_a > 0.0 && d_b > 0.0) return;
    if (d_a > 0.0 && d_a / (d_a - d_b) > low) {
      low = d_a / (d_a - d_b);
      low_side = static_cast<int>(k);
    } else if (d_b > 0.0 && d_a / (d_a - d_b) < high) {
      high = d_a / (d_a - d_b);
      high_side = static_cast<int>(k);
    }
  }
  if (low > high) return;
  const Vector3 p_low = a + low * (b - a);
  namer.add_segment_end(p_low, low_side < 0 ? vertex_code(0) : edge_code(0), low_side, out);
  if (is_point) return;
  const Vector3 p_high = a + high * (b - a);
  // The second end carries its own mark: both ends may be cut by the same side's neighbours.
  namer.add_segment_end(p_high, high_side < 0 ? vertex_code(1) : edge_code(1), high_side, out);
}

}  // namespace

void clip_faces(const ClipTask& task, ClipPolygon& out) noexcept {
  out.count = 0;
  out.least_phi = 0.0;
  const int inc_face = task.inc.is_segment() ? -1 : task.inc.face_along(-task.n);
  const Namer namer(task, inc_face);
  if (task.inc.is_segment()) return clip_segment(task, namer, out);
  Corners first;
  Corners second;
  Corners* from = &first;
  Corners* to = &second;
  int label = 0;
  for (const int v : task.inc.face(inc_face)) from->add(task.inc.vertex(v), label++);
  const std::span<const int> loop = task.ref.face(task.face);
  for (std::size_t k = 0; k < loop.size() && from->count > 0; ++k) {
    const Vector3& start = task.ref.vertex(loop[k]);
    const Vector3 outward = (task.ref.vertex(loop[(k + 1) % loop.size()]) - start).cross(task.n);
    cut(*from, start, outward, kRefSide + static_cast<int>(k), *to);
    std::swap(from, to);
  }
  for (int i = 0; i < from->count; ++i) {
    namer.add((*from)[i], (*from)[i == 0 ? from->count - 1 : i - 1].label, out);
  }
}

void reduce(double margin, ClipPolygon& polygon) noexcept {
  int kept = 0;
  for (int i = 0; i < polygon.count; ++i) {
    const auto from = static_cast<std::size_t>(i);
    if (polygon.points[from].phi <= margin) polygon.points[static_cast<std::size_t>(kept++)] = polygon.points[from];
  }
  polygon.count = kept;
  while (polygon.count > kMaxManifoldPoints) {
    const auto count = static_cast<std::size_t>(polygon.count);
    std::size_t deepest = 0;
    for (std::size_t i = 1; i < count; ++i) {
      if (polygon.points[i].phi < polygon.points[deepest].phi) deepest = i;
    }
    std::size_t victim = count;
    double least = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      if (i == deepest) continue;
      const Vector3& before = polygon.points[(i + count - 1) % count].p_ref;
      const Vector3& after = polygon.points[(i + 1) % count].p_ref;
      const double area = (polygon.points[i].p_ref - before).cross(after - before).squaredNorm();
      if (victim < count && area >= least) continue;
      least = area;
      victim = i;
    }
    for (std::size_t i = victim; i + 1 < count; ++i) polygon.points[i] = polygon.points[i + 1];
    --polygon.count;
  }
}

}  // namespace snug::geometry::internal
