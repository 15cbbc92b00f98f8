// GlbMesh: shapes as triangles.
#include "snug/replay/internal/glb_mesh.hpp"

#include <cmath>
#include <numbers>

#include "snug/geometry/convex_hull.hpp"

namespace snug::replay::internal {
namespace {

constexpr int kGlbSides = 32;  ///< of round shapes
constexpr int kGlbRings = 8;   ///< of each end of a capsule

/// The part of that colour, a new one where there is none.
GlbPart& part_of(GlbMesh& mesh, const robot::Rgba& rgba) {
  for (GlbPart& part : mesh)
    if (part.rgba == rgba) return part;
  mesh.push_back({rgba, {}, {}});
  return mesh.back();
}

/// Adds one closed body to a part; corners of triangles are numbers of its own vertices.
class GlbBody {
 public:
  GlbBody(GlbPart& part, const Pose& X) : part_(part), X_(X), first_(part.vertices.size()) {}
  int vertex(const Vector3& p) {
    const Vector3 q = X_ * p;
    part_.vertices.push_back({static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z())});
    return static_cast<int>(part_.vertices.size() - first_) - 1;
  }
  void triangle(int a, int b, int c) {
    const auto at = [&](int i) { return static_cast<std::uint32_t>(first_ + static_cast<std::size_t>(i)); };
    part_.triangles.push_back({at(a), at(b), at(c)});
  }
  /// Between two rings of kGlbSides vertices that begin at these numbers, `above` above `below`.
  void band(int below, int above) {
    for (int i = 0; i < kGlbSides; ++i) {
      const int next = (i + 1) % kGlbSides;
      triangle(below + i, below + next, above + next);
      triangle(below + i, above + next, above + i);
    }
  }
  /// kGlbSides vertices about z; the number of the first.
  int ring(double radius, double z) {
    const int first = static_cast<int>(part_.vertices.size() - first_);
    for (int i = 0; i < kGlbSides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kGlbSides;
      vertex({radius * std::cos(angle), radius * std::sin(angle), z});
    }
    return first;
  }
  /// Closes a ring by a vertex on its axis.
  void cap(int ring, const Vector3& tip, bool is_above) {
    const int middle = vertex(tip);
    for (int i = 0; i < kGlbSides; ++i) {
      const int next = (i + 1) % kGlbSides;
      triangle(middle, ring + (is_above ? i : next), ring + (is_above ? next : i));
    }
  }

 private:
  GlbPart& part_;
  Pose X_;
  std::size_t first_;
};

void box_body(GlbBody body, const Vector3& half) {
  for (int v = 0; v < 8; ++v)
    body.vertex({(v & 1) != 0 ? half.x() : -half.x(), (v & 2) != 0 ? half.y() : -half.y(),
                 (v & 4) != 0 ? half.z() : -half.z()});
  constexpr std::array<std::array<int, 4>, 6> kFaces = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& f : kFaces) {
    body.triangle(f[0], f[1], f[2]);
    body.triangle(f[0], f[2], f[3]);
  }
}

void cylinder_body(GlbBody body, double radius, double half_length) {
  const int below = body.ring(radius, -half_length), above = body.ring(radius, half_length);
  body.band(below, above);
  body.cap(below, {0.0, 0.0, -half_length}, false);
  body.cap(above, {0.0, 0.0, half_length}, true);
}

void capsule_body(GlbBody body, double radius, double half_length) {
  int last = -1, first = -1;
  for (int i = 0; i < 2 * kGlbRings; ++i) {
    const bool is_upper = i >= kGlbRings;
    const int row = is_upper ? i - kGlbRings : i + 1 - kGlbRings;  // 1 - kGlbRings ... 0, 0 ... kGlbRings - 1
    const double angle = 0.5 * std::numbers::pi * row / kGlbRings;
    const int ring =
        body.ring(radius * std::cos(angle), radius * std::sin(angle) + (is_upper ? half_length : -half_length));
    if (last < 0)
      first = ring;
    else
      body.band(last, ring);
    last = ring;
  }
  body.cap(first, {0.0, 0.0, -half_length - radius}, false);
  body.cap(last, {0.0, 0.0, half_length + radius}, true);
}

void hull_body(GlbBody body, const std::vector<Vector3>& vertices) {
  const auto hull = geometry::make_convex_hull(vertices);
  if (!hull) return;
  for (const Vector3& vertex : hull->vertices) body.vertex(vertex);
  for (const std::vector<int>& face : hull->faces)
    for (std::size_t i = 2; i < face.size(); ++i) body.triangle(face[0], face[i - 1], face[i]);
}

void drawn_body(GlbBody body, const model::DrawnMesh& mesh) {
  for (const Vector3& vertex : mesh.vertices) body.vertex(vertex);
  for (const std::array<int, 3>& t : mesh.triangles) body.triangle(t[0], t[1], t[2]);
}

}  // namespace

void add_glb_shape(GlbMesh& mesh, const record::ShapeInfo& shape, const robot::Rgba& rgba) {
  const GlbBody body(part_of(mesh, rgba), shape.X_BG.pose());
  switch (shape.kind) {
    case record::ShapeKind::Box:
      return box_body(body, shape.half);
    case record::ShapeKind::Capsule:
      return capsule_body(body, shape.radius, shape.half_length);
    case record::ShapeKind::Cylinder:
      return cylinder_body(body, shape.radius, shape.half_length);
    case record::ShapeKind::Hull:
      return hull_body(body, shape.vertices);
  }
}

void add_glb_visual(GlbMesh& mesh, const robot::Visual& visual) {
  const GlbBody body(part_of(mesh, visual.rgba), visual.X_LG);
  if (const auto* box = std::get_if<geometry::Box>(&visual.shape))
    box_body(body, box->half);
  else if (const auto* capsule = std::get_if<geometry::Capsule>(&visual.shape))
    capsule_body(body, capsule->radius, capsule->half_length);
  else if (const auto* cylinder = std::get_if<geometry::Cylinder>(&visual.shape))
    cylinder_body(body, cylinder->radius, cylinder->half_length);
  else
    drawn_body(body, std::get<model::DrawnMesh>(visual.shape));
}

void add_glb_cup(GlbMesh& mesh, const Pose& X_ES, double lip_radius, const robot::Rgba& rgba) {
  constexpr double kNeck = 0.6;  // of the lip's radius, at the gripper
  GlbBody body(part_of(mesh, rgba), Pose{});
  const int neck = body.ring(kNeck * lip_radius, 0.0);
  const int lip = neck + kGlbSides;
  for (int i = 0; i < kGlbSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kGlbSides;
    body.vertex(X_ES * Vector3(lip_radius * std::cos(angle), lip_radius * std::sin(angle), 0.0));
  }
  body.band(neck, lip);
  body.cap(neck, Vector3::Zero(), false);
  body.cap(lip, X_ES.p, true);
}

}  // namespace snug::replay::internal
