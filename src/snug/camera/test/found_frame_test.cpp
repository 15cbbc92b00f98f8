// Frames as other programs write them: every form of one scene is the same picture, and a wrong reading says what it
// is.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <sstream>

#include "snug/camera/frame_file.hpp"
#include "snug/camera/render.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::camera {
namespace {

namespace fs = std::filesystem;

/// A wall at 1 m with a box before it, without errors.
const Frame& scene_frame() {
  static const Frame frame = [] {
    model::CameraParams camera = model::make_camera("ideal");
    camera.name = "small";
    camera.width = 64;
    camera.height = 48;
    camera.intrinsics = {60.0, 61.0, 31.5, 23.5};
    camera.X_WC = {exp_rotation(Vector3(0.1, 0.2, 0.3)), Vector3(0.5, -0.2, 0.1)};
    Scene scene;
    add_box(scene, "wall", camera.X_WC * Pose{Matrix3::Identity(), Vector3(0, 0, 1.05)}, Vector3(5, 5, 0.1));
    add_box(scene, "box", camera.X_WC * Pose{Matrix3::Identity(), Vector3(0, 0, 0.85)}, Vector3(0.2, 0.2, 0.1));
    return render(scene, camera, draw_camera(camera, 1), 1).frame;
  }();
  return frame;
}

std::string text_of(double value) {
  std::ostringstream text;
  text.precision(9);
  text << value;
  return text.str();
}

/// Points of the frame in its camera's optical frame, row by row; NaN where there is none.
std::vector<Vector3> points() {
  std::vector<Vector3> all;
  const Frame& frame = scene_frame();
  for (int r = 0; r < frame.depth.rows(); ++r)
    for (int c = 0; c < frame.depth.cols(); ++c)
      all.emplace_back(frame.depth(r, c) > 0.0F ? Vector3(frame.depth(r, c) * pixel_ray(frame.camera.intrinsics, c, r))
                                                : Vector3::Constant(std::nan("")));
  return all;
}

template <class T>
std::string bytes_of(T value, bool is_big) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (is_big) std::ranges::reverse(bytes);
  return bytes;
}

std::string ply_head(const std::string& format, std::size_t count, const std::string& more = "") {
  return "ply\nformat " + format + " 1.0\n" + more + "element vertex " + std::to_string(count) +
         "\nproperty float x\nproperty double y\nproperty float z\nend_header\n";
}

std::string pcd_head(const std::string& data, bool is_organised) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS rgb x y z\nSIZE 4 4 8 4\nTYPE U F F F\n"
         "COUNT 1 1 1 1\nWIDTH " +
         std::string(is_organised ? "64" : "3072") + "\nHEIGHT " + (is_organised ? "48" : "1") +
         "\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3072\nDATA " + data + "\n";
}

class FoundFrame : public ::testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  void expect_scene(const fs::path& path, const FrameHints& hints, double tolerance = 2e-6) {
    const Frame frame = load_frame(path, hints);
    ASSERT_EQ(frame.depth.rows(), 48);
    ASSERT_EQ(frame.depth.cols(), 64);
    for (std::size_t i = 0; i < frame.depth.values().size(); ++i)
      ASSERT_NEAR(frame.depth.values()[i], scene_frame().depth.values()[i], tolerance) << path << " " << i;
  }
  void expect_refused(const fs::path& path, const FrameHints& hints, const std::vector<std::string>& parts) {
    try {
      (void)load_frame(path, hints);
      ADD_FAILURE() << path << " was read";
    } catch (const InputError& error) {
      for (const std::string& part : parts)
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
  /// The camera of the scene, points in its frame.
  static FrameHints in_camera(Axes axes = Axes::Optical) {
    FrameHints hints;
    hints.camera = scene_frame().camera;
    hints.points_are_in_camera = true;
    hints.axes = axes;
    return hints;
  }
  /// A PLY of text.
  std::string ply_of(double unit, Axes axes = Axes::Optical) {
    std::string body;
    const auto all = points();
    for (const Vector3& p_C : all) {
      const Vector3 p = rotation_of(axes) * p_C / unit;
      for (const double value : {p.x(), p.y(), p.z()}) body += (std::isnan(value) ? "nan" : text_of(value)) + " ";
      body += "\n";
    }
    return ply_head("ascii", all.size()) + body;
  }
  snug::test::ScratchFolder folder_;
};

TEST_F(FoundFrame, PliesOfEitherByteOrderAreTheSamePicture) {
  for (const bool is_big : {false, true}) {
    std::string body;
    for (const Vector3& p : points())
      body += bytes_of(static_cast<float>(p.x()), is_big) + bytes_of(p.y(), is_big) +
              bytes_of(static_cast<float>(p.z()), is_big);
    const std::string head = ply_head(is_big ? "binary_big_endian" : "binary_little_endian", points().size());
    expect_scene(write("cloud.ply", head + body), in_camera());
    expect_refused(write("cut.ply", head + body.substr(1)), in_camera(), {"too early"});
  }
}

TEST_F(FoundFrame, UnitsAndAxesOfCloudsAreSaid) {
  FrameHints millimetres = in_camera(Axes::Ros);
  millimetres.depth_unit = 1e-3;
  expect_scene(write("ros.ply", ply_of(1e-3, Axes::Ros)), millimetres);
  expect_scene(write("gl.ply", ply_of(1.0, Axes::OpenGl)), in_camera(Axes::OpenGl));
}

TEST_F(FoundFrame, ACloudThatIsMisreadSaysHowItWouldFit) {
  expect_refused(write("mm.ply", ply_of(1e-3)), in_camera(), {"0 of 3072 points", "--depth-unit 0.001"});
  expect_refused(write("ros.ply", ply_of(1.0, Axes::Ros)), in_camera(), {"--axes ros"});
  expect_refused(write("gl.ply", ply_of(1.0, Axes::OpenGl)), in_camera(), {"--axes opengl"});
  FrameHints in_world = in_camera();
  in_world.points_are_in_camera = false;
  in_world.camera.X_WC.p.z() = 5.0;
  expect_refused(write("c.ply", ply_of(1.0)), in_world, {"--points-in-camera"});
  FrameHints near = in_camera();
  near.camera.range.far = 0.5;
  expect_refused(write("far.ply", ply_of(1.0)), near, {"too far", "0.3 to 0.5 m"});
  FrameHints other = in_camera();
  other.camera.intrinsics.cx += 12.0;
  expect_refused(write("optics.ply", ply_of(1.0)), other, {"12", "intrinsics"});
}

TEST_F(FoundFrame, ACloudWithoutOrderFallsOnItsPixels) {
  std::string body;
  std::vector<Vector3> all = points();
  std::erase_if(all, [](const Vector3& p) { return !p.allFinite(); });
  std::ranges::reverse(all);
  all.pop_back();  // another number than pixels
  for (const Vector3& p : all) body += text_of(p.x()) + " " + text_of(p.y()) + " " + text_of(p.z()) + "\n";
  const Frame frame = load_frame(write("loose.ply", ply_head("ascii", all.size()) + body), in_camera());
  const auto count = [](const Frame& one) {
    return std::ranges::count_if(one.depth.values(), [](float z) { return z > 0.0F; });
  };
  EXPECT_EQ(count(frame), static_cast<std::ptrdiff_t>(all.size()));
}

TEST_F(FoundFrame, PcdsOfEveryFormAreTheSamePicture) {
  const auto all = points();
  std::string text, binary, by_field;
  for (const Vector3& p : all) {
    text += "7 ";
    for (const double value : {p.x(), p.y(), p.z()}) text += (std::isnan(value) ? "nan" : text_of(value)) + " ";
    text += "\n";
    binary += bytes_of(std::uint32_t{7}, false) + bytes_of(static_cast<float>(p.x()), false) + bytes_of(p.y(), false) +
              bytes_of(static_cast<float>(p.z()), false);
  }
  for (std::size_t i = 0; i < all.size(); ++i) by_field += bytes_of(std::uint32_t{7}, false);
  for (const Vector3& p : all) by_field += bytes_of(static_cast<float>(p.x()), false);
  for (const Vector3& p : all) by_field += bytes_of(p.y(), false);
  for (const Vector3& p : all) by_field += bytes_of(static_cast<float>(p.z()), false);
  // Packed as a packer may: the sevens as one byte run and copies, the rest as it is.
  std::string packed("\x03\x07\x00\x00\x00", 5);
  for (std::size_t left = 4 * all.size() - 4; left > 0;) {
    const std::size_t length = std::min<std::size_t>(left, 264);
    ASSERT_TRUE(length == left || left - length >= 3);
    if (length < 9) {
      packed += static_cast<char>((length - 2) << 5U);
    } else {
      packed += static_cast<char>(7U << 5U);
      packed += static_cast<char>(length - 9);
    }
    packed += '\x03';  // four bytes back
    left -= length;
  }
  for (std::size_t at = 4 * all.size(); at < by_field.size(); at += 32) {
    const std::string run = by_field.substr(at, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  const std::string sizes = bytes_of(static_cast<std::uint32_t>(packed.size()), false) +
                            bytes_of(static_cast<std::uint32_t>(by_field.size()), false);
  for (const bool is_organised : {true, false}) {
    expect_scene(write("a.pcd", pcd_head("ascii", is_organised) + text), in_camera());
    expect_scene(write("b.pcd", pcd_head("binary", is_organised) + binary), in_camera());
    expect_scene(write("c.pcd", pcd_head("binary_compressed", is_organised) + sizes + packed), in_camera());
  }
  expect_refused(write("cut.pcd", pcd_head("binary", true) + binary.substr(9)), in_camera(), {"too early"});
  expect_refused(write("cut.pcd", pcd_head("binary_compressed", true) + sizes + packed.substr(0, 900)), in_camera(),
                 {"too early"});
  std::string broken = packed;
  broken[5] = '\xff';  // a copy from before the beginning
  broken[7] = '\x7f';
  expect_refused(write("broken.pcd", pcd_head("binary_compressed", true) + sizes + broken), in_camera(), {"packed"});
  expect_refused(write("no.pcd", "VERSION 0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nPOINTS 1\nDATA ascii\n1 2\n"),
                 in_camera(), {"no field z"});
  expect_refused(write("huge.pcd", "VERSION 0.7\nFIELDS x\nPOINTS 99999999999\nDATA ascii\n"), in_camera(), {"POINTS"});
}

TEST_F(FoundFrame, APngGoesWithTheFileBesideIt) {
  Frame plain = scene_frame();
  const std::string ours = format_png(plain);
  // Without our chunk: the length and name of a tEXt chunk stand before it.
  const std::size_t at = ours.find("tEXtsnug-camera");
  ASSERT_NE(at, std::string::npos);
  const auto length = static_cast<std::size_t>(static_cast<unsigned char>(ours[at - 2]) * 256U +
                                               static_cast<unsigned char>(ours[at - 1]));
  const std::string png = ours.substr(0, at - 4) + ours.substr(at + 8 + length);
  write("f.yaml",
        "unit: 0.1 mm\nfx: 60\nfy: 61\ncx: 31.5\ncy: 23.5\n"
        "pose: {position: [0.5, -0.2, 0.1], rotation_vector: [0.1, 0.2, 0.3]}\n");
  FrameHints hints;  // another camera altogether
  expect_scene(write("f.png", png), hints, 0.5e-4 + 1e-7);
  EXPECT_LT((load_frame(folder_ / "f.png", hints).camera.X_WC.R - plain.camera.X_WC.R).norm(), 1e-12);
  expect_scene(write("f.png", ours), hints, 0.5e-4 + 1e-7);  // says it itself
  FrameHints said = in_camera();
  expect_refused(write("g.png", png), said, {"too far", "steps of 0.0001 m", "it is 1 m"});
  said.depth_unit = 1e-4;
  expect_scene(folder_ / "g.png", said, 0.5e-4 + 1e-7);
}

TEST_F(FoundFrame, PointsWithoutOrderNeedASize) {
  write("loose.json", R"({"fx": 60, "fy": 61, "cx": 31.5, "cy": 23.5, "points_in": "camera"})");
  expect_refused(write("loose.ply", ply_head("ascii", 1) + "0 0 1\n"), {}, {"`width` and `height`"});
}

}  // namespace
}  // namespace snug::camera
