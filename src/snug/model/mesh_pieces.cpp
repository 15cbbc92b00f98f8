#include "snug/model/mesh_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>

namespace snug::model {
namespace {

/// A piece of this volume over area^(3/2) or less is flat: a hull needs 1e-6 of its size.
constexpr double kFlat = 1e-7;

/// One number for each position: the least index of a point there.
std::vector<int> weld(const std::vector<Vector3>& points) {
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [&points](int a, int b) {
    const Vector3& p = points[static_cast<std::size_t>(a)];
    const Vector3& q = points[static_cast<std::size_t>(b)];
    if (p.x() != q.x()) return p.x() < q.x();
    if (p.y() != q.y()) return p.y() < q.y();
    return p.z() != q.z() ? p.z() < q.z() : a < b;
  };
  std::sort(order.begin(), order.end(), before);
  std::vector<int> corner_of(points.size());
  int first = -1;
  for (const int i : order) {
    if (first < 0 || points[static_cast<std::size_t>(i)] != points[static_cast<std::size_t>(first)]) first = i;
    corner_of[static_cast<std::size_t>(i)] = first;
  }
  return corner_of;
}

int corner(const std::vector<int>& corner_of, int point) { return corner_of[static_cast<std::size_t>(point)]; }

bool is_closed(const std::vector<std::array<int, 3>>& triangles, const std::vector<int>& corner_of) {
  std::vector<std::uint64_t> forward, backward;
  const auto key = [](int a, int b) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32U) | static_cast<std::uint32_t>(b);
  };
  for (const std::array<int, 3>& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = corner(corner_of, triangle[k]), b = corner(corner_of, triangle[(k + 1) % 3]);
      forward.push_back(key(a, b));
      backward.push_back(key(b, a));
    }
  }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  return !forward.empty() && forward == backward;
}

/// Volume and area of triangles, about a point near them: far from the origin the volume of a small body would drown.
void add_triangle(const Vector3& a, const Vector3& b, const Vector3& c, SurfaceMeasures& measures) {
  measures.volume += a.dot(b.cross(c)) / 6.0;
  measures.area += 0.5 * (b - a).cross(c - a).norm();
}

/// An edge of a triangle, by its corners.
struct Edge {
  int low, high;
  int triangle;
  bool is_forward;  ///< from low to high
};

std::vector<Edge> sorted_edges(const MeshPart& part, const std::vector<int>& corner_of) {
  std::vector<Edge> edges;
  edges.reserve(3 * part.triangles.size());
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = corner(corner_of, part.triangles[i][k]), b = corner(corner_of, part.triangles[i][(k + 1) % 3]);
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<int>(i), a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) {
    if (e.low != f.low) return e.low < f.low;
    return e.high != f.high ? e.high < f.high : e.triangle < f.triangle;
  });
  return edges;
}

/// Sets of triangles that hang together, and which of each set are wound the other way than its first.
class Sheets {
 public:
  explicit Sheets(std::size_t triangles) : parent_(triangles), is_turned_(triangles, 0) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  struct Place {
    int sheet = 0;  ///< its first triangle
    bool is_turned = false;
  };
  [[nodiscard]] Place find(int triangle) const {
    Place place{triangle, false};
    while (true) {
      place.is_turned ^= is_turned_[static_cast<std::size_t>(place.sheet)] != 0;
      const int up = corner(parent_, place.sheet);
      if (up == place.sheet) return place;
      place.sheet = up;
    }
  }
  /// `turned`: they are wound in opposite senses.
  void join(int a, int b, bool turned) {
    Place first = find(a), second = find(b);
    if (first.sheet == second.sheet) return;
    if (second.sheet < first.sheet) std::swap(first, second);
    parent_[static_cast<std::size_t>(second.sheet)] = first.sheet;
    is_turned_[static_cast<std::size_t>(second.sheet)] = first.is_turned ^ second.is_turned ^ turned ? 1 : 0;
    shorten(a), shorten(b);
  }

 private:
  /// Points the triangle at its first one: chains stay short.
  void shorten(int triangle) {
    const Place place = find(triangle);
    if (place.sheet == triangle) return;
    parent_[static_cast<std::size_t>(triangle)] = place.sheet;
    is_turned_[static_cast<std::size_t>(triangle)] = place.is_turned ? 1 : 0;
  }

  std::vector<int> parent_;
  std::vector<char> is_turned_;  ///< against the parent
};

struct Piece {
  MeshPart part;
  SurfaceMeasures measures;
  Eigen::AlignedBox3d bounds;
};

/// Triangles that hang together by edges of two triangles, wound alike; nothing where there are more than `most`.
/// Closed surfaces that meet in a corner or an edge, as boxes of a tote do, are apart.
std::vector<Piece> find_pieces(const MeshPart& part, std::size_t most) {
  const std::vector<int> corner_of = weld(part.points);
  const std::vector<Edge> edges = sorted_edges(part, corner_of);
  Sheets sheets(part.triangles.size());
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    for (end = i; end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high;) ++end;
    if (end - i == 2)
      sheets.join(edges[i].triangle, edges[i + 1].triangle, edges[i].is_forward == edges[i + 1].is_forward);
  }
  std::vector<Piece> pieces;
  std::vector<int> piece_of(part.triangles.size(), -1);
  std::vector<std::pair<int, int>> point_of(part.points.size(), {-1, -1});  // piece and index, of the last piece
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    const Sheets::Place place = sheets.find(static_cast<int>(i));
    int& piece = piece_of[static_cast<std::size_t>(place.sheet)];
    if (piece < 0) {
      if (pieces.size() == most) return {};
      piece = static_cast<int>(pieces.size());
      pieces.emplace_back();
    }
    Piece& own = pieces[static_cast<std::size_t>(piece)];
    std::array<int, 3> triangle = part.triangles[i];
    if (place.is_turned) std::swap(triangle[1], triangle[2]);
    for (int& corner : triangle) {
      auto& [last_piece, index] = point_of[static_cast<std::size_t>(corner)];
      if (last_piece != piece) {
        last_piece = piece;
        index = static_cast<int>(own.part.points.size());
        own.part.points.push_back(part.points[static_cast<std::size_t>(corner)]);
        own.bounds.extend(own.part.points.back());
      }
      corner = index;
    }
    own.part.triangles.push_back(triangle);
  }
  if (pieces.size() != 1) return pieces;
  // One piece keeps its points as they are, whose order its hull depends on.
  pieces[0].part = part;
  for (std::size_t i = 0; i < part.triangles.size(); ++i) {
    std::array<int, 3>& triangle = pieces[0].part.triangles[i];
    if (sheets.find(static_cast<int>(i)).is_turned) std::swap(triangle[1], triangle[2]);
  }
  return pieces;
}

}  // namespace

SurfaceMeasures measure_surface(const MeshPart& part) {
  SurfaceMeasures measures;
  if (part.points.empty()) return measures;
  const Vector3 origin = part.points.front();
  const auto at = [&](int i) -> Vector3 { return part.points[static_cast<std::size_t>(i)] - origin; };
  for (const std::array<int, 3>& triangle : part.triangles)
    add_triangle(at(triangle[0]), at(triangle[1]), at(triangle[2]), measures);
  measures.is_closed = is_closed(part.triangles, weld(part.points));
  if (!measures.is_closed) measures.volume = 0.0;
  return measures;
}

SurfaceMeasures measure_surface(const geometry::ConvexHull& hull) {
  SurfaceMeasures measures;
  measures.is_closed = true;
  const auto at = [&](int i) -> Vector3 { return hull.vertices[static_cast<std::size_t>(i)] - hull.vertices.front(); };
  for (const std::vector<int>& face : hull.faces)
    for (std::size_t k = 1; k + 1 < face.size(); ++k) add_triangle(at(face[0]), at(face[k]), at(face[k + 1]), measures);
  return measures;
}

std::vector<MeshPart> split_loose_pieces(const MeshPart& part, std::size_t most) {
  std::vector<Piece> pieces = find_pieces(part, most);
  if (pieces.empty()) return {part};
  const Piece* largest = pieces.data();
  for (Piece& piece : pieces) {
    piece.measures = measure_surface(piece.part);
    if (!piece.measures.is_closed || std::abs(piece.measures.volume) <= kFlat * std::pow(piece.measures.area, 1.5))
      return {part};
    if (std::abs(piece.measures.volume) > std::abs(largest->measures.volume)) largest = &piece;
  }
  const bool faces_outwards = largest->measures.volume > 0.0;
  const auto is_cavity = [&](const Piece& piece) {
    if ((piece.measures.volume > 0.0) == faces_outwards) return false;
    return std::any_of(pieces.begin(), pieces.end(), [&](const Piece& around) {
      return (around.measures.volume > 0.0) == faces_outwards && around.bounds.contains(piece.bounds);
    });
  };
  std::vector<MeshPart> solids;
  for (const Piece& piece : pieces)
    if (!is_cavity(piece)) solids.push_back(piece.part);
  return solids;
}

}  // namespace snug::model
