// Cloud: points on their way into a picture: the nearest one stays, what is misread says how it would fit.
#include "snug/camera/internal/cloud.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "snug/camera/internal/file_parts.hpp"
#include "snug/core/input_error.hpp"

namespace snug::camera::internal {
namespace {

model::CameraParams cloud_camera() {
  model::CameraParams camera = model::make_camera("ideal");
  camera.width = 40;
  camera.height = 30;
  camera.intrinsics = {50.0, 50.0, 19.5, 14.5};
  camera.range.near = 0.3;
  camera.range.far = 2.0;
  camera.X_WC = {exp_rotation(Vector3(2.0, 0.3, -0.4)), Vector3(0.5, -0.2, 1.0)};
  return camera;
}

std::string refusal_of(Cloud cloud) {
  try {
    (void)std::move(cloud).finish("c.ply");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// A wall at 1 m, seen by every pixel: points of W, each `scale` of a metre.
void add_wall(const model::CameraParams& camera, double scale, bool says_pixels, Cloud& cloud) {
  std::size_t place = 0;
  for (int r = 0; r < camera.height; ++r)
    for (int c = 0; c < camera.width; ++c) {
      const Vector3 p_W = camera.X_WC * pixel_ray(camera.intrinsics, c, r);
      cloud.add(scale * p_W, says_pixels ? pixel_of(place, camera) : Pixel{});
      ++place;
    }
}

TEST(Cloud, PutsEachPointOnThePixelThatSeesIt) {
  const model::CameraParams camera = cloud_camera();
  for (const bool says_pixels : {true, false}) {
    Cloud cloud(camera, {});
    add_wall(camera, 1.0, says_pixels, cloud);
    const Frame frame = std::move(cloud).finish("c.ply");
    for (const float depth : frame.depth.values()) EXPECT_NEAR(depth, 1.0F, 1e-6F);
  }
}

TEST(Cloud, KeepsTheNearestOfPointsOnOnePixelWhateverTheirOrder) {
  const model::CameraParams camera = cloud_camera();
  for (const bool near_first : {true, false}) {
    Cloud cloud(camera, {});
    for (const double depth : {near_first ? 0.7 : 1.4, near_first ? 1.4 : 0.7})
      cloud.add(camera.X_WC * Vector3(depth * pixel_ray(camera.intrinsics, 8.0, 5.0)), {});
    EXPECT_NEAR(std::move(cloud).finish("c.ply").depth(5, 8), 0.7F, 1e-6F);
  }
}

TEST(Cloud, LeavesOutWhatIsNoPoint) {
  const model::CameraParams camera = cloud_camera();
  Cloud cloud(camera, {});
  const Vector3 p_W = camera.X_WC * Vector3(0.0, 0.0, 1.0);
  cloud.add(Vector3::Zero(), {});
  cloud.add(Vector3(p_W.x(), std::nan(""), p_W.z()), {});
  cloud.add(Vector3::Constant(std::numeric_limits<double>::infinity()), {});
  cloud.add(camera.X_WC * Vector3(0.0, 0.0, 0.29), {});  // too near
  cloud.add(camera.X_WC * Vector3(0.0, 0.0, 2.01), {});  // too far
  cloud.add(camera.X_WC * Vector3(0.0, 0.0, -1.0), {});  // behind it
  cloud.add(camera.X_WC * Vector3(0.45, 0.0, 1.0), {});  // beside the picture: 22.5 px from its middle
  cloud.add(p_W, {30.0, 2.0});                           // said to be below the last row
  const Frame frame = std::move(cloud).finish("c.ply");
  for (const float depth : frame.depth.values()) EXPECT_EQ(depth, 0.0F);
}

TEST(Cloud, OfAnotherUnitOrFrameSaysWhichOne) {
  const model::CameraParams camera = cloud_camera();
  Cloud millimetres(camera, {});
  add_wall(camera, 1e3, false, millimetres);
  const std::string of_unit = refusal_of(std::move(millimetres));
  EXPECT_NE(of_unit.find("--depth-unit 0.001)"), std::string::npos) << of_unit;
  Cloud own_frame(camera, {});
  for (int r = 0; r < camera.height; ++r)
    for (int c = 0; c < camera.width; ++c)  // as ROS has it: x into the scene
      own_frame.add(rotation_of(Axes::Ros) * pixel_ray(camera.intrinsics, c, r), {});
  const std::string of_frame = refusal_of(std::move(own_frame));
  EXPECT_NE(of_frame.find("--points-in-camera --axes ros"), std::string::npos) << of_frame;
}

TEST(Cloud, OfNothingThatHelpsSaysWhereItsPointsAre) {
  const model::CameraParams camera = cloud_camera();
  const auto refused = [&](const Vector3& p_C) {
    Cloud cloud(camera, {});
    for (int i = 0; i < 100; ++i) cloud.add(camera.X_WC * Vector3(p_C + 1e-3 * i * Vector3::UnitX()), {});
    return refusal_of(std::move(cloud));
  };
  EXPECT_NE(refused(Vector3(0.0, 0.0, -1.0)).find("behind the camera"), std::string::npos);
  EXPECT_NE(refused(Vector3(0.0, 0.0, 0.1)).find("too near"), std::string::npos);
  EXPECT_NE(refused(Vector3(0.0, 0.0, 3.0)).find("too far"), std::string::npos);
  EXPECT_NE(refused(Vector3(1.5, 0.0, 1.0)).find("beside the picture"), std::string::npos);
  // So few tell nothing of how they are to be read.
  Cloud few(camera, {});
  for (int i = 0; i < 49; ++i) few.add(camera.X_WC * Vector3(0.01 * i, 0.0, -1.0), {});
  EXPECT_EQ(refusal_of(std::move(few)), "");
}

TEST(Cloud, WhosePixelsAreNotThoseThatSeeItsPointsIsOfAnotherCamera) {
  const model::CameraParams camera = cloud_camera();
  Cloud cloud(camera, {});
  std::size_t place = 0;
  for (int r = 0; r < camera.height; ++r)
    for (int c = 0; c < camera.width; ++c)  // as a camera with its middle 8 px aside has it
      cloud.add(camera.X_WC * pixel_ray(camera.intrinsics, c + 8.0, r), pixel_of(place++, camera));
  const std::string refusal = refusal_of(std::move(cloud));
  EXPECT_NE(refusal.find("8.0 px beside the pixels that the file says"), std::string::npos) << refusal;
}

TEST(FileParts, ADepthCountsWithinTheWorkingRange) {
  const model::CameraParams camera = cloud_camera();
  EXPECT_EQ(usable(camera, 0.29), 0.0F);
  EXPECT_EQ(usable(camera, 1.25), 1.25F);
  EXPECT_EQ(usable(camera, 2.01), 0.0F);
  EXPECT_EQ(usable(camera, std::nan("")), 0.0F);
  EXPECT_EQ(usable(camera, -1.0), 0.0F);
  EXPECT_EQ(usable(camera, std::numeric_limits<double>::infinity()), 0.0F);
}

TEST(FileParts, DepthsOfAnotherUnitSayWhichOne) {
  const model::CameraParams camera = cloud_camera();
  const auto refusal = [&](double depth) -> std::string {
    try {
      expect_in_range(camera, std::vector<double>(100, depth), 1e-3, "d.png");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(1.0), "");
  EXPECT_NE(refusal(0.1).find("too near, or steps of 0.01 m"), std::string::npos) << refusal(0.1);
  EXPECT_NE(refusal(1000.0).find("too far, or steps of 1e-06 m"), std::string::npos) << refusal(1000.0);
  EXPECT_NO_THROW(expect_in_range(camera, std::vector<double>(49, 1000.0), 1e-3, "d.png"));
}

TEST(FileParts, APictureHasNoMorePixelsThanItsFileCanHold) {
  EXPECT_TRUE(has_room(640 * 480, 1000)) << "a small picture may be of nothing";
  EXPECT_FALSE(has_room(std::size_t{8192} * 8192, 1000));
  EXPECT_TRUE(has_room(std::size_t{8192} * 8192, std::size_t{8192} * 8192 * 2 / 4));
}

}  // namespace
}  // namespace snug::camera::internal
