// Fuzz: what must hold for every pair, checked one by one.
#include "fuzz.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "reference.hpp"

namespace snug::geometry::test {

namespace {

// The bound that README.md states for depth and distance: 1 um and a thousandth of the depth.
constexpr double kAllowance = 1e-6;
constexpr double kAllowanceRelative = 1e-3;
// Rounding: sizes to 1 m at 1 m from the origin, condition of cross products of edges 1e-7 apart.
constexpr double kRounding = 2e-9;
// Hulls are flat to 4e-7 of their size, up to 0.6 m.
constexpr double kHullFlatness = 3e-7;

constexpr std::array<const char*, kFamilies> kNames = {"general", "aligned", "almost aligned", "sliver",
                                                       "diamond", "deep",    "capsules",       "hulls"};

class Checker {
 public:
  Checker(const RandomPair& pair, long long index, FuzzResult& result)
      : pair_(pair),
        index_(index),
        result_(result),
        worst_(result.worst[static_cast<std::size_t>(pair.family)]),
        A_(place(pair.A, pair.X_WA)),
        B_(place(pair.B, pair.X_WB)),
        truth_(find_truth(A_, B_, pair.margin)) {
    const bool has_hull = std::holds_alternative<ConvexHull>(pair.A) || std::holds_alternative<ConvexHull>(pair.B);
    rounding_ = has_hull ? kHullFlatness : kRounding;
  }

  void run() {
    ++worst_.pairs;
    PairCache cache;
    Manifold first;
    collide(pair_.A, pair_.X_WA, pair_.B, pair_.X_WB, pair_.margin, cache, first);
    check(first);
    check_order(first, cache);
    Manifold again;
    collide(pair_.A, pair_.X_WA, pair_.B, pair_.X_WB, pair_.margin, cache, again);
    expect(same(first, again), "a second call with what the first remembered differs");
  }

  /// The same checks for a pair that remembers something from another pose.
  void run_with(PairCache cache) {
    Manifold manifold;
    collide(pair_.A, pair_.X_WA, pair_.B, pair_.X_WB, pair_.margin, cache, manifold);
    check(manifold);
  }

 private:
  void expect(bool holds, const char* what, double by = 0.0) {
    if (holds) return;
    ++result_.failure_count;
    if (result_.failures.size() >= 20) return;
    char text[240];
    std::snprintf(text, sizeof text, "pair %lld (%s): %s, %.3e (truth %.6e, overlap %d, margin %.3g)", index_,
                  kNames[static_cast<std::size_t>(pair_.family)], what, by, static_cast<double>(truth_.separation),
                  truth_.overlap ? 1 : 0, pair_.margin);
    result_.failures.emplace_back(text);
  }

  static bool same(const Manifold& a, const Manifold& b) {
    if (a.count != b.count) return false;
    if (a.count > 0 && a.n_AB_W != b.n_AB_W) return false;
    for (std::size_t i = 0; i < static_cast<std::size_t>(a.count); ++i) {
      if (a.points[i].phi != b.points[i].phi || a.points[i].feature != b.points[i].feature) return false;
    }
    return true;
  }

  void check(const Manifold& m) {
    if (m.count == 0) {
      const double missed = pair_.margin - static_cast<double>(truth_.separation);
      if (truth_.beyond || missed < rounding_) return;
      if (truth_.may_be_corner) {
        ++worst_.corners;
        return;
      }
      return expect(false, "no contact within the margin", missed);
    }
    ++worst_.contacts;
    check_depth(m);
    check_points(m);
  }

  void check_depth(const Manifold& m) {
    double least = m.points[0].phi;
    for (int i = 1; i < m.count; ++i) least = std::min(least, m.points[static_cast<std::size_t>(i)].phi);
    const double truth = static_cast<double>(truth_.separation);
    // What is relative is relative to the depth of the cores.
    const double depth = truth_.overlap ? -truth : 0.0;
    const double phantom = truth - least;
    const double missed = least - truth;
    const bool apart = !truth_.overlap;
    if (apart) ++worst_.apart;
    worst_.phantom = std::max(worst_.phantom, phantom - kAllowanceRelative * depth);
    worst_.missed = std::max(worst_.missed, missed - kAllowanceRelative * depth);
    if (apart) worst_.apart_phantom = std::max(worst_.apart_phantom, phantom);
    const double allowed = (apart ? 0.0 : kAllowance + kAllowanceRelative * depth) + rounding_;
    expect(phantom <= allowed, "nearer or deeper than true", phantom);
    expect(missed <= kAllowance + kAllowanceRelative * depth + rounding_, "farther or shallower than true", missed);
    expect(!truth_.beyond || truth - pair_.margin < rounding_, "contact beyond the margin", truth - pair_.margin);
    const double along = static_cast<double>(separation_along(A_, B_, m.n_AB_W));
    worst_.normal = std::max(worst_.normal, std::abs(along - least) - 2.0 * kAllowanceRelative * depth);
    expect(std::abs(along - least) <= 2.0 * (kAllowance + kAllowanceRelative * depth) + rounding_,
           "normal does not realise the depth", along - least);
    // Unit to the rounding of a rotation matrix and one product.
    expect(std::abs(m.n_AB_W.norm() - 1.0) < 1e-13, "normal is not unit", m.n_AB_W.norm() - 1.0);
  }

  void check_points(const Manifold& m) {
    std::set<std::uint32_t> names;
    for (int i = 0; i < m.count; ++i) {
      const ManifoldPoint& point = m.points[static_cast<std::size_t>(i)];
      const double miss = (point.p_WB - point.p_WA - point.phi * m.n_AB_W).norm();
      expect(miss < 1e-14, "points are not phi apart along the normal", miss);
      expect(point.phi <= pair_.margin, "point beyond the margin", point.phi);
      const double on_A = std::abs(static_cast<double>(height_above(A_, point.p_WA)));
      const double on_B = std::abs(static_cast<double>(height_above(B_, point.p_WB)));
      worst_.surface = std::max({worst_.surface, on_A, on_B});
      expect(on_A < kAllowance + rounding_, "point not on A", on_A);
      expect(on_B < kAllowance + rounding_, "point not on B", on_B);
      expect(names.insert(point.feature).second, "two points with one name");
    }
  }

  void check_order(const Manifold& m, const PairCache& cache) {
    PairCache other;
    Manifold r;
    collide(pair_.B, pair_.X_WB, pair_.A, pair_.X_WA, pair_.margin, other, r);
    expect(r.count == m.count, "both orders differ in the number of points");
    if (r.count != m.count || m.count == 0) return;
    const bool same_pose = pair_.X_WA == pair_.X_WB;  // then nothing tells which normal is right
    const double off = same_pose ? 0.0 : (r.n_AB_W + m.n_AB_W).norm();
    worst_.symmetry = std::max(worst_.symmetry, off);
    expect(off == 0.0, "both orders differ in the normal", off);
    for (std::size_t i = 0; i < static_cast<std::size_t>(m.count); ++i) {
      const double phi = std::abs(m.points[i].phi - r.points[i].phi);
      worst_.symmetry = std::max(worst_.symmetry, phi);
      expect(phi == 0.0, "both orders differ in depth", phi);
    }
    static_cast<void>(cache);
  }

  const RandomPair& pair_;
  long long index_;
  FuzzResult& result_;
  Worst& worst_;
  Solid A_;
  Solid B_;
  Truth truth_;
  double rounding_ = kRounding;
};

}  // namespace

FuzzResult run_fuzz(std::uint64_t seed, long long count) {
  FuzzResult result;
  PairCache stale;
  const PairMaker maker(seed);
  for (long long i = 0; i < count; ++i) {
    const Family family = static_cast<Family>(i % kFamilies);
    Rng rng = Rng(seed + static_cast<std::uint64_t>(i));
    RandomPair pair = maker.make(family, rng);
    Checker(pair, i, result).run();
    if (i / kFamilies % 8 != 0) continue;
    // Every eighth: move a little and come with the memory of the pose before.
    PairCache cache;
    Manifold before;
    collide(pair.A, pair.X_WA, pair.B, pair.X_WB, pair.margin, cache, before);
    const double step = std::exp(rng.uniform(std::log(1e-9), std::log(1e-3)));
    pair.X_WB.p += step * Vector3(rng.normal(), rng.normal(), rng.normal());
    pair.X_WB.R = pair.X_WB.R * exp_rotation(step * Vector3(rng.normal(), rng.normal(), rng.normal()));
    Checker(pair, i, result).run_with(cache);
    Checker(pair, i, result).run_with(stale);  // another pair's memory must do no harm
    stale = cache;
  }
  return result;
}

std::string to_text(const FuzzResult& result) {
  std::string text =
      "family            pairs  contacts     apart   corners  phantom    apart ph.  missed     normal     surface\n";
  for (std::size_t f = 0; f < kFamilies; ++f) {
    const Worst& w = result.worst[f];
    char line[240];
    std::snprintf(line, sizeof line, "%-15s %8lld %8lld %9lld %9lld  %9.2e  %9.2e  %9.2e  %9.2e  %9.2e\n", kNames[f],
                  w.pairs, w.contacts, w.apart, w.corners, w.phantom, w.apart_phantom, w.missed, w.normal, w.surface);
    text += line;
  }
  for (const std::string& failure : result.failures) text += failure + "\n";
  return text + std::to_string(result.failure_count) + " failures\n";
}

}  // namespace snug::geometry::test
