// Scenes from scenarios and recordings, cameras as text; what cannot be is refused with words.
#include "snug/camera/scene.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>

#include "snug/camera/cast.hpp"
#include "snug/camera/frame_file.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"

namespace snug::camera {
namespace {

std::string complaint(const std::function<void()>& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

struct Recorded {
  record::RecordingHeader header;
  record::Frame frame;
};

Recorded one_box() {
  Recorded recorded;
  record::BodyInfo body{"BOX", "B1", record::BodyKind::Dynamic, 1.0, Vector3::Zero(), {}};
  record::ShapeInfo shape;
  shape.half = Vector3(0.1, 0.05, 0.02);
  shape.X_BG = Pose{Matrix3::Identity(), Vector3(0, 0, 0.5)};
  body.shapes = {shape};
  recorded.header.bodies = {body};
  record::BodySample sample;
  sample.X_WB = Pose{exp_rotation(Vector3(0, 0, 0.3)), Vector3(1, 2, 3)};
  recorded.frame.bodies = {sample};
  return recorded;
}

TEST(MakeScene, PutsShapesWhereTheirBodiesAre) {
  const Recorded recorded = one_box();
  const Scene scene = make_scene(recorded.header, recorded.frame, "run.h5");
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_EQ(scene.names, std::vector<std::string>{"BOX"});
  EXPECT_LT((scene.shapes[0].X_WG.p - Vector3(1, 2, 3.5)).norm(), 1e-12);
  EXPECT_LT(angle_between(scene.shapes[0].X_WG.R, exp_rotation(Vector3(0, 0, 0.3))), 1e-9);
  EXPECT_EQ(std::get<geometry::Box>(scene.shapes[0].shape).half, Vector3(0.1, 0.05, 0.02));
}

TEST(MakeScene, LeavesOutWhatIsNotThere) {
  Recorded recorded = one_box();
  recorded.frame.bodies[0].present = false;
  recorded.frame.bodies[0].X_WB.p = Vector3::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(make_scene(recorded.header, recorded.frame, "run.h5").names.empty());
}

TEST(MakeScene, RefusesWhatCannotBeAndNamesTheBody) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using Change = std::function<void(Recorded&)>;
  const std::vector<std::pair<Change, const char*>> cases = {
      {[](Recorded& r) { r.frame.bodies.clear(); }, "0 in a frame"},
      {[nan](Recorded& r) { r.frame.bodies[0].X_WB.p.x() = nan; }, "not finite"},
      {[nan](Recorded& r) { r.frame.bodies[0].X_WB.quat.w() = nan; }, "not finite"},
      {[](Recorded& r) { r.header.bodies[0].shapes[0].half.x() = 0.0; }, "a box without size"},
      {[](Recorded& r) { r.header.bodies[0].shapes[0].half.y() = -1.0; }, "a box without size"},
      {[nan](Recorded& r) { r.header.bodies[0].shapes[0].half.z() = nan; }, "a box without size"},
      {[](Recorded& r) { r.header.bodies[0].shapes[0].half.z() = 1e300; }, "a box without size"},
      {[](Recorded& r) { r.header.bodies[0].shapes[0].kind = record::ShapeKind::Capsule; }, "a capsule without size"},
      {[](Recorded& r) { r.header.bodies[0].shapes[0].kind = record::ShapeKind::Cylinder; }, "a cylinder without size"},
      {[](Recorded& r) { r.header.bodies[0].shapes[0].kind = record::ShapeKind::Hull; }, "a hull without volume"},
      {[](Recorded& r) {
         r.header.bodies[0].shapes[0].kind = record::ShapeKind::Hull;
         r.header.bodies[0].shapes[0].vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
       },
       "a hull without volume"}};
  for (const auto& [change, part] : cases) {
    SCOPED_TRACE(part);
    Recorded recorded = one_box();
    change(recorded);
    const std::string said = complaint([&] { (void)make_scene(recorded.header, recorded.frame, "run.h5"); });
    EXPECT_NE(said.find(part), std::string::npos) << said;
    EXPECT_NE(said.find("run.h5"), std::string::npos);
  }
}

TEST(MakeSurroundings, AreTheWallsOfTheContainersAndWhatStandsStill) {
  model::Scenario scenario;
  model::Container container;
  container.name = "tote";
  container.inner_size = Vector3(0.4, 0.6, 0.25);
  container.X_WT = {Matrix3::Identity(), Vector3(1, 0, 0)};
  scenario.containers.push_back(container);
  const Scene scene = make_surroundings(scenario);
  EXPECT_EQ(scene.names, std::vector<std::string>{"tote"});
  EXPECT_EQ(scene.shapes.size(), 5u) << "a floor and four walls";
  // From above, the middle of the floor is seen at height 0, and beside it the rims.
  CastView view;
  view.X_WC = {(Matrix3() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished(), Vector3(1, 0, 1.0)};
  view.optics = {200, 200, 99.5, 99.5};
  view.rows = view.cols = 200;
  EXPECT_NEAR(1.0 / cast(scene, view).inverse_depth(100, 100), 1.0, 1e-5);
}

TEST(FormatCamera, IsReadBackForAnyPoseAndOptics) {
  Rng rng = Rng(4).split("camera text");
  for (int i = 0; i < 100; ++i) {
    model::CameraParams camera = model::make_camera("structured_light");
    camera.name = "over \"the\" tote\n\u00e4";
    camera.width = 1 + static_cast<int>(rng.uniform(0.0, 4000.0));
    camera.height = 1 + static_cast<int>(rng.uniform(0.0, 4000.0));
    camera.intrinsics = {rng.uniform(2.0, 3000.0), rng.uniform(2.0, 3000.0), rng.uniform(-50.0, 2000.0), rng.uniform()};
    camera.X_WC = {exp_rotation(Vector3(rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-3, 3))),
                   Vector3(rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-3, 3))};
    model::CameraParams read;
    parse_camera(format_camera(camera), "text", read);
    EXPECT_EQ(read.name, camera.name);
    EXPECT_EQ(read.intrinsics, camera.intrinsics);
    EXPECT_EQ(read.width, camera.width);
    EXPECT_EQ(read.X_WC.p, camera.X_WC.p) << "numbers are written whole";
    EXPECT_LT((read.X_WC.R - camera.X_WC.R).norm(), 1e-12);
  }
}

TEST(ParseCamera, RefusesEachKeyThatCannotBeByItsName) {
  const std::string good = format_camera(model::make_camera("structured_light"));
  const std::vector<std::array<std::string, 3>> slips = {
      {"\"size_px\":[972,600]", "\"size_px\":[0,600]", "size_px"},
      {"\"size_px\":[972,600]", "\"size_px\":[972]", "size_px"},
      {"\"size_px\":[972,600]", "\"size_px\":\"972x600\"", "size_px"},
      {"\"intrinsics_px\":[", "\"intrinsics_px\":[0.5,", "intrinsics_px"},
      {"\"position_m\":[", "\"position_m\":[1e30,", "position_m"},
      {"\"quat_wxyz\":[", "\"quat_wxyz\":[0.9,", "quat_wxyz"},
      {"\"working_range_m\":[", "\"working_range_m\":[\"near\",", "working_range_m"}};
  for (const auto& [from, to, key] : slips) {
    SCOPED_TRACE(to);
    std::string text = good;
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << good;
    text.replace(at, from.size(), to);
    model::CameraParams camera;
    EXPECT_NE(complaint([&] { parse_camera(text, "frame.png", camera); }).find(key), std::string::npos);
  }
}

}  // namespace
}  // namespace snug::camera
