// Pose edits: things of a cell moved in the text of its scenario; comments and layout stay, and everything else.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"

namespace snug::model {

/// Something that stands in a cell and can be moved.
struct CellPart {
  std::string key;   ///< "robot", "aligner", "containers.NAME", "bodies.NAME"
  std::string name;  ///< for people
  Pose X_W;          ///< of its frame
};

/// Robot, containers, aligner and static bodies, in this order.
[[nodiscard]] std::vector<CellPart> find_parts(const Scenario& scenario);

/// Of the tool's start: `controller.start_pose`, which is moved like a part.
inline constexpr const char* kStartKey = "controller.start_pose";

/// Where a part stands from now on.
struct PoseEdit {
  std::string key;                ///< of a CellPart, or kStartKey
  Vector3 p_W = Vector3::Zero();  ///< m, of its frame's origin
  double yaw = 0.0;               ///< rad, about the vertical (yaw_about_vertical)
  bool operator==(const PoseEdit&) const = default;
};

/// Angle [rad] about W's z by which the x axis of a frame is turned; of a frame whose x axis is vertical, its y axis.
[[nodiscard]] double yaw_about_vertical(const Matrix3& R_W);

/// The scenario's text with these parts moved: numbers of `pose` are replaced where they stand, missing keys are added.
/// Poses that are written in a frame stay in it. Numbers have micrometres and millionths of a degree. Nothing is
/// checked that the scenario's reader checks: the text may describe things that overlap. Throws InputError with the
/// part for a part that there is not, numbers out of range, a part that is turned by a quaternion or rotation vector
/// and would be turned, and for a pose that is an alias or written in another way that cannot be changed without
/// changing more.
[[nodiscard]] std::string move_parts(const Scenario& scenario, std::span<const PoseEdit> edits);

/// The scenario's text with another `robot.posture` (rad, m; as many numbers as there are), rounded to 1e-4. Throws
/// InputError where the list is not written in one line.
[[nodiscard]] std::string write_posture(const Scenario& scenario, std::span<const double> posture);

}  // namespace snug::model
