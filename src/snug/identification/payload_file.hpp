// Lifts from tables, and what a lift told of the payload as text.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "snug/identification/parameter.hpp"
#include "snug/identification/payload.hpp"

namespace snug::identification {

/// Reads a CSV with the columns t [s], x, y, z [m], qw, qx, qy, qz (gripper's end E in the world), fx, fy, fz [N], tx,
/// ty, tz [Nm] (of the cup on the box, in E about E: a hanging load makes it point up), and perhaps lip_x .. lip_z,
/// lip_qw .. lip_qz (the lip S in E, where it is measured). Throws InputError with file, line and column for what is
/// missing, no rotation or out of order in time, and for less than the time of a window.
[[nodiscard]] std::vector<PayloadSample> load_lift(const std::filesystem::path& path);
[[nodiscard]] std::vector<PayloadSample> parse_lift(const std::string& text, const std::string& name);

/// Throws InputError, naming `name` and the row, for numbers that are not finite, times that do not grow, and less than
/// the time of a window.
void check_lift(const std::vector<PayloadSample>& lift, const std::string& name);

/// The same lift on a lip that does not give: S stays where it is unloaded.
[[nodiscard]] std::vector<PayloadSample> with_rigid_lip(std::vector<PayloadSample> lift, const CupFrames& frames);

/// mass, com_x, com_y, com_z (in S), I_xx .. I_yz (about the centre of mass). A coordinate of the centre is identified
/// to 5 mm, weak to 20 mm; a moment of inertia as judge() has it. What is not says what motion would tell it.
[[nodiscard]] std::vector<Parameter> judge_payload(const PayloadEstimate& estimate);

[[nodiscard]] std::string format_payload_json(const PayloadEstimate& estimate);
[[nodiscard]] std::string format_payload_table(const PayloadEstimate& estimate);

}  // namespace snug::identification
