// Arms whose joint frames differ from the nominal ones by what a calibration found.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "snug/calibration/dh.hpp"
#include "snug/robot/arm.hpp"

namespace snug::calibration {

/// The nominal arm with the joint frames of this table, however far they lie from the nominal ones.
[[nodiscard]] robot::ArmModel arm_from_dh(const robot::ArmModel& nominal, const DhTable& table);

/// The same arm with each joint frame slid along and turned about its axis, which changes no pose of the last segment,
/// so that it lies as near to the nominal frame as it can: in the mean over configurations, positions and rotations
/// apart (report eq. 16 in closed form, docs/theory/robot.md). The last frame stays.
[[nodiscard]] robot::ArmModel with_frames_near(const robot::ArmModel& exact, const robot::ArmModel& nominal);

/// Largest distance and angle between frames that ought to agree.
struct FrameShift {
  double position = 0.0;  ///< m
  double angle = 0.0;     ///< rad
};
/// Between the joint origins of two arms, each in the frame of the link it is fixed to: where meshes, masses and shapes
/// sit against their neighbours.
[[nodiscard]] FrameShift largest_origin_shift(const robot::ArmModel& a, const robot::ArmModel& b);
/// Between the joint frames of two arms in the base, over 1000 configurations and all joints zero. For a calibrated and
/// a nominal arm most of it is the deviation of the arm itself, which no choice of frames changes.
[[nodiscard]] FrameShift largest_frame_shift(const robot::ArmModel& a, const robot::ArmModel& b);

/// InputError when the joint frames of `arm`, slid and turned as near to those of `nominal` as that allows, are farther
/// off than any real arm's (0.1 m, 0.2 rad; a real UR10's are 8 mm): another arm, millimetres or degrees. `where` is
/// the file that it comes from.
void check_same_arm(const robot::ArmModel& arm, const robot::ArmModel& nominal, const std::string& where);

/// Largest difference of the tool, over the same configurations, between `arm` and the nominal tool carried by the DH
/// chain itself.
[[nodiscard]] FrameShift largest_end_error(const robot::ArmModel& arm, const robot::ArmModel& nominal,
                                           const DhTable& table);

/// The text of `nominal_path` with the joint origins of `arm` (same joints and links), and, where they were moved, of
/// the fixed joints at the start of the last segment. `note` becomes a comment. Relative mesh paths are rewritten for a
/// file in `out_folder`. Numbers read back exactly.
[[nodiscard]] std::string format_urdf(const std::filesystem::path& nominal_path, const robot::ArmModel& nominal,
                                      const robot::ArmModel& arm, const std::string& note,
                                      const std::filesystem::path& out_folder);
/// The text of `path` with E moved (not turned) to the point p_FQ of link `flange`.
[[nodiscard]] std::string format_urdf_with_tip(const std::filesystem::path& path, const robot::ArmModel& arm,
                                               int flange, const Vector3& p_FQ, const std::string& note,
                                               const std::filesystem::path& out_folder);
/// The text of `path` with mass and centre of mass changed, of the first link with a mass behind link `sensor`, so that
/// all behind it weighs `mass` [kg] with its centre at com_L [m, frame of `sensor`].
[[nodiscard]] std::string format_urdf_with_load(const std::filesystem::path& path, const robot::ArmModel& arm,
                                                int sensor, double mass, const Vector3& com_L, const std::string& note,
                                                const std::filesystem::path& out_folder);

/// How roll, pitch, yaw of a calibration YAML are meant.
enum class AngleReading {
  Urdf,      ///< about the fixed axes x, y, z: R = Rz(yaw) Ry(pitch) Rx(roll)
  EulerXyz,  ///< about the moving axes x, y, z: R = Rx(roll) Ry(pitch) Rz(yaw), as one driver's tool writes them
};

/// kinematics: {shoulder, upper_arm, forearm, wrist_1, wrist_2, wrist_3: {x, y, z, roll, pitch, yaw}, hash}: the six
/// joint origins. InputError with file:line for anything else.
[[nodiscard]] robot::ArmModel load_calibration_yaml(const std::filesystem::path& path, AngleReading reading,
                                                    const robot::ArmModel& nominal);
[[nodiscard]] robot::ArmModel parse_calibration_yaml(const std::string& text, const std::string& name,
                                                     AngleReading reading, const robot::ArmModel& nominal);
[[nodiscard]] std::string format_calibration_yaml(const robot::ArmModel& arm, AngleReading reading);

}  // namespace snug::calibration
