// Files of frames: what is written is read back; files that cannot be are refused with words.
#include "snug/camera/frame_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "snug/camera/render.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::camera {
namespace {

namespace fs = std::filesystem;

RenderedFrame small_shot() {
  model::CameraParams camera = model::make_camera("structured_light");
  camera.name = "small";
  camera.width = 64;
  camera.height = 48;
  camera.intrinsics = {60.0, 60.0, 31.5, 23.5};
  camera.X_WC = {exp_rotation(Vector3(0.1, 0.2, 0.3)), Vector3(0.5, -0.2, 0.1)};
  Scene scene;
  add_box(scene, "wall", camera.X_WC * Pose{Matrix3::Identity(), Vector3(0, 0, 1.05)}, Vector3(5, 5, 0.1));
  add_box(scene, "box", camera.X_WC * Pose{Matrix3::Identity(), Vector3(0, 0, 0.85)}, Vector3(0.2, 0.2, 0.1));
  return render(scene, camera, draw_camera(camera, 1), 1);
}

class FrameFile : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  void expect_refused(const fs::path& path, const std::string& part, const FrameHints& hints = {}) {
    try {
      (void)load_frame(path, hints);
      ADD_FAILURE() << path << " was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
  snug::test::ScratchFolder folder_;
};

TEST_F(FrameFile, PngKeepsDepthToATwentiethOfAMillimetreAndTheCamera) {
  const RenderedFrame shot = small_shot();
  const Frame read = load_frame(write("f.png", format_png(shot.frame)), {});
  for (std::size_t i = 0; i < read.depth.values().size(); ++i)
    EXPECT_NEAR(read.depth.values()[i], shot.frame.depth.values()[i], 0.5 * kPngUnit + 1e-7);
  EXPECT_EQ(read.camera.intrinsics, shot.frame.camera.intrinsics);
  EXPECT_LT((read.camera.X_WC.p - shot.frame.camera.X_WC.p).norm(), 1e-12);
  EXPECT_LT((read.camera.X_WC.R - shot.frame.camera.X_WC.R).norm(), 1e-12);
}

TEST_F(FrameFile, PlyAndHdf5ComeBack) {
  const RenderedFrame shot = small_shot();
  const Frame ply = load_frame(write("f.ply", format_ply(shot.frame, &shot.truth)), {});
  for (std::size_t i = 0; i < ply.depth.values().size(); ++i)
    EXPECT_NEAR(ply.depth.values()[i], shot.frame.depth.values()[i], 1e-6);  // single precision of world coordinates
  OutputFile file(folder_ / "f.h5");
  write_h5(file, shot.frame, &shot.truth);
  file.publish();
  const Frame h5 = load_frame(folder_ / "f.h5", {});
  EXPECT_EQ(h5.depth, shot.frame.depth);
  EXPECT_EQ(h5.intensity, shot.frame.intensity);
}

TEST_F(FrameFile, CloudsOfOthersArePutIntoTheCamerasPicture) {
  FrameHints hints;
  hints.camera = small_shot().frame.camera;
  hints.points_are_in_camera = true;
  hints.depth_unit = 1e-3;
  const Frame frame = load_frame(write("mm.ply",
                                       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                       "property float z\nend_header\n0 0 900\nnan nan nan\n8.5 -8.5 1020\n"),
                                 hints);
  EXPECT_FLOAT_EQ(frame.depth(24, 32), 0.9F);
  EXPECT_FLOAT_EQ(frame.depth(23, 32), 1.02F);
  EXPECT_EQ(std::count_if(frame.depth.values().begin(), frame.depth.values().end(), [](float z) { return z > 0.0F; }),
            2);
}

TEST_F(FrameFile, WhatCannotBeAFrameIsRefused) {
  const RenderedFrame shot = small_shot();
  expect_refused(folder_ / "none.png", "none.png");
  expect_refused(write("empty.png", ""), "frame");
  expect_refused(write("text.ply", "hello"), "begins like none");
  const std::string png = format_png(shot.frame), ply = format_ply(shot.frame, nullptr);
  expect_refused(write("cut.png", png.substr(0, png.size() / 2)), "cut.png");
  expect_refused(write("grey8.png", format_intensity_png(shot.frame)), "16");
  expect_refused(write("cut.ply", ply.substr(0, ply.size() - 10)), "too early");
  expect_refused(write("noxyz.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"),
                 "no property y");
  expect_refused(write("huge.ply", "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n"),
                 "absurd");
  expect_refused(write("list.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n"),
                 "list");
  Frame blank = shot.frame;
  blank.camera.width = blank.camera.height = 8000;
  const std::string comment = format_camera(blank.camera);
  expect_refused(write("blank.ply", "ply\nformat ascii 1.0\ncomment snug-camera " + comment +
                                        "\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                                        "end_header\n0 0 1\n"),
                 "more pixels than");
  blank.depth = Grid2<float>(8000, 8000);
  expect_refused(write("blank.png", format_png(blank)), "more pixels than");
  expect_refused(write("bad.h5", "\x89HDF\r\n\x1a\n and no more"), "bad.h5");
  FrameHints other;
  other.camera = shot.frame.camera;
  other.camera.width = 65;
  other.camera_is_given = true;
  expect_refused(write("size.png", png), "64 x 48", other);
  for (const std::string slip :
       {"{", "{}", R"({"size_px":[1e9,1]})", R"({"size_px":[4,4],"intrinsics_px":[0,1,2,3]})"}) {
    model::CameraParams camera;
    EXPECT_THROW(parse_camera(slip, "c", camera), InputError) << slip;
  }
}

}  // namespace
}  // namespace snug::camera
