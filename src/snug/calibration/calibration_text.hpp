// What was calibrated as text: JSON for programs, lines for people, blocks of a scenario.
#pragma once

#include <optional>
#include <string>

#include "snug/calibration/exact_arm.hpp"
#include "snug/calibration/force_sensor.hpp"
#include "snug/calibration/hand_eye.hpp"
#include "snug/calibration/identify.hpp"
#include "snug/calibration/tool_tip.hpp"

namespace snug::calibration {

/// An arm that was calibrated, measured on the text that is written, read again.
struct ArmReport {
  std::optional<IdentifiedArm> found;   ///< from measured poses
  std::optional<FrameShift> end_error;  ///< of the tool, against deviations that a controller stores
  FrameShift origins, frames;  ///< largest, from nominal: of joint origins in their parents, of frames in the base
};
[[nodiscard]] std::string format_json(const ArmReport& report, const robot::ArmModel& nominal);
[[nodiscard]] std::string format_text(const ArmReport& report, const robot::ArmModel& nominal);

/// A tool whose tip was found, and what that says of its frame.
struct ToolReport {
  ToolTip tip;
  Vector3 p_FE = Vector3::Zero();   ///< m, the tool in the flange's frame
  Vector3 shift = Vector3::Zero();  ///< m, from nominal
};
/// `flange`: link whose poses were given, behind the last joint; `tip_in_tool`: m, in E.
[[nodiscard]] ToolReport report_tool(const ToolTip& tip, const robot::ArmModel& nominal, int flange,
                                     const Vector3& tip_in_tool);
[[nodiscard]] std::string format_json(const ToolReport& report);
/// `flange`: name of the link.
[[nodiscard]] std::string format_text(const ToolReport& report, const std::string& flange);

[[nodiscard]] std::string format_json(const ForceSensorFit& fit);
/// `sensor`: name of the link; the last line is what a scenario takes. `mass_is_given`: the load was weighed.
[[nodiscard]] std::string format_text(const ForceSensorFit& fit, const std::string& sensor, bool mass_is_given);

/// `rows`: of the table.
[[nodiscard]] std::string format_json(const HandEye& found, std::size_t rows);
[[nodiscard]] std::string format_text(const HandEye& found, std::size_t rows);
/// The camera as a scenario has it: its pose, and its standard deviations as hand-eye errors.
[[nodiscard]] std::string format_camera_block(const HandEye& found, const std::string& name, const std::string& preset);

/// Index of a link. InputError that names the option and the nearest link.
[[nodiscard]] int require_link(const robot::ArmModel& arm, const std::string& option, const std::string& name);
/// What poses are measured between: `base` does not move, `end` hangs on the last joint's link by a fixed joint. Throws
/// InputError with the options --base and --end.
[[nodiscard]] MeasuredFrames require_frames(const robot::ArmModel& nominal, const std::string& base,
                                            const std::string& end);

}  // namespace snug::calibration
