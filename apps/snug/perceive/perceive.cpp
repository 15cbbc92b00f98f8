// perceive: a frame and what is expected in it, poses with covariance out.
#include "apps/snug/perceive/perceive.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "apps/snug/command_line/as_list.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/common/choose_camera.hpp"
#include "snug/box_estimation/estimate.hpp"
#include "snug/camera/frame_file.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/model/placements.hpp"

namespace snug::app {
namespace {

using nlohmann::ordered_json;

camera::FrameHints make_hints(const PerceiveOptions& options, const model::Scenario& scenario) {
  camera::FrameHints hints;
  hints.camera = choose_camera(scenario, options.camera, options.scenario);
  hints.camera_is_given = options.use_scenario_camera || !options.intrinsics.empty();
  hints.depth_unit = options.depth_unit;
  hints.points_are_in_camera = options.points_in_camera;
  if (options.intrinsics.empty()) return hints;
  for (const double value : options.intrinsics)
    if (!(std::abs(value) < 1e6)) throw InputError("command line", "--intrinsics", fmt::format("{}", value), "pixels");
  if (!(options.intrinsics[0] > 1.0 && options.intrinsics[1] > 1.0))
    throw InputError("command line", "--intrinsics", "a focal length of at most 1 px", "fx fy cx cy in pixels");
  hints.camera.intrinsics = {options.intrinsics[0], options.intrinsics[1], options.intrinsics[2],
                             options.intrinsics[3]};
  return hints;
}

box_estimation::EstimateInput make_input(const PerceiveOptions& options, const model::Scenario& scenario) {
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr) throw InputError(options.scenario, "containers", "none", "a container to look into");
  box_estimation::EstimateInput input = box_estimation::make_input(scenario, *container);
  for (const model::PlacementEntry& entry : model::load_placements(options.expect, scenario)) {
    const model::Parcel& parcel = *model::find_parcel(scenario, entry.parcel);
    input.boxes.push_back({entry.parcel, model::collision_size(scenario, parcel), container->X_WT * entry.X_TP,
                           options.spread, options.spread_deg * std::numbers::pi / 180.0});
  }
  return input;
}

ordered_json as_json(const box_estimation::BoxEstimate& box) {
  const Quaternion quat(box.X_WP.R);
  ordered_json findings = ordered_json::array(), covariance = ordered_json::array();
  for (const box_estimation::Finding finding : box.findings) findings.push_back(name_of(finding));
  for (int i = 0; i < 6; ++i) {
    covariance.push_back(ordered_json::array());
    for (int k = 0; k < 6; ++k) covariance.back().push_back(box.covariance(i, k));
  }
  return {{"box", box.id},
          {"sight", name_of(box.sight)},
          {"position_m", as_list(box.X_WP.p)},
          {"quat_wxyz", {quat.w(), quat.x(), quat.y(), quat.z()}},
          {"covariance", covariance},
          {"points", box.points},
          {"visible_part", box.visible_part},
          {"rms_m", box.rms},
          {"findings", findings}};
}

ordered_json as_json(const box_estimation::HeightMap& map) {
  ordered_json rows = ordered_json::array();
  for (int r = 0; r < map.height.rows(); ++r) {
    rows.push_back(ordered_json::array());
    for (int c = 0; c < map.height.cols(); ++c) {
      const float height = map.height(r, c);
      if (std::isnan(height))
        rows.back().push_back(nullptr);
      else
        rows.back().push_back(std::round(1e4 * static_cast<double>(height)) / 1e4);
    }
  }
  return {{"cell_m", map.cell}, {"origin_m", {map.origin.x(), map.origin.y()}}, {"height_m", rows}};
}

ordered_json as_json(const box_estimation::Estimate& estimate) {
  ordered_json json = {{"frame", name_of(estimate.fault)},
                       {"point_part", estimate.point_part},
                       {"boxes", ordered_json::array()},
                       {"obstacles", ordered_json::array()}};
  for (const box_estimation::BoxEstimate& box : estimate.boxes) json["boxes"].push_back(as_json(box));
  for (const box_estimation::Obstacle& obstacle : estimate.obstacles)
    json["obstacles"].push_back(
        {{"low_m", as_list(obstacle.low)}, {"high_m", as_list(obstacle.high)}, {"points", obstacle.points}});
  return json;
}

std::string as_table(const box_estimation::Estimate& estimate) {
  std::string text;
  if (estimate.fault != box_estimation::FrameFault::None)
    text += fmt::format("frame cannot be used: {} ({:.0f} % of its pixels have a point)\n", name_of(estimate.fault),
                        100.0 * estimate.point_part);
  text += fmt::format("{:<12} {:<8} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>7}  {}\n", "box", "sight", "x m", "y m",
                      "z m", "sd x mm", "sd y mm", "sd z mm", "points", "findings");
  for (const box_estimation::BoxEstimate& box : estimate.boxes) {
    std::string findings;
    for (const box_estimation::Finding finding : box.findings) findings += fmt::format("{} ", name_of(finding));
    const auto sd = [&box](int i) { return 1e3 * std::sqrt(box.covariance(i, i)); };
    text += fmt::format("{:<12} {:<8} {:>9.4f} {:>9.4f} {:>9.4f} {:>8.2f} {:>8.2f} {:>8.2f} {:>7}  {}\n", box.id,
                        name_of(box.sight), box.X_WP.p.x(), box.X_WP.p.y(), box.X_WP.p.z(), sd(0), sd(1), sd(2),
                        box.points, findings);
  }
  for (const box_estimation::Obstacle& obstacle : estimate.obstacles)
    text += fmt::format("obstacle from ({:.3f}, {:.3f}, {:.3f}) to ({:.3f}, {:.3f}, {:.3f}) m, {} points\n",
                        obstacle.low.x(), obstacle.low.y(), obstacle.low.z(), obstacle.high.x(), obstacle.high.y(),
                        obstacle.high.z(), obstacle.points);
  return text;
}

}  // namespace

int run_perceive(const PerceiveOptions& options) {
  NamedFiles inputs = {{"the frame", options.frame}, {"--scenario", options.scenario}, {"--expect", options.expect}},
             outputs;
  add_file(outputs, "-o", options.output);
  expect_distinct(inputs, outputs);
  const model::Scenario scenario = model::load_scenario(options.scenario);
  const box_estimation::EstimateInput input = make_input(options, scenario);
  std::optional<OutputFile> output = reserve(options.output);
  const camera::Frame frame = camera::load_frame(options.frame, make_hints(options, scenario));
  const box_estimation::Estimate estimate = box_estimation::estimate_boxes(frame, input);
  const ordered_json json = as_json(estimate);
  if (output) {
    ordered_json whole = json;
    whole["height_map"] = as_json(estimate.heights);
    write_file(std::move(*output), whole.dump(1) + "\n");
  }
  print(options.json ? json.dump(2) + "\n" : as_table(estimate));
  return estimate.fault == box_estimation::FrameFault::None ? kSuccess : kRunFailed;
}

}  // namespace snug::app
