// Files beside frames: what other programs write of a camera is read, slips are refused with their line.
#include "snug/camera/camera_file.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::camera {
namespace {

CameraFile read(const std::string& text) { return parse_camera_file(text, "c.yaml"); }

TEST(CameraFile, ReadsWhatOtherProgramsWrite) {
  const model::CameraIntrinsics expected{910.5, 911.5, 640.25, 360.75};
  const std::string ros_calibration =
      "image_width: 1280\nimage_height: 720\ncamera_name: front\ndistortion_model: plumb_bob\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [910.5, 0, 640.25, 0, 911.5, 360.75, 0, 0, 1]\n"
      "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n";
  const std::string ros_message =
      "header: {frame_id: x}\nheight: 720\nwidth: 1280\ndistortion_model: plumb_bob\nd: [0.0, 0.0]\n"
      "k: [910.5, 0, 640.25, 0, 911.5, 360.75, 0, 0, 1]\nbinning_x: 0\nroi: {x_offset: 0}\n";
  const std::string open3d =
      R"({"width": 1280, "height": 720, "intrinsic_matrix": [910.5, 0, 0, 0, 911.5, 0, 640.25, 360.75, 1]})";
  const std::string realsense =
      R"({"width": 1280, "height": 720, "fx": 910.5, "fy": 911.5, "ppx": 640.25, "ppy": 360.75, "model": "x",
          "coeffs": [0, 0, 0, 0, 0], "depth_scale": 0.00025})";
  for (const std::string& text : {ros_calibration, ros_message, open3d, realsense}) {
    const CameraFile file = read(text);
    ASSERT_TRUE(file.intrinsics) << text;
    EXPECT_EQ(*file.intrinsics, expected) << text;
    ASSERT_TRUE(file.size) << text;
    EXPECT_EQ(file.size->width, 1280);
    EXPECT_EQ(file.size->height, 720);
  }
  EXPECT_EQ(read(realsense).unit, 0.00025);
  EXPECT_EQ(read(ros_calibration).name, "front");
}

TEST(CameraFile, UnitsAreWordsOrMetres) {
  EXPECT_EQ(read("unit: mm").unit, 1e-3);
  EXPECT_EQ(read("unit: 0.1 mm").unit, 1e-4);
  EXPECT_EQ(read("unit: m").unit, 1.0);
  EXPECT_EQ(read("depth_scale: 0.0005").unit, 0.0005);
  EXPECT_FALSE(read("name: top").unit);
}

TEST(CameraFile, PosesAreThoseOfFrameCWhateverTheAxes) {
  // A camera that looks straight down from 1 m, its rows along -y: z down, x along W's y.
  const double half = std::numbers::pi;
  const CameraFile optical =
      read("pose: {position: [0.1, 0.2, 1.0], rotation_vector: [" + std::to_string(half) + ", 0, 0]}");
  ASSERT_TRUE(optical.X_WC);
  EXPECT_LT((optical.X_WC->R.col(2) - Vector3(0, 0, -1)).norm(), 1e-5);
  const CameraFile ros = read("axes: ros\npose: {position: [0, 0, 1], rpy_deg: [0, 90, 0]}");  // x forward: down
  EXPECT_LT((ros.X_WC->R.col(2) - Vector3(0, 0, -1)).norm(), 1e-12);
  const CameraFile opengl = read("axes: opengl\npose: {position: [0, 0, 1]}");  // looks along -z
  EXPECT_LT((opengl.X_WC->R.col(2) - Vector3(0, 0, -1)).norm(), 1e-12);
  EXPECT_LT((opengl.X_WC->R.col(0) - Vector3(1, 0, 0)).norm(), 1e-12);
  for (const Axes axes : {Axes::Optical, Axes::Ros, Axes::OpenGl}) {
    EXPECT_NEAR(rotation_of(axes).determinant(), 1.0, 1e-12);
    EXPECT_EQ(axes_of(name_of(axes), "x"), axes);
  }
  const CameraFile matrix = read("X_WC: [[1, 0, 0, 0.5], [0, -1, 0, 0.6], [0, 0, -1, 0.7], [0, 0, 0, 1]]");
  EXPECT_LT((matrix.X_WC->p - Vector3(0.5, 0.6, 0.7)).norm(), 1e-12);
}

TEST(CameraFile, SlipsAreRefusedWithTheirLine) {
  const struct {
    const char* text;
    const char* part;
  } cases[] = {
      {"fx: 900\nfy: 900\ncx: 1", "fx, fy, cx and cy"},
      {"name: a\nunti: mm", "c.yaml:2"},
      {"name: a\nunti: mm", "'unit'"},
      {"unit: inch", "0.1 mm"},
      {"depth_scale: 1000", "0.001 is a millimetre"},
      {"width: 640", "height"},
      {"width: 640.5\nheight: 480", "1 to 8192"},
      {"d: [0.1, 0, 0, 0]", "rectified"},
      {"axes: sideways", "optical"},
      {"points_in: tool", "camera or world"},
      {"pose: {rpy_deg: [0, 0, 0]}", "no position"},
      {"pose: {position: [0, 0, 1], quat_wxyz: [1, 1, 0, 0]}", "unit quaternion"},
      {"pose: {position: [0, 0, 1], rpy_deg: [0, 0, 0], quat_wxyz: [1, 0, 0, 0]}", "two rotations"},
      {"K: [900, 1, 640, 0, 900, 360, 0, 0, 1]", "fx 0 cx"},
      {"K: [900, 0, 640, 0, 900, 360, 0, 0]", "9"},
      {"X_WC: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]", "no pose"},
      {"fx: .nan\nfy: 1\ncx: 1\ncy: 1", "finite"},
      {R"({"color_intrinsics": {"fx": 608.3}, "depth_intrinsics": {"fx": 383.3}})", "one of several cameras"},
      {"[1, 2]", "no mapping"},
      {"{", "c.yaml"},
  };
  for (const auto& [text, part] : cases) {
    try {
      (void)read(text);
      ADD_FAILURE() << "read: " << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }
}

TEST(CameraFile, IsFoundBesideTheFrameAndNeverGuessed) {
  const snug::test::ScratchFolder folder;
  const auto write = [&](const std::string& name) { std::ofstream(folder / name) << "unit: mm\n"; };
  EXPECT_FALSE(find_camera_file(folder / "f.png"));
  write("camera.yaml");
  EXPECT_EQ(find_camera_file(folder / "f.png"), folder / "camera.yaml");
  write("f.json");
  EXPECT_EQ(find_camera_file(folder / "f.png"), folder / "f.json");
  write("f.yml");
  EXPECT_THROW((void)find_camera_file(folder / "f.png"), InputError);
}

TEST(ChooseCamera, IsTheFirstOrTheOneThatIsNamed) {
  model::Scenario scenario;
  EXPECT_THROW((void)choose_camera(scenario, {}, "cell.yaml"), InputError) << "a scenario without cameras";
  scenario.cameras = {model::make_camera("ideal"), model::make_camera("ideal")};
  scenario.cameras[0].name = "tote";
  scenario.cameras[1].name = "pick";
  EXPECT_EQ(choose_camera(scenario, {}, "cell.yaml").name, "tote");
  EXPECT_EQ(choose_camera(scenario, "pick", "cell.yaml").name, "pick");
  try {
    (void)choose_camera(scenario, "pik", "cell.yaml");
    FAIL() << "there is no such camera";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("one of tote, pick, nearest is 'pick'"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace snug::camera
