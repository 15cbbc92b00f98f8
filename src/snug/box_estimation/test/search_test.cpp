// propose_poses and what it is made of: patches that nothing explains, gaps between solids.
#include "snug/box_estimation/internal/search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation::internal {
namespace {

using namespace test;

const Vector3 kSize(0.18, 0.12, 0.08);

TEST(Unexplained, IsNothingWhereAllIsExpectedAndEveryPointOfAStranger) {
  const Box box{"a", kSize, level(0.05, -0.10, 0.04, 0.5)};
  const FitScene scene({box});
  const auto count = [](const camera::Grid2<std::uint8_t>& mask) {
    return std::count(mask.values().begin(), mask.values().end(), std::uint8_t{1});
  };
  EXPECT_EQ(count(unexplained(scene.frame, scene.predict({scene.tracked(box)}), 2e-3)), 0);
  const Agreement a = compare(scene.frame, scene.predict({scene.tracked(box)}), {1e-3}).front();
  EXPECT_NEAR(static_cast<double>(count(unexplained(scene.frame, scene.predict({}), 2e-3))), a.pixels, 0.03 * a.pixels);
  // Behind what is predicted is not before it: a box that is expected and not there explains nothing and hides nothing.
  Box absent = box;
  absent.X_WP.p.z() += 0.05;
  EXPECT_EQ(count(unexplained(scene.frame, scene.predict({scene.tracked(absent)}), 2e-3)),
            count(unexplained(scene.frame, scene.predict({scene.tracked(absent)}), 2e-3)));
}

TEST(LeastGap, IsTheDistanceToTheNearestSolidUpToTouch) {
  Rng rng = Rng(7).split("least gap");
  const double touch = 0.006;
  for (const double gap : {-0.004, -0.001, 0.0, 0.002, 0.005}) {
    for (int i = 0; i < 20; ++i) {
      const Pose X{exp_rotation(normals(rng, 1.0)), normals(rng, 0.5)};
      const Vector3 half(0.05, 0.04, 0.03);
      const std::vector<camera::SceneShape> solids = {
          {geometry::Box{Vector3(0.3, 0.3, 0.05)}, X * level(0, 0, -0.05), 0},
          {geometry::Box{Vector3(0.05, 0.05, 0.05)}, X * level(2.0, 0, 0), 0}};
      EXPECT_NEAR(least_gap(half, X * level(0.01, 0.02, 0.03 + gap), solids, touch), gap, 1e-9);
    }
  }
  EXPECT_EQ(least_gap(Vector3(0.05, 0.05, 0.05), level(0, 0, 1.0), {}, touch), touch) << "nothing is near";
}

/// A box that may be anywhere: some proposed pose is where it is, to the millimetres that a fit takes in.
TEST(ProposePoses, OneIsWhereTheBoxIs) {
  Rng rng = Rng(8).split("propose");
  for (int i = 0; i < 8; ++i) {
    SCOPED_TRACE(i);
    const Box box{"a", kSize, level(rng.uniform(-0.08, 0.08), rng.uniform(-0.15, 0.15), 0.04, rng.uniform(-1.5, 1.5))};
    const FitScene scene({box}, "structured_light", static_cast<std::uint64_t>(i + 1));
    const EstimateInput input = make_input(scene.cell.scenario, scene.cell.scenario.containers.front());
    const std::vector<TrackedBox> none;
    const Known known{scene.context(), input, none, 4e-3};
    const Pose X_CP = scene.tracked(box).X_CP;
    const Wanted wanted{0.5 * kSize, scene.cell.camera.X_WC.inverse() * level(0.1, 0.2, 0.04)};
    const std::vector<Pose> poses = propose_poses(known, scene.predict({}), {wanted}, scene.surroundings_C.shapes)[0];
    ASSERT_FALSE(poses.empty());
    EXPECT_LE(poses.size(), static_cast<std::size_t>(scene.settings.search.most_poses));
    const auto is_near = [&](const Pose& X) {
      return (X.p - X_CP.p).norm() < 0.010 && angle_between(nearest_equal_rotation(X.R, X_CP.R), X_CP.R) < 0.1;
    };
    EXPECT_TRUE(std::ranges::any_of(poses, is_near));
    EXPECT_TRUE(is_near(poses.front())) << "the likeliest first";
    for (std::size_t a = 0; a < poses.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        const bool is_same =
            (poses[a].p - poses[b].p).norm() < scene.settings.search.same_place &&
            angle_between(nearest_equal_rotation(poses[a].R, poses[b].R), poses[b].R) < scene.settings.search.same_turn;
        EXPECT_FALSE(is_same) << "none twice";
      }
    }
  }
}

TEST(ProposePoses, NoneForABoxThatIsTooLargeOrAFrameThatIsExplained) {
  const Box box{"a", kSize, level(0.0, 0.0, 0.04, 0.4)};
  const FitScene scene({box});
  const EstimateInput input = make_input(scene.cell.scenario, scene.cell.scenario.containers.front());
  const std::vector<TrackedBox> none;
  const Known known{scene.context(), input, none, 2.5e-3};
  const Wanted small{Vector3(0.03, 0.03, 0.03), scene.tracked(box).X_CP};
  EXPECT_TRUE(propose_poses(known, scene.predict({}), {small}, {})[0].empty())
      << "its faces are smaller than the patch";
  const Wanted own{0.5 * kSize, scene.tracked(box).X_CP};
  EXPECT_TRUE(propose_poses(known, scene.predict({scene.tracked(box)}), {own}, {})[0].empty()) << "nothing to explain";
}

TEST(ProposePoses, ALimitOfPosesIsKept) {
  const Box box{"a", kSize, level(0.0, 0.0, 0.04, 0.4)};
  FitScene scene({box});
  scene.settings.search.most_poses = 2;
  const EstimateInput input = make_input(scene.cell.scenario, scene.cell.scenario.containers.front());
  const std::vector<TrackedBox> none;
  const Known known{scene.context(), input, none, 2.5e-3};
  const Wanted larger{0.5 * Vector3(0.25, 0.20, 0.08), scene.tracked(box).X_CP};  // the patch may be any of its corners
  EXPECT_LE(propose_poses(known, scene.predict({}), {larger}, {})[0].size(), 2u);
}

}  // namespace
}  // namespace snug::box_estimation::internal
