// RandomPair: draws shapes and poses, then slides B until the pair is as near as wanted.
#include "random_pair.hpp"

#include <cmath>
#include <numbers>

#include "snug/geometry/convex_hull.hpp"

namespace snug::geometry::test {

namespace {

double log_uniform(double low, double high, Rng& rng) { return std::exp(rng.uniform(std::log(low), std::log(high))); }

Vector3 random_unit(Rng& rng) { return Vector3(rng.normal(), rng.normal(), rng.normal()).normalized(); }

Vector3 sizes(double low, double high, Rng& rng) {
  return {log_uniform(low, high, rng), log_uniform(low, high, rng), log_uniform(low, high, rng)};
}

/// A gap: touching exactly, by rounding, by hairs, by millimetres, deep or apart.
double random_gap(double margin, Rng& rng) {
  const double sign = rng.index(2) == 0 ? 1.0 : -1.0;
  switch (rng.index(6)) {
    case 0:
      return 0.0;
    case 1:
      return sign * log_uniform(1e-17, 1e-9, rng);
    case 2:
      return sign * log_uniform(1e-9, 1e-4, rng);
    case 3:
      return margin + sign * log_uniform(1e-12, 1e-4, rng);
    case 4:
      return rng.uniform(-0.02, 0.01);
    default:
      return margin * rng.uniform(0.0, 1.1);
  }
}

double reach(const Shape& shape, const Matrix3& R, const Vector3& n_W) {
  const Vector3 n = R.transpose() * n_W;
  if (const Box* box = std::get_if<Box>(&shape)) return n.cwiseAbs().dot(box->half);
  if (const Capsule* c = std::get_if<Capsule>(&shape)) return std::abs(n.z()) * c->half_length + c->radius;
  double best = -1e300;
  for (const Vector3& v : std::get_if<ConvexHull>(&shape)->vertices) best = std::max(best, n.dot(v));
  return best;
}

/// Moves B along n until the support planes square to n are `gap` apart.
void set_gap(const Vector3& n, double gap, RandomPair& pair) {
  const double now = n.dot(pair.X_WB.p - pair.X_WA.p) - reach(pair.A, pair.X_WA.R, n) - reach(pair.B, pair.X_WB.R, -n);
  pair.X_WB.p += (gap - now) * n;
}

/// A direction that matters to the pair: a face, a cross product of axes, or any.
Vector3 interesting_direction(const RandomPair& pair, Rng& rng) {
  const double sign = rng.index(2) == 0 ? 1.0 : -1.0;
  const int i = rng.index(3);
  const int j = rng.index(3);
  switch (rng.index(4)) {
    case 0:
      return sign * pair.X_WA.R.col(i);
    case 1:
      return sign * pair.X_WB.R.col(j);
    case 2: {
      const Vector3 cross = pair.X_WA.R.col(i).cross(pair.X_WB.R.col(j));
      if (cross.norm() > 1e-3) return sign * cross.normalized();
      return sign * pair.X_WA.R.col(i);
    }
    default:
      return random_unit(rng);
  }
}

Matrix3 turned_by(double angle, Rng& rng) { return exp_rotation(angle * random_unit(rng)); }

void place_general(RandomPair& pair, Rng& rng) {
  pair.X_WB.R = random_rotation(rng);
  const Vector3 n = interesting_direction(pair, rng);
  pair.X_WB.p = pair.X_WA.p + rng.uniform(0.0, 0.1) * random_unit(rng);
  set_gap(n, random_gap(pair.margin, rng), pair);
}

/// Offsets that make faces, sides and edges flush, now and then by a hair.
void place_aligned(RandomPair& pair, Rng& rng) {
  Box& A = std::get<Box>(pair.A);
  Box& B = std::get<Box>(pair.B);
  if (rng.index(2) == 0) B = A;
  for (int k = 0; k < 3; ++k) {
    if (rng.index(3) == 0) B.half[k] = A.half[k];
  }
  // A permutation of the axes keeps all faces parallel.
  Matrix3 P = Matrix3::Identity();
  for (int turns = rng.index(4); turns > 0; --turns) {
    Matrix3 quarter = Matrix3::Zero();
    const int k = rng.index(3);
    quarter(k, k) = 1.0;
    quarter((k + 1) % 3, (k + 2) % 3) = -1.0;
    quarter((k + 2) % 3, (k + 1) % 3) = 1.0;
    P = quarter * P;
  }
  const Vector3 half_B = P.cwiseAbs() * B.half;
  Vector3 p_AB;
  for (int k = 0; k < 3; ++k) {
    const double touching = (rng.index(2) == 0 ? 1.0 : -1.0) * (A.half[k] + half_B[k]);
    const double flush = (rng.index(2) == 0 ? 1.0 : -1.0) * (A.half[k] - half_B[k]);
    switch (rng.index(4)) {
      case 0:
        p_AB[k] = touching + std::copysign(random_gap(pair.margin, rng), touching);
        break;
      case 1:
        p_AB[k] = flush + (rng.index(2) == 0 ? 0.0 : random_gap(0.0, rng));
        break;
      case 2:
        p_AB[k] = 0.0;
        break;
      default:
        p_AB[k] = rng.uniform(-1.0, 1.0) * (A.half[k] + half_B[k]);
    }
  }
  pair.X_WB = pair.X_WA * Pose{P, p_AB};
}

void place_diamond(RandomPair& pair, Rng& rng) {
  const double eighth = std::numbers::pi / 4.0 * (1 + rng.index(3));
  const double off = rng.index(2) == 0 ? 0.0 : log_uniform(1e-12, 1e-2, rng);
  pair.X_WB.R = pair.X_WA.R * exp_rotation((eighth + off) * Vector3::Unit(rng.index(3)));
  if (rng.index(2) == 0) pair.X_WB.R = pair.X_WB.R * exp_rotation(std::numbers::pi / 4.0 * Vector3::Unit(rng.index(3)));
  if (rng.index(2) == 0) pair.X_WB.R = pair.X_WB.R * turned_by(log_uniform(1e-12, 1e-3, rng), rng);
  pair.X_WB.p = pair.X_WA.p + (rng.index(2) == 0 ? 0.0 : 0.1) * random_unit(rng);
  set_gap(interesting_direction(pair, rng), random_gap(pair.margin, rng), pair);
}

void place_deep(RandomPair& pair, Rng& rng) {
  Box& A = std::get<Box>(pair.A);
  Box& B = std::get<Box>(pair.B);
  if (rng.index(3) == 0) B = A;
  if (rng.index(3) == 0) B.half *= rng.uniform(0.01, 1.0);
  pair.X_WB = pair.X_WA;
  if (rng.index(3) > 0) pair.X_WB.R = pair.X_WB.R * turned_by(log_uniform(1e-12, 3.0, rng), rng);
  if (rng.index(3) > 0) pair.X_WB.p += log_uniform(1e-12, 0.1, rng) * random_unit(rng);
}

const ConvexHull& draw(const std::vector<ConvexHull>& stock, Rng& rng) {
  return stock[static_cast<std::size_t>(rng.index(static_cast<int>(stock.size())))];
}

void place_capsules(const std::vector<ConvexHull>& stock, RandomPair& pair, Rng& rng) {
  pair.B = Capsule{rng.index(8) == 0 ? 0.0 : log_uniform(1e-3, 0.4, rng), log_uniform(2e-3, 0.1, rng)};
  switch (rng.index(4)) {
    case 0:
      pair.A = draw(stock, rng);
      break;
    case 1:
      pair.A = Capsule{log_uniform(1e-3, 0.4, rng), log_uniform(2e-3, 0.1, rng)};
      break;
    default:
      break;
  }
  place_general(pair, rng);
  if (rng.index(2) == 0) {
    // Along a face or an edge of A, exactly or almost.
    const Matrix3 along = exp_rotation(std::numbers::pi / 2.0 * Vector3::Unit(rng.index(3)));
    pair.X_WB.R = pair.X_WA.R * along;
    if (rng.index(2) == 0) pair.X_WB.R = pair.X_WB.R * turned_by(log_uniform(1e-12, 1e-2, rng), rng);
    set_gap(interesting_direction(pair, rng), random_gap(pair.margin, rng), pair);
  }
  if (rng.index(8) == 0) pair.X_WB.p = pair.X_WA.p + rng.uniform(0.0, 0.05) * random_unit(rng);
}

void place_hulls(const std::vector<ConvexHull>& stock, RandomPair& pair, Rng& rng) {
  pair.A = draw(stock, rng);
  if (rng.index(2) == 0) pair.B = draw(stock, rng);
  place_general(pair, rng);
  if (rng.index(3) == 0) {
    pair.X_WB.R = pair.X_WA.R;
    if (rng.index(2) == 0) pair.X_WB.R = pair.X_WB.R * turned_by(log_uniform(1e-12, 1e-2, rng), rng);
    set_gap(interesting_direction(pair, rng), random_gap(pair.margin, rng), pair);
  }
}

}  // namespace

Matrix3 random_rotation(Rng& rng) {
  return Quaternion(rng.normal(), rng.normal(), rng.normal(), rng.normal()).normalized().toRotationMatrix();
}

ConvexHull random_hull(Rng& rng) {
  while (true) {
    std::vector<Vector3> points;
    const Vector3 half = sizes(0.02, 0.2, rng);
    const int kind = rng.index(3);
    if (kind == 0) {
      const int count = 4 + rng.index(7);
      for (int i = 0; i < count; ++i) points.push_back(rng.uniform(0.5, 1.0) * half.cwiseProduct(random_unit(rng)));
    } else {
      // A prism or a frustum over a regular polygon.
      const int sides = 3 + rng.index(4);
      const double top = kind == 1 ? 1.0 : rng.uniform(0.2, 0.9);
      for (int i = 0; i < sides; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / sides;
        const Vector3 p(half.x() * std::cos(angle), half.y() * std::sin(angle), 0.0);
        points.push_back(p - half.z() * Vector3::UnitZ());
        points.push_back(top * p + half.z() * Vector3::UnitZ());
      }
    }
    const auto hull = make_convex_hull(points);
    if (hull) return *hull;
  }
}

PairMaker::PairMaker(std::uint64_t seed, int hulls) {
  Rng rng = Rng(seed).split("hulls");
  for (int i = 0; i < hulls; ++i) stock_.push_back(random_hull(rng));
}

RandomPair PairMaker::make(Family family, Rng& rng) const {
  RandomPair pair;
  pair.family = family;
  const double margins[] = {0.0, 1e-3, 5e-3, 2e-2};
  pair.margin = margins[rng.index(4)];
  const bool sliver = family == Family::Sliver;
  pair.A = Box{sizes(sliver ? 1e-3 : 0.02, sliver ? 1.0 : 0.3, rng)};
  pair.B = Box{sizes(sliver ? 1e-3 : 0.02, sliver ? 1.0 : 0.3, rng)};
  if (rng.index(4) > 0) pair.X_WA.R = random_rotation(rng);
  if (rng.index(2) == 0) pair.X_WA.p = rng.uniform(0.0, 1.0) * random_unit(rng);
  switch (family) {
    case Family::General:
    case Family::Sliver:
      place_general(pair, rng);
      break;
    case Family::Aligned:
      place_aligned(pair, rng);
      break;
    case Family::AlmostAligned:
      place_aligned(pair, rng);
      pair.X_WB.R = pair.X_WB.R * turned_by(log_uniform(1e-12, 1e-3, rng), rng);
      break;
    case Family::Diamond:
      place_diamond(pair, rng);
      break;
    case Family::Deep:
      place_deep(pair, rng);
      break;
    case Family::Capsules:
      place_capsules(stock_, pair, rng);
      break;
    case Family::Hulls:
      place_hulls(stock_, pair, rng);
      break;
  }
  return pair;
}

}  // namespace snug::geometry::test
