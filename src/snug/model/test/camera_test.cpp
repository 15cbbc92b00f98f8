// The cameras of a scenario are read strictly, from a preset on.
#include <gtest/gtest.h>

#include <numbers>

#include "scenario_text.hpp"
#include "snug/model/scenario.hpp"

namespace snug::model {
namespace {

std::string with_camera(const std::string& keys) {
  return "materials: [{name: m}]\ncameras:\n  - {name: top, preset: structured_light, pose: {position: [0, 0, 1]}" +
         (keys.empty() ? "" : ", " + keys) + "}\n";
}

CameraParams read_camera(const std::string& keys) { return parse_scenario(with_camera(keys), "c.yaml").cameras.at(0); }

TEST(Camera, KeepsThePresetUnlessAKeySaysOtherwise) {
  CameraParams expected = make_camera("structured_light");
  expected.name = "top";
  expected.X_WC.p.z() = 1.0;
  EXPECT_EQ(read_camera(""), expected);
  expected.errors.noise.correlation = 2.0;
  expected.errors.hand_eye.rotation = 0.5 * std::numbers::pi / 180.0;
  EXPECT_EQ(read_camera("noise: {correlation: 2}, hand_eye: {rotation_deg: 0.5}"), expected);
}

TEST(Camera, IdealHasNoErrors) {
  const CameraErrors errors = make_camera("ideal").errors;
  EXPECT_EQ(errors.noise.precision + errors.planarity.local + errors.planarity.global, 0.0);
  EXPECT_EQ(errors.trueness, Trueness{});
  EXPECT_EQ(errors.hand_eye, HandEye{});
  EXPECT_EQ(errors.loss.random + errors.loss.edge + errors.mixed_pixels.probability, 0.0);
}

TEST(Camera, AnotherResolutionSeesTheSameField) {
  const CameraParams full = read_camera(""), half = read_camera("resolution: [486, 300]");
  EXPECT_NEAR(half.intrinsics.fx, 0.5 * full.intrinsics.fx, 1e-9);
  EXPECT_EQ(half.intrinsics.cx, 242.5);
}

TEST(Camera, DemonstratorLooksIntoItsContainer) {
  const Scenario scenario = load_scenario(test::project_file("scenarios/box-demonstrator.yaml"));
  const CameraParams* camera = find_camera(scenario, "tote");
  ASSERT_NE(camera, nullptr);
  const Container& tote = *find_container(scenario, scenario.target);
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double z : {0.0, 1.0}) {  // every inner corner is in the picture
        const Vector3 p_TQ = tote.inner_size.cwiseProduct(Vector3(x, y, z));
        const Vector3 p_CQ = camera->X_WC.inverse() * (tote.X_WT * p_TQ);
        const double col = camera->intrinsics.cx + camera->intrinsics.fx * p_CQ.x() / p_CQ.z();
        const double row = camera->intrinsics.cy + camera->intrinsics.fy * p_CQ.y() / p_CQ.z();
        EXPECT_TRUE(col > 0 && col < camera->width - 1 && row > 0 && row < camera->height - 1) << col << " " << row;
        EXPECT_LT(p_CQ.z(), camera->range.far);
      }
}

TEST(Camera, SlipsAreRefusedWithLineKeyAndWhatWouldDo) {
  const struct {
    const char* keys;
    const char* part;
  } slips[] = {
      {"nois: {precision: 0.1}", "noise"},
      {"noise: {precission: 0.1}", "precision"},
      {"noise: {precision: 0.2}", "at most 0.1"},
      {"noise: {precision: .nan}", "precision"},
      {"noise: {correlation: 9}", "at most 8"},
      {"planarity: {local_length: 1}", "2 to 10000"},
      {"trueness: {dimension: 0.2}", "at most 0.05"},
      {"loss: {edge: 1.5}", "edge"},
      {"loss: {grazing_onset_deg: 88}", "grazing_onset_deg <= grazing_full_deg"},
      {"loss: {grazing_onset: 1}", "grazing_onset_deg"},
      {"interreflection: {reach: 15}", "at most 1"},
      {"hand_eye: {position: 0.25}", "at most 0.1"},
      {"working_range: {near: 2.0}", "near < far"},
      {"intrinsics: {fx: 0}", "fx"},
      {"intrinsics: {fx: 1.0e+9}", "focal lengths"},
      {"resolution: [972]", "pixels"},
      {"resolution: [972, 100000]", "resolution"},
      {"projector: [0.1, 0, 30]", "at most 2"},
      {"preset: zivid", "preset"},
  };
  for (const auto& slip : slips) {
    SCOPED_TRACE(slip.keys);
    try {
      (void)read_camera(slip.keys);
      ADD_FAILURE() << "was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("c.yaml:3"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(slip.part), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW((void)parse_scenario("materials: [{name: m}]\ncameras: [{name: top}]", "c.yaml"), InputError);
}

}  // namespace
}  // namespace snug::model
