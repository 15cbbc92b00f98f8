// An estimate as text.
#include "snug/box_estimation/estimate_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace snug::box_estimation {
namespace {

using Json = nlohmann::ordered_json;

Json as_list(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json as_json(const BoxEstimate& box) {
  const Quaternion quat(box.X_WP.R);
  Json findings = Json::array(), covariance = Json::array();
  for (const Finding finding : box.findings) findings.push_back(name_of(finding));
  for (int i = 0; i < 6; ++i) {
    covariance.push_back(Json::array());
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

Json as_json(const HeightMap& map) {
  Json rows = Json::array();
  for (int r = 0; r < map.height.rows(); ++r) {
    rows.push_back(Json::array());
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

Json as_json(const Estimate& estimate) {
  Json json = {{"frame", name_of(estimate.fault)},
               {"point_part", estimate.point_part},
               {"boxes", Json::array()},
               {"obstacles", Json::array()}};
  for (const BoxEstimate& box : estimate.boxes) json["boxes"].push_back(as_json(box));
  for (const Obstacle& obstacle : estimate.obstacles)
    json["obstacles"].push_back(
        {{"low_m", as_list(obstacle.low)}, {"high_m", as_list(obstacle.high)}, {"points", obstacle.points}});
  return json;
}

}  // namespace

std::string format_json(const Estimate& estimate) { return as_json(estimate).dump(2) + "\n"; }

std::string format_json_with_heights(const Estimate& estimate) {
  Json whole = as_json(estimate);
  whole["height_map"] = as_json(estimate.heights);
  return whole.dump(1) + "\n";
}

std::string format_table(const Estimate& estimate) {
  std::string text;
  if (estimate.fault != FrameFault::None)
    text += fmt::format("frame cannot be used: {} ({:.0f} % of its pixels have a point)\n", name_of(estimate.fault),
                        100.0 * estimate.point_part);
  text += fmt::format("{:<12} {:<8} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>7}  {}\n", "box", "sight", "x m", "y m",
                      "z m", "sd x mm", "sd y mm", "sd z mm", "points", "findings");
  for (const BoxEstimate& box : estimate.boxes) {
    std::string findings;
    for (const Finding finding : box.findings) findings += fmt::format("{} ", name_of(finding));
    const auto sd = [&box](int i) { return 1e3 * std::sqrt(box.covariance(i, i)); };
    text += fmt::format("{:<12} {:<8} {:>9.4f} {:>9.4f} {:>9.4f} {:>8.2f} {:>8.2f} {:>8.2f} {:>7}  {}\n", box.id,
                        name_of(box.sight), box.X_WP.p.x(), box.X_WP.p.y(), box.X_WP.p.z(), sd(0), sd(1), sd(2),
                        box.points, findings);
  }
  for (const Obstacle& obstacle : estimate.obstacles)
    text += fmt::format("obstacle from ({:.3f}, {:.3f}, {:.3f}) to ({:.3f}, {:.3f}, {:.3f}) m, {} points\n",
                        obstacle.low.x(), obstacle.low.y(), obstacle.low.z(), obstacle.high.x(), obstacle.high.y(),
                        obstacle.high.z(), obstacle.points);
  return text;
}

}  // namespace snug::box_estimation
