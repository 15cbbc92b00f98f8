// View: what should be seen, counted, and compared with what is.
#include "snug/box_estimation/internal/view.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation::internal {
namespace {

using namespace test;

const Box kSeenBox{"a", Vector3(0.20, 0.15, 0.10), level(-0.05, -0.10, 0.05, 0.3)};

TEST(PixelRange, HoldsEveryPointOfTheBox) {
  const Cell cell;
  Rng rng = Rng(1).split("pixel range");
  for (int i = 0; i < 200; ++i) {
    const Vector3 low(rng.uniform(-0.4, 0.2), rng.uniform(-0.4, 0.2), rng.uniform(-0.1, 0.3));
    const Vector3 high = low + Vector3(rng.uniform(0.0, 0.3), rng.uniform(0.0, 0.3), rng.uniform(0.0, 0.3));
    const PixelRange range = pixel_range(cell.camera, low, high);
    for (int k = 0; k < 50; ++k) {
      const Vector3 p_W = low + Vector3(rng.uniform(), rng.uniform(), rng.uniform()).cwiseProduct(high - low);
      const Eigen::Vector2d pixel = camera::project(cell.camera.intrinsics, cell.camera.X_WC.inverse() * p_W);
      if (pixel.x() < 0.0 || pixel.y() < 0.0 || pixel.x() >= cell.camera.width || pixel.y() >= cell.camera.height)
        continue;
      EXPECT_LE(range.first_col, pixel.x());
      EXPECT_GE(range.end_col, pixel.x());
      EXPECT_LE(range.first_row, pixel.y());
      EXPECT_GE(range.end_row, pixel.y());
    }
  }
}

TEST(PixelRange, IsThePictureForWhatReachesBehindTheCameraAndEmptyBesideIt) {
  const Cell cell;
  const PixelRange all = pixel_range(cell.camera, Vector3(-0.1, -0.1, 0.0), Vector3(0.1, 0.1, 2.0));
  EXPECT_EQ(all.rows(), cell.camera.height);
  EXPECT_EQ(all.cols(), cell.camera.width);
  const PixelRange beside = pixel_range(cell.camera, Vector3(50.0, 50.0, 0.0), Vector3(51.0, 51.0, 0.1));
  EXPECT_EQ(beside.rows() * beside.cols(), 0);
}

TEST(PixelsAround, IsTheBoxWithItsBorderWithinTheRange) {
  const FitScene scene({kSeenBox});
  const TrackedBox box = scene.tracked(kSeenBox);
  const PixelRange tight = pixels_around(scene.frame, scene.range, box, 0);
  const PixelRange wide = pixels_around(scene.frame, scene.range, box, 20);
  EXPECT_EQ(wide.rows(), tight.rows() + 40);
  EXPECT_EQ(wide.cols(), tight.cols() + 40);
  const PixelRange clipped = pixels_around(scene.frame, scene.range, box, 5000);
  EXPECT_EQ(clipped.rows(), scene.range.rows());
  EXPECT_EQ(clipped.cols(), scene.range.cols());
}

/// A level face straight below is seen on fx fy A / z^2 pixels; its rim of two pixels is rounded.
TEST(Predict, ATopFaceHasAsManyPixelsAsItsAreaSays) {
  const FitScene scene({kSeenBox});
  Box below = kSeenBox;
  below.X_WP = level(0.0, 0.0, 0.05);
  const Prediction prediction = scene.predict({scene.tracked(below)});
  int pixels = 0;
  for (const std::int32_t s : prediction.cast.surface.values()) {
    pixels += s >= 0 && prediction.cast.surfaces[static_cast<std::size_t>(s)].body >= prediction.first_box ? 1 : 0;
  }
  const double fx = scene.frame.camera.intrinsics.fx, fy = scene.frame.camera.intrinsics.fy, z = 0.9;
  const double width = fy * 0.20 / z, height = fx * 0.15 / z;
  EXPECT_NEAR(pixels, width * height, 2.0 * (width + height));
}

TEST(Compare, FindsEveryPointOfAPerfectFrameOnItsBox) {
  const FitScene scene({kSeenBox});
  const Agreement a = compare(scene.frame, scene.predict({scene.tracked(kSeenBox)}), {1e-3}).front();
  EXPECT_GT(a.pixels, 10'000);
  EXPECT_EQ(a.on, a.pixels);
  EXPECT_EQ(a.nearer + a.farther + a.missing, 0);
  EXPECT_EQ(a.part_on(), 1.0);
  EXPECT_LT(std::sqrt(a.squares / a.on), 1e-6) << "single precision";
}

TEST(Compare, SeesThroughABoxThatIsHigherThanItIs) {
  const FitScene scene({kSeenBox});
  for (const double dz : {-0.010, 0.010}) {  // along the optical axis: negative is up
    const Agreement a =
        compare(scene.frame, scene.predict({scene.tracked(kSeenBox, Vector3(0, 0, dz))}), {4e-3}).front();
    EXPECT_LT(a.on, 0.05 * a.pixels) << "sides alone";
    EXPECT_GT(dz < 0.0 ? a.farther : a.nearer, 0.9 * a.pixels);
    const Agreement within =
        compare(scene.frame, scene.predict({scene.tracked(kSeenBox, Vector3(0, 0, dz))}), {11e-3}).front();
    EXPECT_GT(within.on, 0.9 * within.pixels);
    EXPECT_NEAR(std::sqrt(within.squares / within.on), 0.010, 1e-3);
  }
}

TEST(Compare, CountsWhatHasNoPoint) {
  FitScene scene({kSeenBox});
  for (float& depth : scene.frame.depth.values()) depth = 0.0F;
  const Agreement a = compare(scene.frame, scene.predict({scene.tracked(kSeenBox)}), {1e-3}).front();
  EXPECT_EQ(a.missing, a.pixels);
  EXPECT_EQ(a.part_on(), 0.0) << "nothing tells that it is there";
}

TEST(Overlap, IsTheDepthAlongTheShallowestAxisInAnyFrame) {
  Rng rng = Rng(2).split("overlap");
  for (int i = 0; i < 100; ++i) {
    const double deep = rng.uniform(0.0, 0.02);
    TrackedBox a, b;
    a.half = Vector3(0.05, 0.04, 0.03);
    b.half = Vector3(0.06, 0.05, 0.04);
    b.X_CP.p = Vector3(0.11 - deep, 0.01, -0.005);
    const Pose X{exp_rotation(normals(rng, 1.0)), normals(rng, 1.0)};
    a.X_CP = X * a.X_CP;
    b.X_CP = X * b.X_CP;
    EXPECT_NEAR(overlap(a, b), deep, 1e-9);
    EXPECT_NEAR(overlap(b, a), deep, 1e-9);
    b.X_CP.p += X.R * Vector3(deep + 0.001, 0, 0);
    EXPECT_EQ(overlap(a, b), 0.0);
  }
}

TEST(DistanceOutward, IsHowFarAPointIsBeforeTheFace) {
  const FitScene scene({kSeenBox});
  const Prediction prediction = scene.predict({scene.tracked(kSeenBox)});
  const Eigen::Vector2d pixel = camera::project(scene.frame.camera.intrinsics, scene.tracked(kSeenBox).X_CP.p);
  const int r = static_cast<int>(pixel.y()), c = static_cast<int>(pixel.x());
  const std::int32_t s = prediction.cast.surface(r, c);
  ASSERT_GE(s, 0);
  const double depth = 1.0 / prediction.cast.inverse_depth(r, c);
  EXPECT_NEAR(depth, 0.9, 1e-5) << "the top";
  for (const double before : {-0.02, 0.0, 0.005, 0.1}) {
    EXPECT_NEAR(distance_outward(prediction, s, r, c, depth - before), before, 1e-6);
  }
}

TEST(Disagreeing, CountsThePixelsOfABoxThatIsNotExpected) {
  const FitScene scene({kSeenBox});
  EXPECT_EQ(disagreeing(scene.frame, scene.predict({scene.tracked(kSeenBox)}), scene.range, 1e-3), 0);
  const Agreement a = compare(scene.frame, scene.predict({scene.tracked(kSeenBox)}), {1e-3}).front();
  const int without = disagreeing(scene.frame, scene.predict({}), scene.range, 1e-3);
  EXPECT_NEAR(without, a.pixels, 0.02 * a.pixels) << "lower ends of its sides touch the floor";
}

}  // namespace
}  // namespace snug::box_estimation::internal
