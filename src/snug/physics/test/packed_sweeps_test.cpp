// Packed sweeps: rows solved to their laws in double precision, the same bytes by any vectors.
#include "snug/physics/internal/packed_sweeps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "snug/core/rng.hpp"
#include "snug/physics/internal/contact_system.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kBodies = 60;

/// Contacts between drawn pairs of bodies, 1 to 6 a pair, some of them with what does not move. Linear velocities enter
/// all contacts of a pair along the same axes, or each of them its own way.
struct Problem {
  bool has_own_axes = false;
  std::vector<Row> rows;
  std::vector<RowPatch> patches;
  std::vector<int> bodies = std::vector<int>(kBodies);
  std::vector<double> u_free = std::vector<double>(6 * kBodies);

  void add_patch(int ia, int ib, int count, Rng& rng) {
    RowPatch patch;
    patch.first = static_cast<int>(rows.size()), patch.count = count;
    patch.ia = ia, patch.ib = ib;
    for (int i = 0; i < count; ++i) {
      Row row{};
      row.ia = ia, row.ib = ib;
      row.mu = 0.2;
      row.kind = RowKind::Contact;
      for (int axis = 0; axis < 3; ++axis) {
        row.j[axis][axis] = -1.5, row.j[axis][6 + axis] = 1.0;
        for (const int turning : {3, 4, 5, 9, 10, 11}) row.j[axis][turning] = rng.uniform(-1.0, 1.0);
        if (!has_own_axes) continue;
        for (const int linear : {0, 1, 2, 6, 7, 8}) row.j[axis][linear] += rng.uniform(-0.3, 0.3);
      }
      finish_row(row);
      rows.push_back(row);
    }
    patches.push_back(patch);
  }

  /// A row of bodies.
  [[nodiscard]] static std::vector<Vector3> centres() {
    std::vector<Vector3> centres;
    for (int body = 0; body < kBodies; ++body) centres.emplace_back(body, 0.0, 0.0);
    return centres;
  }

  /// Velocities with the impulses of the rows.
  [[nodiscard]] std::vector<double> velocities() const {
    std::vector<double> u = u_free;
    for (const Row& row : rows) apply(row, row.lambda, u.data());
    return u;
  }

  [[nodiscard]] double residual() const {
    return worst_residual(rows.data(), rows.data() + rows.size(), velocities().data());
  }
};

Problem drawn_problem(bool has_own_axes = false) {
  Problem problem;
  problem.has_own_axes = has_own_axes;
  Rng rng = Rng(4).split("packed sweeps");
  std::iota(problem.bodies.begin(), problem.bodies.end(), 0);
  for (double& u : problem.u_free) u = rng.uniform(-1.0, 1.0);
  for (int body = 0; body < kBodies; ++body) {
    const int other = body - 1 - static_cast<int>(rng.uniform(0.0, 5.0));
    problem.add_patch(std::max(other, -1), body, 1 + body % 6, rng);
  }
  return problem;
}

class PackedSweepsOf : public testing::TestWithParam<bool> {};

TEST_P(PackedSweepsOf, RowsSolveThemToTheirLaws) {
  Problem problem = drawn_problem(GetParam());
  ASSERT_GT(problem.residual(), 0.1);
  PackedSweeps sweeps(kBodies, problem.rows.size());
  ASSERT_TRUE(sweeps.pack(problem.rows.data(), problem.patches, problem.bodies));
  const int count = sweeps.run(problem.rows.data(), problem.velocities().data(), {1000, 0.9, 1e-5, 0.0});
  EXPECT_LT(count, 1000);
  EXPECT_LE(problem.residual(), 1e-5);
}

TEST_P(PackedSweepsOf, RowsGiveTheSameBytesByVectorsOfAnyWidth) {
  std::vector<Problem> problems;
  std::vector<int> counts;
  for (const int width : {4, 8, 16}) {
    Problem& problem = problems.emplace_back(drawn_problem(GetParam()));
    PackedSweeps sweeps(kBodies, problem.rows.size());
    ASSERT_TRUE(sweeps.pack(problem.rows.data(), problem.patches, problem.bodies));
    counts.push_back(sweeps.run(problem.rows.data(), problem.velocities().data(), {1000, 0.95, 1e-5, 0.0, width}));
  }
  for (const std::size_t k : {1U, 2U}) {
    EXPECT_EQ(counts[0], counts[k]);
    for (std::size_t i = 0; i < problems[0].rows.size(); ++i) {
      const double *one = problems[0].rows[i].lambda, *other = problems[k].rows[i].lambda;
      EXPECT_TRUE(std::equal(one, one + 3, other)) << i;
    }
  }
}

/// Up to the rounding of single precision, as often as a sweep changes a velocity.
TEST_P(PackedSweepsOf, RowsChangeVelocitiesAsTheirImpulsesDo) {
  for (const bool is_cut : {false, true}) {
    Problem problem = drawn_problem(GetParam());
    const std::vector<Vector3> centres = Problem::centres();
    PackedSweeps sweeps(kBodies, problem.rows.size());
    ASSERT_TRUE(sweeps.pack(problem.rows.data(), problem.patches, problem.bodies, is_cut ? centres.data() : nullptr));
    std::vector<double> u = problem.velocities();
    const std::vector<double> before = u;
    (void)sweeps.run(problem.rows.data(), u.data(), {12, 0.9, 1e-5, 0.0});
    sweeps.add_change(problem.bodies, u.data());
    const std::vector<double> after = problem.velocities();
    double changed = 0.0, missed = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      changed = std::max(changed, std::abs(after[i] - before[i]));
      missed = std::max(missed, std::abs(after[i] - u[i]));
    }
    EXPECT_GT(changed, 0.1);
    EXPECT_LT(missed, 1e-5);
  }
}

INSTANTIATE_TEST_SUITE_P(SharedAndOwnAxes, PackedSweepsOf, testing::Bool(),
                         [](const auto& kind) { return kind.param ? "OwnAxes" : "SharedAxes"; });

TEST(PackedSweeps, GiveTheSameBytesInHalvesByOneThreadAndByTwo) {
  std::vector<Problem> problems;
  for (const int threads : {1, 2}) {
    problems.push_back(drawn_problem());
    Problem& problem = problems.back();
    WorkerPool pool(threads);
    PackedSweeps sweeps(kBodies, problem.rows.size());
    ASSERT_TRUE(sweeps.pack(problem.rows.data(), problem.patches, problem.bodies, problem.centres().data(), &pool));
    const auto u = problem.velocities();
    EXPECT_LT(sweeps.run(problem.rows.data(), u.data(), {1000, 0.9, 1e-5, 0.0}, threads > 1 ? &pool : nullptr), 1000);
    EXPECT_LE(problem.residual(), 1e-5);
  }
  for (std::size_t i = 0; i < problems[0].rows.size(); ++i) {
    const double *one = problems[0].rows[i].lambda, *two = problems[1].rows[i].lambda;
    EXPECT_TRUE(std::equal(one, one + 3, two)) << i;
  }
}

TEST(PackedSweeps, ThatAreCalmHaveLittleMomentum) {
  const auto impulses_after = [](double momentum, int calm) {
    Problem problem = drawn_problem();
    PackedSweeps sweeps(kBodies, problem.rows.size());
    EXPECT_TRUE(sweeps.pack(problem.rows.data(), problem.patches, problem.bodies));
    (void)sweeps.run(problem.rows.data(), problem.velocities().data(), {40, momentum, 1e-9, 0.0, kLanes, calm});
    std::vector<double> impulses;
    for (const Row& row : problem.rows) impulses.insert(impulses.end(), row.lambda, row.lambda + 3);
    return impulses;
  };
  EXPECT_EQ(impulses_after(0.95, 40), impulses_after(0.8, 0));
  EXPECT_NE(impulses_after(0.95, 10), impulses_after(0.95, 0));
  EXPECT_NE(impulses_after(0.95, 10), impulses_after(0.8, 0));
}

TEST(PackedSweeps, RefuseWhatHangsOnOneBody) {
  Problem problem;
  Rng rng = Rng(4).split("star");
  std::iota(problem.bodies.begin(), problem.bodies.end(), 0);
  for (int body = 1; body < kBodies; ++body) problem.add_patch(0, body, 4, rng);
  PackedSweeps sweeps(kBodies, problem.rows.size());
  EXPECT_FALSE(sweeps.pack(problem.rows.data(), problem.patches, problem.bodies));
}

}  // namespace
}  // namespace snug::physics::internal
