// What was calibrated as text: JSON for programs, lines for people, blocks of a scenario.
#include "snug/calibration/calibration_text.hpp"

#include <fmt/format.h>
#include <fmt/printf.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "snug/core/input_error.hpp"

namespace snug::calibration {
namespace {

using nlohmann::ordered_json;

ordered_json numbers_of(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Vector3 roots_of(const Matrix3& covariance) { return covariance.diagonal().cwiseMax(0.0).cwiseSqrt(); }

/// "0.1234 +- 0.0002, ..."
std::string three_numbers(const char* name, const Vector3& value, const Vector3& deviation, double factor,
                          const std::string& unit) {
  std::string text = fmt::sprintf("%-14s", name);
  for (int i = 0; i < 3; ++i)
    text += fmt::sprintf("%s%10.4f +- %.4f", i > 0 ? "," : "", factor * value(i), factor * deviation(i));
  return text + " " + unit + "\n";
}

ordered_json describe_pose(const Pose& X, const Matrix6& covariance) {
  const Quaternion quat(X.R);
  const Vector6 sd = covariance.diagonal().cwiseSqrt();
  ordered_json rows = ordered_json::array();
  for (int i = 0; i < 6; ++i) {
    rows.push_back(ordered_json::array());
    for (int k = 0; k < 6; ++k) rows.back().push_back(covariance(i, k));
  }
  return {{"position_m", numbers_of(X.p)},
          {"quat_wxyz", {quat.w(), quat.x(), quat.y(), quat.z()}},
          {"position_standard_deviation_m", numbers_of(sd.head<3>())},
          {"rotation_standard_deviation_rad", numbers_of(sd.tail<3>())},
          {"covariance", rows}};
}

std::string pose_line(const char* what, const Pose& X, const Matrix6& covariance) {
  const Vector6 sd = covariance.diagonal().cwiseSqrt();
  const Vector3 turn = log_rotation(X.R);
  return fmt::format(
      "{}: at ({:.3f}, {:.3f}, {:.3f}) mm +- ({:.3f}, {:.3f}, {:.3f}), turned by ({:.5f}, {:.5f}, {:.5f}) rad +- "
      "({:.5f}, {:.5f}, {:.5f})\n",
      what, 1e3 * X.p.x(), 1e3 * X.p.y(), 1e3 * X.p.z(), 1e3 * sd(0), 1e3 * sd(1), 1e3 * sd(2), turn.x(), turn.y(),
      turn.z(), sd(3), sd(4), sd(5));
}

ordered_json describe_found(const IdentifiedArm& found, const robot::ArmModel& nominal) {
  ordered_json json;
  json["position_noise_m"] = found.position_noise;
  json["angle_noise_rad"] = found.angle_noise;
  json["rms_position_before_m"] = found.rms_position_before;
  json["rms_position_m"] = found.rms_position;
  json["rms_angle_before_rad"] = found.rms_angle_before;
  json["rms_angle_rad"] = found.rms_angle;
  for (int i = 0; i < found.deviations.size(); ++i)
    json["deviations"].push_back({{"name", deviation_name(nominal, i)},
                                  {"value", found.deviations(i)},
                                  {"standard_deviation", std::sqrt(found.covariance(i, i))}});
  return json;
}

}  // namespace

std::string format_json(const ArmReport& report, const robot::ArmModel& nominal) {
  ordered_json json;
  if (report.found) json = describe_found(*report.found, nominal);
  if (report.end_error) {
    json["max_end_effector_error_m"] = report.end_error->position;
    json["max_end_effector_error_rad"] = report.end_error->angle;
  }
  json["max_frame_shift_m"] = report.origins.position;
  json["max_frame_turn_rad"] = report.origins.angle;
  json["max_deviation_in_base_m"] = report.frames.position;
  json["max_deviation_in_base_rad"] = report.frames.angle;
  return json.dump(2) + "\n";
}

std::string format_text(const ArmReport& report, const robot::ArmModel& nominal) {
  std::string text;
  if (report.end_error)
    text += fmt::sprintf("tool against the deviations: at most %.2g m, %.2g rad apart\n", report.end_error->position,
                         report.end_error->angle);
  if (report.found) {
    const IdentifiedArm& found = *report.found;
    text += fmt::sprintf("left of the poses: %.3f mm, %.3f mrad rms (%.3f mm, %.3f mrad with the nominal arm)\n",
                         1e3 * found.rms_position, 1e3 * found.rms_angle, 1e3 * found.rms_position_before,
                         1e3 * found.rms_angle_before);
    for (int i = 0; i < found.deviations.size(); ++i) {
      const std::string name = deviation_name(nominal, i);
      text +=
          fmt::sprintf("  %-40s %9.4f +- %.4f %s\n", name, 1e3 * found.deviations(i),
                       1e3 * std::sqrt(found.covariance(i, i)), name.find("turn") == std::string::npos ? "mm" : "mrad");
    }
  }
  text += fmt::sprintf("joint origins in their parents' frames: at most %.3f mm, %.5f rad from nominal\n",
                       1e3 * report.origins.position, report.origins.angle);
  return text + fmt::sprintf("joint frames in the base: at most %.3f mm, %.5f rad from nominal\n",
                             1e3 * report.frames.position, report.frames.angle);
}

ToolReport report_tool(const ToolTip& tip, const robot::ArmModel& nominal, int flange, const Vector3& tip_in_tool) {
  const Pose X_FE = nominal.links[static_cast<std::size_t>(flange)].X_SL.inverse() * nominal.X_SE;
  const Vector3 p_FE = tip.p_FQ - X_FE.R * tip_in_tool;
  return {tip, p_FE, p_FE - X_FE.p};
}

std::string format_json(const ToolReport& report) {
  ordered_json json;
  json["tip_m"] = numbers_of(report.tip.p_FQ);
  json["tip_standard_deviation_m"] = numbers_of(roots_of(report.tip.covariance));
  json["tool_m"] = numbers_of(report.p_FE);
  json["tool_shift_m"] = numbers_of(report.shift);
  json["point_m"] = numbers_of(report.tip.p_WQ);
  json["point_standard_deviation_m"] = numbers_of(roots_of(report.tip.point_covariance));
  json["noise_m"] = report.tip.noise;
  return json.dump(2) + "\n";
}

std::string format_text(const ToolReport& report, const std::string& flange) {
  const Vector3 deviation = roots_of(report.tip.covariance);
  return three_numbers("tip", report.tip.p_FQ, deviation, 1e3, "mm in " + flange) +
         three_numbers("tool shift", report.shift, deviation, 1e3, "mm from nominal") +
         three_numbers("point touched", report.tip.p_WQ, roots_of(report.tip.point_covariance), 1e3, "mm") +
         fmt::sprintf("noise of a touch %.4f mm\n", 1e3 * report.tip.noise);
}

std::string format_json(const ForceSensorFit& fit) {
  ordered_json json;
  json["mass_kg"] = fit.mass;
  json["mass_standard_deviation_kg"] = fit.mass_deviation;
  json["com_m"] = numbers_of(fit.com);
  json["com_standard_deviation_m"] = numbers_of(fit.com_deviation);
  json["force_offset_N"] = numbers_of(fit.force_offset);
  json["force_offset_standard_deviation_N"] = numbers_of(fit.force_offset_deviation);
  json["torque_offset_Nm"] = numbers_of(fit.torque_offset);
  json["torque_offset_standard_deviation_Nm"] = numbers_of(fit.torque_offset_deviation);
  json["scale"] = numbers_of(fit.scale);
  json["scale_standard_deviation"] = numbers_of(fit.scale_deviation);
  json["force_noise_N"] = fit.force_noise;
  json["torque_noise_Nm"] = fit.torque_noise;
  return json.dump(2) + "\n";
}

std::string format_text(const ForceSensorFit& fit, const std::string& sensor, bool mass_is_given) {
  const auto list = [](const Vector3& v) { return fmt::sprintf("[%.6g, %.6g, %.6g]", v.x(), v.y(), v.z()); };
  return fmt::sprintf("mass          %10.4f +- %.4f kg%s\n", fit.mass, fit.mass_deviation,
                      mass_is_given ? " (given)" : "") +
         three_numbers("centre", fit.com, fit.com_deviation, 1e3, "mm in " + sensor) +
         three_numbers("scale", fit.scale, fit.scale_deviation, 1.0, "") +
         three_numbers("force offset", fit.force_offset, fit.force_offset_deviation, 1.0, "N") +
         three_numbers("torque offset", fit.torque_offset, fit.torque_offset_deviation, 1.0, "Nm") +
         fmt::sprintf("noise         %10.4f N, %.4f Nm\n", fit.force_noise, fit.torque_noise) +
         fmt::sprintf(
             "for a scenario: sensor: {force_noise: %.4g, torque_noise: %.4g, force_bias: %s, torque_bias: %s}\n",
             fit.force_noise, fit.torque_noise, list(fit.force_offset), list(fit.torque_offset));
}

std::string format_json(const HandEye& found, std::size_t rows) {
  const ordered_json json = {{"camera", describe_pose(found.X_WC, found.covariance)},
                             {"board", describe_pose(found.X_EB, found.board_covariance)},
                             {"rows", rows},
                             {"position_noise_m", found.position_noise},
                             {"angle_noise_rad", found.angle_noise}};
  return json.dump(2) + "\n";
}

std::string format_text(const HandEye& found, std::size_t rows) {
  return pose_line("camera in W", found.X_WC, found.covariance) +
         pose_line("board in E", found.X_EB, found.board_covariance) +
         fmt::format("noise of a measured pose {:.3f} mm, {:.3f} mrad; {} rows\n", 1e3 * found.position_noise,
                     1e3 * found.angle_noise, rows);
}

std::string format_camera_block(const HandEye& found, const std::string& name, const std::string& preset) {
  const Quaternion quat(found.X_WC.R);
  const Vector6 variance = found.covariance.diagonal();
  return fmt::format(
      "cameras:\n  - name: {}\n    preset: {}\n    pose: {{position: [{:.7f}, {:.7f}, {:.7f}], quat_wxyz: [{:.9f}, "
      "{:.9f}, {:.9f}, "
      "{:.9f}]}}\n    hand_eye: {{position: {:.3g}, rotation_deg: {:.3g}}}  # found by least squares: root mean "
      "squares of the axes\n",
      name, preset, found.X_WC.p.x(), found.X_WC.p.y(), found.X_WC.p.z(), quat.w(), quat.x(), quat.y(), quat.z(),
      std::sqrt(variance.head<3>().mean()), std::sqrt(variance.tail<3>().mean()) * 180.0 / std::numbers::pi);
}

int require_link(const robot::ArmModel& arm, const std::string& option, const std::string& name) {
  const int index = robot::find_link(arm, name);
  if (index >= 0) return index;
  std::vector<std::string> names;
  for (const robot::Link& link : arm.links) names.push_back(link.name);
  const std::string_view nearest = find_nearest(name, names);
  throw InputError(
      "command line", option, "'" + name + "'",
      nearest.empty() ? "a link of the URDF" : "a link of the URDF, nearest is '" + std::string(nearest) + "'");
}

MeasuredFrames require_frames(const robot::ArmModel& nominal, const std::string& base, const std::string& end) {
  const MeasuredFrames frames{require_link(nominal, "--base", base), require_link(nominal, "--end", end)};
  const auto segment = [&](int link) { return nominal.links[static_cast<std::size_t>(link)].segment; };
  if (segment(frames.base) != 0) throw InputError("command line", "--base", base, "a link that does not move");
  // The last joint's own link carries no origin that the deviation of the end could be written to.
  const auto is_fixed_behind = [&](const robot::Link& link) {
    return link.segment == nominal.joint_count() && segment(link.parent) == nominal.joint_count();
  };
  if (!is_fixed_behind(nominal.links[static_cast<std::size_t>(frames.end)])) {
    const auto other = std::find_if(nominal.links.begin(), nominal.links.end(), is_fixed_behind);
    throw InputError("command line", "--end", "'" + end + "'",
                     "a link behind a fixed joint of the last joint's link" +
                         (other == nominal.links.end() ? ": the URDF has none" : ", such as '" + other->name + "'"));
  }
  return frames;
}

}  // namespace snug::calibration
