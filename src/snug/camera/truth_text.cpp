// What is true of a rendered frame, as JSON: where the camera and the bodies are, and what is seen of each.
#include "snug/camera/truth_text.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "snug/camera/frame_file.hpp"

namespace snug::camera {
namespace {

using nlohmann::ordered_json;

ordered_json json_of_pose(const Pose& X) {
  const Quaternion quat(X.R);
  return {{"position_m", {X.p.x(), X.p.y(), X.p.z()}}, {"quat_wxyz", {quat.w(), quat.x(), quat.y(), quat.z()}}};
}

}  // namespace

int count_points(const Frame& frame) {
  const auto& depths = frame.depth.values();
  return static_cast<int>(std::ranges::count_if(depths, [](float depth) { return depth > 0.0F; }));
}

std::string format_truth(const RenderedFrame& shot, double time, int indent) {
  std::vector<int> pixels(shot.truth.names.size(), 0), points = pixels;
  for (std::size_t i = 0; i < shot.truth.label.values().size(); ++i) {
    const std::int16_t label = shot.truth.label.values()[i];
    const int has_point = shot.frame.depth.values()[i] > 0.0F ? 1 : 0;
    if (label < 0) continue;
    ++pixels[static_cast<std::size_t>(label)];
    points[static_cast<std::size_t>(label)] += has_point;
  }
  ordered_json json = {{"time_s", time},
                       {"camera", ordered_json::parse(format_camera(shot.frame.camera))},
                       {"true_camera_pose", json_of_pose(shot.truth.X_WC)},
                       {"points", count_points(shot.frame)},
                       {"bodies", ordered_json::array()}};
  for (std::size_t i = 0; i < shot.truth.names.size(); ++i) {
    ordered_json body = {{"label", i}, {"name", shot.truth.names[i]}};
    body.update(json_of_pose(shot.truth.X_WB[i]));
    body["pixels"] = pixels[i];
    body["points"] = points[i];
    json["bodies"].push_back(body);
  }
  return json.dump(indent) + "\n";
}

}  // namespace snug::camera
