// find_edges: where faces end, measured line by line of pixels.
#include <gtest/gtest.h>

#include <cmath>

#include "snug/box_estimation/internal/features.hpp"
#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation::internal {
namespace {

using namespace test;

/// Its top is 0.9 m below the camera: a pixel is 0.9 / fx there.
Box box_of(double width, double yaw = 0.3) { return {"a", Vector3(width, 0.15, 0.10), level(-0.05, -0.10, 0.05, yaw)}; }

std::vector<EdgeFeature> edges_of(const FitScene& scene, const TrackedBox& tracked, const FitStep& step = {}) {
  return find_edges(scene.context(), scene.predict({tracked}), {tracked}, step);
}

/// m, what opposite edges across an axis say together: by how much the box is longer than it should be.
std::optional<double> misfit(const std::vector<EdgeFeature>& edges, int axis) {
  std::optional<double> ends[2];
  for (const EdgeFeature& edge : edges) {
    if (edge.axis == axis && !edge.is_coarse) ends[edge.side] = edge.rows.measured(0);
  }
  if (!ends[0] || !ends[1]) return std::nullopt;
  return *ends[0] + *ends[1];
}

TEST(FindEdges, FourEdgesOfATopFaceAreWhereTheyShouldBe) {
  const FitScene scene({box_of(0.20)});
  const std::vector<EdgeFeature> edges = edges_of(scene, scene.tracked(box_of(0.20)));
  ASSERT_GE(edges.size(), 4u);
  const double pixel = 0.9 / scene.frame.camera.intrinsics.fx;
  for (const EdgeFeature& edge : edges) {
    EXPECT_FALSE(edge.is_coarse);
    EXPECT_NEAR(edge.rows.measured(0), 0.0, 0.35 * pixel) << "evened out over lines that cross the grid";
    EXPECT_NEAR(edge.rows.measured(1), 0.0, 0.004);
    EXPECT_LT(std::abs(edge.rows.measured(0)), 5.0 * std::sqrt(edge.rows.covariance(0, 0)));
  }
}

/// The box is elsewhere in the plane of its top: edges move along their outward directions, opposite ones against each
/// other.
TEST(FindEdges, MeasureAShiftInThePlaneAndNoChangeOfSize) {
  const FitScene scene({box_of(0.20)});
  Rng rng = Rng(5).split("edges");
  for (int i = 0; i < 20; ++i) {
    SCOPED_TRACE(i);
    const Vector3 shift(rng.uniform(-0.004, 0.004), rng.uniform(-0.004, 0.004), 0.0);
    const TrackedBox tracked = scene.tracked(box_of(0.20), shift);
    const Vector6 twist = difference(tracked.X_CP, scene.tracked(box_of(0.20)).X_CP);
    const std::vector<EdgeFeature> edges = edges_of(scene, tracked);
    ASSERT_GE(edges.size(), 4u);
    for (const EdgeFeature& edge : edges) {
      EXPECT_NEAR(edge.rows.measured(0), edge.rows.J.row(0).dot(twist), 0.5e-3);
    }
    for (const int axis : {0, 1}) {
      if (const std::optional<double> off = misfit(edges, axis)) {
        EXPECT_NEAR(*off, 0.0, 0.6e-3);
      }
    }
  }
}

TEST(FindEdges, MeasureATurnInThePlane) {
  const FitScene scene({box_of(0.20)});
  for (const double turn : {-0.02, 0.01, 0.02}) {
    const TrackedBox tracked = scene.tracked(box_of(0.20), Vector3::Zero(), Vector3(0, 0, turn));
    for (const EdgeFeature& edge : edges_of(scene, tracked)) {
      EXPECT_NEAR(edge.rows.measured(1), -turn * edge.rows.J(1, 5), 0.005);
    }
  }
}

TEST(FindEdges, OppositeEdgesTellHowMuchLongerABoxIs) {
  for (const double longer : {-0.006, -0.002, 0.002, 0.006}) {
    const FitScene scene({box_of(0.20 + longer)});
    const std::optional<double> off = misfit(edges_of(scene, scene.tracked(box_of(0.20))), 0);
    ASSERT_TRUE(off.has_value());
    EXPECT_NEAR(*off, longer, 0.6e-3);
    const std::optional<double> other = misfit(edges_of(scene, scene.tracked(box_of(0.20))), 1);
    ASSERT_TRUE(other.has_value());
    EXPECT_NEAR(*other, 0.0, 0.6e-3) << "the other side is as long as it should be";
  }
}

TEST(FindEdges, AnEdgeBeyondTheReachTellsTheDirectionOnly) {
  const FitScene scene({box_of(0.20)});
  FitStep step;
  step.reach = 10;
  const double pixel = 0.9 / scene.frame.camera.intrinsics.fx;
  const Box unturned = box_of(0.20, 0.0);
  const FitScene straight({unturned});
  const TrackedBox tracked = straight.tracked(unturned, Vector3(14.0 * pixel, 0, 0));
  int coarse = 0;
  for (const EdgeFeature& edge : edges_of(straight, tracked, step)) {
    if (!edge.is_coarse) continue;
    ++coarse;
    EXPECT_EQ(edge.rows.count, 1) << "no slope";
    const double expected = edge.rows.J.row(0).dot(difference(tracked.X_CP, straight.tracked(unturned).X_CP));
    EXPECT_GT(edge.rows.measured(0) * expected, 0.0) << "the right way";
    EXPECT_GT(std::sqrt(edge.rows.covariance(0, 0)), pixel);
  }
  EXPECT_GE(coarse, 1);
}

TEST(FindEdges, NeedTheFaceToBeLargeAndSeenFromTheFront) {
  FitScene scene({box_of(0.20)});
  scene.settings.edges.least_pixels_of_face = 1'000'000;
  EXPECT_TRUE(edges_of(scene, scene.tracked(box_of(0.20))).empty());
  scene.settings = {};
  scene.settings.edges.least_facing = 1.1;
  EXPECT_TRUE(edges_of(scene, scene.tracked(box_of(0.20))).empty());
  scene.settings = {};
  FitStep held;
  held.first_box = 1;
  EXPECT_TRUE(edges_of(scene, scene.tracked(box_of(0.20)), held).empty());
}

TEST(FindEdges, AnEdgeAgainstALevelNeighbourIsNone) {
  const Box a = box_of(0.20, 0.0);
  Box b = a;
  b.X_WP.p.x() += 0.20;  // side by side, level
  const FitScene scene({a, b});
  const TrackedBox tracked = scene.tracked(a);
  for (const EdgeFeature& edge : edges_of(scene, tracked)) {
    EXPECT_FALSE(edge.axis == 0 && edge.side == 1 && !edge.is_coarse) << "there is nothing to see between them";
  }
}

TEST(FindEdges, CovariancesArePositiveAndGrowWithTheCamerasErrors) {
  double before = 0.0;
  for (const char* preset : {"ideal", "active_stereo"}) {
    const FitScene scene({box_of(0.20)}, preset);
    double mean = 0.0;
    const std::vector<EdgeFeature> edges = edges_of(scene, scene.tracked(box_of(0.20)));
    ASSERT_FALSE(edges.empty());
    for (const EdgeFeature& edge : edges) {
      EXPECT_GT(edge.rows.covariance(0, 0), 0.0);
      EXPECT_GT(edge.rows.covariance(1, 1), 0.0);
      mean += edge.rows.covariance(0, 0) / static_cast<double>(edges.size());
    }
    EXPECT_GT(mean, before) << preset;
    before = mean;
  }
}

}  // namespace
}  // namespace snug::box_estimation::internal
