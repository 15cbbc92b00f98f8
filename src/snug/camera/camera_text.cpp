// The camera of a frame as JSON, as it stands in files.
#include <cmath>

#include <nlohmann/json.hpp>

#include "snug/camera/frame_file.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/json_value.hpp"

namespace snug::camera {
namespace {

using nlohmann::ordered_json;

ordered_json as_list(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

/// Numbers of a list of a certain length, all finite and no larger than `most`.
std::vector<double> numbers(const ordered_json& json, const char* key, std::size_t count, double most,
                            const std::string& name) {
  const auto refuse = [&] {
    throw InputError(name, key, json.contains(key) ? json[key].dump().substr(0, 80) : "nothing",
                     std::to_string(count) + " finite numbers");
  };
  if (!json.contains(key) || !json[key].is_array() || json[key].size() != count) refuse();
  std::vector<double> values;
  for (const auto& entry : json[key]) {
    if (!entry.is_number() || !(std::abs(entry.get<double>()) <= most)) refuse();
    values.push_back(entry.get<double>());
  }
  return values;
}

}  // namespace

std::string format_camera(const model::CameraParams& camera) {
  const Quaternion quat(camera.X_WC.R);
  const ordered_json json = {
      {"name", camera.name},
      {"size_px", {camera.width, camera.height}},
      {"intrinsics_px", {camera.intrinsics.fx, camera.intrinsics.fy, camera.intrinsics.cx, camera.intrinsics.cy}},
      {"position_m", as_list(camera.X_WC.p)},
      {"quat_wxyz", {quat.w(), quat.x(), quat.y(), quat.z()}},
      {"working_range_m", {camera.range.near, camera.range.far, camera.range.focus}}};
  return json.dump();
}

void parse_camera(const std::string& text, const std::string& name, model::CameraParams& camera) {
  const ordered_json json = ordered_json::parse(text, nullptr, false);
  if (!is_shallow_json(text) || !json.is_object())
    throw InputError(name, "camera", "no JSON object", "the camera as JSON");
  const auto size = numbers(json, "size_px", 2, 8192, name);
  if (!(size[0] >= 1 && size[1] >= 1)) throw InputError(name, "size_px", json["size_px"].dump(), "1 to 8192 pixels");
  camera.width = static_cast<int>(size[0]);
  camera.height = static_cast<int>(size[1]);
  const auto optics = numbers(json, "intrinsics_px", 4, 1e6, name);
  if (!(optics[0] > 1.0 && optics[1] > 1.0))
    throw InputError(name, "intrinsics_px", json["intrinsics_px"].dump(), "focal lengths above 1 px");
  camera.intrinsics = {optics[0], optics[1], optics[2], optics[3]};
  const auto p = numbers(json, "position_m", 3, 1e4, name);
  const auto q = numbers(json, "quat_wxyz", 4, 2.0, name);
  const Quaternion quat(q[0], q[1], q[2], q[3]);
  if (!(std::abs(quat.norm() - 1.0) < 1e-3))
    throw InputError(name, "quat_wxyz", json["quat_wxyz"].dump(), "a unit quaternion");
  camera.X_WC = {quat.normalized().toRotationMatrix(), Vector3(p[0], p[1], p[2])};
  const auto range = numbers(json, "working_range_m", 3, 1e4, name);
  if (!(range[0] > 0.0 && range[0] < range[1]))
    throw InputError(name, "working_range_m", json["working_range_m"].dump(), "near < far");
  camera.range = {range[0], range[1], range[2]};
  if (json.contains("name") && json["name"].is_string()) camera.name = json["name"].get<std::string>();
}

}  // namespace snug::camera
