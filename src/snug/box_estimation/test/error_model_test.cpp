// ErrorModel: closed forms of what a camera states.
#include "snug/box_estimation/internal/error_model.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "snug/core/rng.hpp"

namespace snug::box_estimation::internal {
namespace {

model::CameraParams silent_camera() {
  model::CameraParams camera = model::make_camera("ideal");
  camera.range.focus = 1.0;
  return camera;
}

TEST(ErrorModel, NoiseGrowsWithTheSquareOfTheDistance) {
  model::CameraParams camera = silent_camera();
  camera.errors.noise.precision = 2e-4;
  const ErrorModel errors(camera);
  EXPECT_DOUBLE_EQ(errors.point_noise(1.0), 2e-4);
  for (const double depth : {0.3, 0.7, 1.6})
    EXPECT_NEAR(errors.point_noise(2.0 * depth), 4.0 * errors.point_noise(depth), 1e-12);
}

TEST(ErrorModel, NoiseAndWavesAddUpByTheirSquares) {
  model::CameraParams camera = silent_camera();
  camera.errors.noise.precision = 3e-4;
  camera.errors.planarity.local = 4e-4;
  camera.errors.planarity.global = 12e-4;
  EXPECT_NEAR(ErrorModel(camera).point_error(1.0), 13e-4, 1e-12);
}

/// Independent points: 1. Points that are alike over s pixels: the mean of many has the variance of one in 4 pi s^2,
/// the area under the correlation, exp(-d^2 / (4 s^2)).
TEST(ErrorModel, LikenessIsTheAreaUnderTheCorrelation) {
  model::CameraParams camera = silent_camera();
  camera.errors.noise.correlation = 0.0;
  EXPECT_EQ(ErrorModel(camera).likeness(), 1.0);
  for (const double s : {1.0, 2.0, 3.5}) {
    camera.errors.noise.correlation = s;
    EXPECT_NEAR(ErrorModel(camera).likeness() / (4.0 * std::numbers::pi * s * s), 1.0, 1e-3) << s;
  }
}

TEST(ErrorModel, WavesAreAlikeNearbyAndIndependentFarAway) {
  model::CameraParams camera = silent_camera();
  camera.errors.planarity.local = 1e-4;
  camera.errors.planarity.global = 3e-4;
  camera.errors.planarity.local_length = 20.0;
  camera.errors.planarity.global_length = 200.0;
  const ErrorModel errors(camera);
  EXPECT_NEAR(errors.wave_covariance(0.0, 0.0), 1e-8 + 9e-8, 1e-15);
  double before = errors.wave_covariance(0.0, 0.0);
  for (double d = 5.0; d < 2000.0; d *= 1.5) {
    const double now = errors.wave_covariance(d, 0.0);
    EXPECT_LT(now, before);
    EXPECT_NEAR(errors.wave_covariance(0.0, -d), now, 1e-20) << "the same along every direction";
    EXPECT_NEAR(errors.wave_covariance(0.6 * d, 0.8 * d), now, 1e-15);
    before = now;
  }
  EXPECT_LT(before, 1e-12);
}

TEST(ErrorModel, MixedPixelsMoveEdgesByTheirProbability) {
  model::CameraParams camera = silent_camera();
  camera.errors.loss = {};
  camera.errors.loss.edge = 0.0;
  for (const double p : {0.0, 0.25, 0.5, 1.0}) {
    camera.errors.mixed_pixels.probability = p;
    EXPECT_NEAR(ErrorModel(camera).edge_shift(), p, 1e-12);
  }
}

TEST(ErrorModel, CommonErrorIsThatOfACameraThatIsElsewhere) {
  model::CameraParams camera = silent_camera();
  camera.errors.hand_eye = {};
  camera.errors.hand_eye.rotation = 3e-4;
  camera.errors.hand_eye.position = 3e-4;
  camera.errors.trueness.position = 4e-4;
  camera.errors.trueness.dimension = 2e-3;
  const ErrorModel errors(camera);
  Rng rng = Rng(1).split("common error");
  for (int i = 0; i < 100; ++i) {
    const Vector3 p(rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4), rng.uniform(0.5, 1.5));
    const camera::CommonError error = errors.common_error(p);
    for (int k = 0; k < 3; ++k) {
      const Vector3 axis = Vector3::Unit(k);
      EXPECT_LT((error.col(k).head<3>() - 3e-4 * axis.cross(p)).norm(), 1e-15) << "a turn about its own axes";
      EXPECT_LT((error.col(k).tail<3>() - 3e-4 * axis).norm(), 1e-15);
      EXPECT_LT((error.col(3 + k).head<3>() - 5e-4 * axis).norm(), 1e-15) << "hypot(3, 4) = 5";
      EXPECT_EQ(error.col(3 + k).tail<3>().norm(), 0.0);
    }
    EXPECT_EQ(error.col(6).tail<3>().norm(), 0.0);
  }
  EXPECT_EQ(errors.common_error(Vector3(0, 0, 1.0)).col(6).norm(), 0.0) << "lengths grow about the focus";
  const Vector3 a(0.1, 0.2, 0.9), b(-0.2, 0.3, 1.1);
  const Vector3 apart = (errors.common_error(a) - errors.common_error(b)).col(6).head<3>();
  EXPECT_NEAR(apart.norm(), errors.length_error((a - b).norm()), 1e-15);
}

}  // namespace
}  // namespace snug::box_estimation::internal
