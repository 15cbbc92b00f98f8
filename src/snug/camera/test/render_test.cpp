// render: the frames' errors are those that the camera states, each in closed form.
#include "snug/camera/render.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "snug/camera/loss.hpp"
#include "snug/camera/truth_text.hpp"

namespace snug::camera {
namespace {

/// Looks along +z at a wall at its focus, 0.9 m away.
model::CameraParams ideal_camera() {
  model::CameraParams camera = model::make_camera("ideal");
  camera.name = "test";
  camera.width = 400;
  camera.height = 300;
  camera.intrinsics = {400.0, 400.0, 199.5, 149.5};
  return camera;
}

Scene wall(double z) {
  Scene scene;
  add_box(scene, "wall", {Matrix3::Identity(), Vector3(0, 0, z + 0.05)}, Vector3(10, 10, 0.1));
  return scene;
}

struct Moments {
  double mean = 0.0, deviation = 0.0, next = 0.0;  ///< `next`: correlation of neighbours along a row
};

Moments moments(const RenderedFrame& shot) {
  const Grid2<float>&z = shot.frame.depth, &truth = shot.truth.depth;
  double sum = 0.0, squares = 0.0, products = 0.0;
  int count = 0, pairs = 0;
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.cols(); ++c) {
      if (z(r, c) == 0.0F) continue;
      const double e = static_cast<double>(z(r, c)) - truth(r, c);
      sum += e;
      squares += e * e;
      ++count;
      if (c + 1 >= z.cols() || z(r, c + 1) == 0.0F) continue;
      products += e * (static_cast<double>(z(r, c + 1)) - truth(r, c + 1));
      ++pairs;
    }
  return {sum / count, std::sqrt(squares / count), products / pairs / (squares / count)};
}

TEST(Render, WithoutErrorsIsTheTruth) {
  Scene scene = wall(0.9);
  add_box(scene, "box", {exp_rotation(Vector3(0.3, 0.2, 0.1)), Vector3(0, 0, 0.7)}, Vector3(0.2, 0.1, 0.1));
  const RenderedFrame shot = render(scene, ideal_camera(), CameraDraw{}, 1);
  EXPECT_EQ(shot.frame.depth, shot.truth.depth);
  EXPECT_EQ(shot.truth.label(0, 0), 0);
  EXPECT_EQ(shot.truth.label(150, 200), 1);
  EXPECT_GT(shot.frame.intensity(150, 200), 0);
}

TEST(Render, PointNoiseHasTheStatedPrecisionAndCorrelation) {
  for (const double correlation : {0.0, 0.6, 1.5}) {
    SCOPED_TRACE(correlation);
    model::CameraParams camera = ideal_camera();
    camera.errors.noise = {1e-3, correlation};
    const Moments near = moments(render(wall(0.9), camera, {}, 7)), far = moments(render(wall(1.35), camera, {}, 7));
    // 120 000 points, some twenty of them alike at most: 1 / sqrt(2 * 6000) = 0.9 % of a standard deviation; 3.5 of
    // these.
    EXPECT_NEAR(near.deviation, 1e-3, 0.032e-3);
    EXPECT_NEAR(far.deviation, 1e-3 * 1.5 * 1.5, 0.075e-3);
    // A Gaussian at whole pixels against itself one pixel on.
    double same = 0.0, shifted = 0.0;
    const auto weight = [&](int i) {
      return correlation > 0.0 ? std::exp(-0.5 * i * i / (correlation * correlation)) : i == 0 ? 1.0 : 0.0;
    };
    for (int i = -20; i <= 20; ++i) {
      same += weight(i) * weight(i);
      shifted += weight(i) * weight(i + 1);
    }
    const double expected = shifted / same;
    EXPECT_NEAR(near.next, expected, 0.02);
  }
}

TEST(Render, WavesHaveTheStatedSizeAndOnlyLocalOnesChange) {
  model::CameraParams camera = ideal_camera();
  camera.errors.planarity = {1e-3, 4.0, 0.0, 180.0};
  const RenderedFrame one = render(wall(0.9), camera, {}, 1), two = render(wall(0.9), camera, {}, 2);
  // 75 x 100 knots.
  EXPECT_NEAR(moments(one).deviation, 1e-3, 0.03e-3);
  EXPECT_NE(one.frame.depth, two.frame.depth);
  camera.errors.planarity = {0.0, 12.0, 1e-3, 100.0};
  double squares = 0.0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    CameraDraw draw;
    draw.wave_seed = seed;
    const RenderedFrame first = render(wall(0.9), camera, draw, 1);
    squares += std::pow(moments(first).deviation, 2) / 60.0;
    if (seed == 0) {
      EXPECT_EQ(first.frame.depth, render(wall(0.9), camera, draw, 2).frame.depth);
    }
  }
  // 60 cameras with some twelve independent values each: 2.6 % standard error.
  EXPECT_NEAR(std::sqrt(squares), 1e-3, 0.09e-3);
}

TEST(Render, DimensionTruenessScalesLengthsAboutTheFocus) {
  model::CameraParams camera = ideal_camera();
  CameraDraw draw;
  draw.scale = 0.01;
  EXPECT_NEAR(moments(render(wall(0.9), camera, draw, 1)).mean, 0.0, 1e-6);
  EXPECT_NEAR(moments(render(wall(1.1), camera, draw, 1)).mean, 0.01 * 0.2, 1e-6);
  // A plate of 200 mm is seen 202 mm wide.
  Scene scene = wall(1.2);
  add_box(scene, "plate", {Matrix3::Identity(), Vector3(0, 0, 0.9005)}, Vector3(0.2, 0.2, 0.001));
  const auto width = [&](double scale) {
    draw.scale = scale;
    const RenderedFrame shot = render(scene, camera, draw, 1);
    int count = 0;
    for (int c = 0; c < camera.width; ++c) count += shot.truth.label(150, c) == 1 ? 1 : 0;
    return count * 0.9 / camera.intrinsics.fx;
  };
  EXPECT_NEAR(width(0.0), 0.2, 0.9 / 400);
  EXPECT_NEAR(width(0.05), 0.21, 0.9 / 400);
}

TEST(Render, CameraIsDrawnFromHandEyeAndTruenessAndKeepsItsDraw) {
  model::CameraParams camera = ideal_camera();
  camera.errors.hand_eye = {0.3e-3, 1e-3};
  camera.errors.trueness = {2e-3, 0.4e-3};
  double shift = 0.0, turn = 0.0, scale = 0.0;
  constexpr int kCameras = 2000;
  for (std::uint64_t seed = 0; seed < kCameras; ++seed) {
    const CameraDraw draw = draw_camera(camera, seed);
    shift += draw.X_CD.p.squaredNorm() / (3.0 * kCameras);
    turn += log_rotation(draw.X_CD.R).squaredNorm() / (3.0 * kCameras);
    scale += draw.scale * draw.scale / kCameras;
  }
  // 6000 and 2000 draws: 0.9 and 1.6 % of a standard deviation.
  EXPECT_NEAR(std::sqrt(shift), 0.5e-3, 0.02e-3);
  EXPECT_NEAR(std::sqrt(turn), 1e-3, 0.04e-3);
  EXPECT_NEAR(std::sqrt(scale), 2e-3, 0.11e-3);
  EXPECT_EQ(draw_camera(camera, 5).X_CD, draw_camera(camera, 5).X_CD);
  EXPECT_EQ(render(wall(0.9), camera, draw_camera(camera, 5), 3).truth.X_WC, draw_camera(camera, 5).X_CD);
}

TEST(Render, LosesPointsAtEdgesGrazingFacesAndAtRandom) {
  model::CameraParams camera = ideal_camera();
  camera.errors.loss.random = 0.1;
  const auto part_lost = [](const RenderedFrame& shot, int first_col, int end_col, int first_row, int end_row) {
    int lost = 0, count = 0;
    for (int r = first_row; r < end_row; ++r)
      for (int c = first_col; c < end_col; ++c, ++count) lost += shot.frame.depth(r, c) == 0.0F ? 1 : 0;
    return static_cast<double>(lost) / count;
  };
  EXPECT_NEAR(part_lost(render(wall(0.9), camera, {}, 1), 0, 400, 0, 300), 0.1, 0.004);  // 4 standard errors
  camera.errors.loss.random = 0.0;
  camera.errors.loss.edge = 0.8;
  camera.errors.loss.edge_width = 1.5;
  // The left half of the picture 0.2 m nearer: an edge of depth between columns 199 and 200.
  Scene scene = wall(0.9);
  add_box(scene, "near", {Matrix3::Identity(), Vector3(-1.0, 0, 0.75)}, Vector3(2.0, 10, 0.1));
  double lost[3] = {};
  for (std::uint64_t i = 0; i < 20; ++i) {
    const RenderedFrame shot = render(scene, camera, {}, i);
    for (int d = 0; d < 3; ++d) lost[d] += part_lost(shot, 200 + d, 201 + d, 0, 300) / 20.0;
  }
  const std::vector<float> stated = edge_loss(camera.errors.loss);
  EXPECT_NEAR(stated[0], 0.8 * std::exp(-std::pow(0.5 / 1.5, 2)), 1e-6);
  for (int d = 0; d < 3; ++d)
    EXPECT_NEAR(lost[d], stated[static_cast<std::size_t>(d)], 0.026);  // 4 standard errors of 6000
  camera = ideal_camera();
  camera.errors.loss.grazing_onset = 1.0;
  camera.errors.loss.grazing_full = 1.2;
  Scene floor;  // seen flatter and flatter: tan of the angle to its normal is (f / row offset)
  add_box(floor, "floor", {Matrix3::Identity(), Vector3(0, 0.15, 0.9)}, Vector3(1, 0.1, 1.2));
  const RenderedFrame shot = render(floor, camera, {}, 1);
  int rows = 0;
  for (int r = 190; r < 300; ++r) {
    if (shot.truth.depth(r, 200) < 0.35F) continue;
    const double angle = std::atan2(400.0, r - 149.5);
    if (angle > 1.2) {
      EXPECT_EQ(shot.frame.depth(r, 200), 0.0F);
    }
    ++rows;
  }
  EXPECT_GT(rows, 20);
  EXPECT_EQ(GrazingLoss(camera.errors.loss)(static_cast<float>(std::cos(0.9))), 0.0F);
  EXPECT_EQ(GrazingLoss(camera.errors.loss)(static_cast<float>(std::cos(1.25))), 1.0F);
}

TEST(Render, ShadowIsAsWideAsTheTwoRaysSay) {
  model::CameraParams camera = ideal_camera();
  camera.p_CL = Vector3(-0.1, 0.0, 0.0);
  Scene scene = wall(1.0);
  add_box(scene, "plate", {Matrix3::Identity(), Vector3(0, 0, 0.8005)}, Vector3(0.2, 0.2, 0.001));
  const RenderedFrame shot = render(scene, camera, {}, 1);
  // Ray from (-0.1, 0) over the plate's right edge (0.1, 0.8) meets the wall at 0.15; the camera sees the wall from
  // 0.125 on. On the left the projector sees under the plate as far as 0.1 + ..., the camera less: no shadow.
  int right = 0, left = 0;
  for (int c = 0; c < 400; ++c) {
    if (shot.truth.label(150, c) != 0 || shot.frame.depth(150, c) > 0.0F) continue;
    (c > 200 ? right : left)++;
  }
  EXPECT_NEAR(right, (0.15 - 0.125) * 400, 1.5);
  EXPECT_EQ(left, 0);
}

TEST(Render, CornersBendTowardTheCamera) {
  model::CameraParams camera = ideal_camera();
  camera.errors.interreflection = {2e-3, 0.02};
  Scene scene = wall(0.9);  // and a block whose left face is seen: a corner of two surfaces that look at each other
  add_box(scene, "block", {Matrix3::Identity(), Vector3(-0.35, 0.0, 0.8)}, Vector3(0.4, 10.0, 0.2));
  const RenderedFrame shot = render(scene, camera, {}, 1);
  int first = 0;
  while (shot.truth.label(150, first) == 1) ++first;  // the wall's first column: the corner
  const auto bias = [&](int col) {
    return static_cast<double>(shot.truth.depth(150, col)) - shot.frame.depth(150, col);
  };
  EXPECT_NEAR(bias(first), 2e-3, 0.25e-3);  // half a pixel from the corner, its normal nearly along the ray
  for (int d = 0; d < 20; ++d) {
    EXPECT_NEAR(bias(first + d), 2e-3 * std::exp(-((d + 0.5) * 0.9 / 400) / 0.02) / std::cos(0.12), 0.06e-3) << d;
    EXPECT_GE(bias(first + d), bias(first + d + 1) - 1e-6);
  }
  EXPECT_NEAR(bias(390), 0.0, 1e-6);
}

TEST(Render, MixedPixelsLieBetweenBothSurfaces) {
  model::CameraParams camera = ideal_camera();
  camera.errors.mixed_pixels = {0.5};
  Scene scene = wall(0.9);
  add_box(scene, "near", {Matrix3::Identity(), Vector3(-1.0, 0, 0.75)}, Vector3(2.0, 10, 0.1));
  const RenderedFrame shot = render(scene, camera, {}, 1);
  int between = 0;
  for (int r = 0; r < 300; ++r)
    for (int c = 198; c < 202; ++c) {
      const float z = shot.frame.depth(r, c);
      EXPECT_TRUE(z >= 0.7F - 1e-5F && z <= 0.9F + 1e-5F);
      const bool is_between = z > 0.7001F && z < 0.8999F;
      between += is_between ? 1 : 0;
      EXPECT_TRUE(!is_between || c == 199 || c == 200);
    }
  EXPECT_NEAR(between, 300, 50);  // half of 600: 4 standard errors
}

TEST(Render, GivesTheSameBytesAtAnyNumberOfThreads) {
  model::CameraParams camera = model::make_camera("structured_light");
  camera.name = "test";
  Scene scene = wall(1.0);
  Rng rng = Rng(9).split("boxes");
  for (int i = 0; i < 12; ++i)
    add_box(scene, "b" + std::to_string(i),
            {exp_rotation(Vector3(0, 0, rng.normal())), Vector3(rng.uniform(-0.3, 0.3), rng.uniform(-0.2, 0.2), 0.9)},
            Vector3(0.1, 0.15, 0.1));
  const CameraDraw draw = draw_camera(camera, 1);
  const RenderedFrame one = render(scene, camera, draw, 1, 1), three = render(scene, camera, draw, 1, 3);
  EXPECT_EQ(one.frame, three.frame);
  EXPECT_EQ(one.truth.label, three.truth.label);
  EXPECT_NE(one.frame.depth, render(scene, camera, draw, 2, 1).frame.depth);
}

TEST(TruthText, CountsThePixelsOfEachBodyAndThePointsOfAll) {
  const RenderedFrame shot = render(wall(0.9), ideal_camera(), {}, 1);
  const auto json = nlohmann::json::parse(format_truth(shot, 2.5, 1));
  EXPECT_EQ(json.at("time_s"), 2.5);
  EXPECT_EQ(count_points(shot.frame), 400 * 300);
  EXPECT_EQ(json.at("points"), 400 * 300);
  EXPECT_EQ(json.at("bodies").at(0).at("name"), "wall");
  EXPECT_EQ(json.at("bodies").at(0).at("pixels"), 400 * 300);
  EXPECT_EQ(json.at("true_camera_pose").at("quat_wxyz").at(0), 1.0);
}

}  // namespace
}  // namespace snug::camera
