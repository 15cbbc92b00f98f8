// Reading the cameras: pose, optics and errors, from a preset on.
#include <cmath>
#include <numbers>

#include "snug/model/internal/fields.hpp"
#include "snug/model/internal/scenario_reader.hpp"

namespace snug::model::internal {
namespace {

constexpr double kLargestError = 0.1;   // m: a camera that is off by more is taken for a slip (millimetres)
constexpr double kLongestWave = 10000;  // px

void read_resolution(const Value& value, CameraParams& camera) {
  const std::vector<Value> sides = value.list_of(2, "pixels, across and down");
  const CameraParams before = camera;
  camera.width = static_cast<int>(sides[0].integer(16, 8192));
  camera.height = static_cast<int>(sides[1].integer(16, 8192));
  // The same field of view, as far as the sides allow.
  const double scale = static_cast<double>(camera.width) / before.width;
  camera.intrinsics = {before.intrinsics.fx * scale, before.intrinsics.fy * scale, 0.5 * (camera.width - 1),
                       0.5 * (camera.height - 1)};
}

void check_optics(const MapReader& map, const CameraParams& camera) {
  const CameraRange& range = camera.range;
  if (!(range.near < range.far && range.near <= range.focus && range.focus <= range.far && range.far <= kLargestSize))
    (map.has("working_range") ? map.require("working_range") : map.self())
        .fail("near " + to_text(range.near) + ", focus " + to_text(range.focus) + ", far " + to_text(range.far),
              "near < far with the focus between them, at most 100 m");
  const CameraIntrinsics& optics = camera.intrinsics;
  const double side = std::max(camera.width, camera.height);
  // A field of view between 0.6 and 170 degrees, its middle not far outside the picture.
  const bool is_fine =
      std::min(optics.fx, optics.fy) >= 0.05 * side && std::max(optics.fx, optics.fy) <= 100.0 * side &&
      std::abs(optics.cx - 0.5 * camera.width) <= 2.0 * side && std::abs(optics.cy - 0.5 * camera.height) <= 2.0 * side;
  if (!is_fine)
    (map.has("intrinsics") ? map.require("intrinsics") : map.self())
        .fail("fx " + to_text(optics.fx) + ", fy " + to_text(optics.fy) + ", cx " + to_text(optics.cx) + ", cy " +
                  to_text(optics.cy),
              "focal lengths and centre in pixels of a picture of " + std::to_string(camera.width) + " x " +
                  std::to_string(camera.height));
}

void check_errors(const MapReader& map, const CameraErrors& errors) {
  const auto complain = [&map](const char* key, const std::string& expected) {
    (map.has(key) ? map.require(key) : map.self()).fail(expected);
  };
  if (errors.noise.precision > kLargestError || errors.noise.correlation > 8.0)
    complain("noise", "precision in metres, at most 0.1; correlation in pixels, at most 8");
  const Planarity& waves = errors.planarity;
  if (std::max(waves.local, waves.global) > kLargestError) complain("planarity", "errors in metres, at most 0.1");
  for (const double length : {waves.local_length, waves.global_length})
    if (length < 2.0 || length > kLongestWave) complain("planarity", "lengths in pixels, 2 to 10000");
  if (errors.trueness.dimension > 0.05 || errors.trueness.position > kLargestError)
    complain("trueness", "dimension as a fraction, at most 0.05; position in metres, at most 0.1");
  const PointLoss& loss = errors.loss;
  if (loss.edge_width > 16.0) complain("loss", "edge_width in pixels, at most 16");
  if (!(loss.grazing_onset <= loss.grazing_full && loss.grazing_full <= 0.5 * std::numbers::pi))
    complain("loss", "grazing_onset_deg <= grazing_full_deg <= 90");
  if (errors.interreflection.bias > kLargestError || errors.interreflection.reach > 1.0)
    complain("interreflection", "bias in metres, at most 0.1; reach in metres, at most 1");
  if (errors.hand_eye.position > kLargestError || errors.hand_eye.rotation > 10.0 * std::numbers::pi / 180.0)
    complain("hand_eye", "position in metres, at most 0.1; rotation_deg at most 10");
}

}  // namespace

void ScenarioReader::read_camera(const Value& value) {
  const MapReader map =
      value.map("camera", keys_with<CameraParams>({"name", "preset", "pose", "resolution", "projector"}));
  const std::vector<std::string> presets = camera_presets();
  CameraParams camera = make_camera(presets[map.require("preset").choice(presets)]);
  const Value name = map.require("name");
  check_new_name(name, "camera", find_camera(scenario_, name.name()) != nullptr);
  camera.name = name.name();
  camera.X_WC = read_world_pose(map.require("pose"));
  if (const auto resolution = map.find("resolution")) read_resolution(*resolution, camera);
  if (const auto projector = map.find("projector")) {
    camera.p_CL = projector->position();
    if (!(camera.p_CL.norm() <= 2.0)) projector->fail("a place in the camera's frame, in metres, at most 2 away");
  }
  read_fields(map, camera);
  check_optics(map, camera);
  check_errors(map, camera.errors);
  scenario_.cameras.push_back(camera);
}

}  // namespace snug::model::internal
