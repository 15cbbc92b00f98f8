// Side pick and set down as waypoints with switches.
#include "snug/skills/side_pick.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/core/check.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/skills/internal/row_parts.hpp"

namespace snug::skills {
namespace {

using internal::kHold;
using internal::kRelease;
using motion::MotionClass;

/// The axis of the box that is nearest to `direction`, with its sign, in W.
Vector3 nearest_normal(const Matrix3& R_WP, const Vector3& direction, int* axis) {
  (R_WP.transpose() * direction).cwiseAbs().maxCoeff(axis);
  const Vector3 normal = R_WP.col(*axis);
  return normal.dot(direction) > 0.0 ? normal : Vector3(-normal);
}

}  // namespace

Matrix3 side_pick_rotation(const Vector3& face, double tool_yaw, double incline) {
  const Vector3 axis = (-Vector3::UnitZ()).cross(-face).normalized();  // takes down to the way in
  return exp_rotation((0.5 * std::numbers::pi - incline) * axis) * motion::upright_tool(tool_yaw);
}

Matrix3 face_up(const Matrix3& R_WP, const Vector3& face) {
  const Vector3 axis = Vector3::UnitZ().cross(-face).normalized();  // takes the face up
  return exp_rotation(0.5 * std::numbers::pi * axis) * R_WP;
}

SidePickPoses side_pick_poses(const SidePickIntent& intent) {
  SNUG_CHECK(std::abs(intent.face.z()) < 1e-9, "a side looks level");
  int axis = 0;
  const Vector3 normal = nearest_normal(intent.X_WP.R, intent.face, &axis);
  const Matrix3 R_WE = side_pick_rotation(normal, intent.tool_yaw, intent.params.incline);
  const Vector3 touched = intent.X_WP * intent.cup_offset_P + 0.5 * intent.size[axis] * normal;
  SidePickPoses poses;
  poses.X_WE_pick = {R_WE, touched - intent.length * R_WE.col(2)};
  poses.X_WE_before = {R_WE, poses.X_WE_pick.p + intent.params.stand_off * normal};
  poses.X_WE_high = poses.X_WE_before;
  poses.X_WE_high.p.z() = std::max(intent.approach_height, poses.X_WE_before.p.z() + intent.params.above_stand_off);
  poses.X_WE_lifted = poses.X_WE_pick;
  poses.X_WE_lifted.p.z() += intent.lift;
  return poses;
}

std::vector<motion::Waypoint> side_pick_rows(const SidePickIntent& intent) {
  const SidePickPoses poses = side_pick_poses(intent);
  const MotionClass before = intent.again ? MotionClass::PreRePick : MotionClass::PrePick;
  const auto row = [&](MotionClass motion_class, const Pose& X_WE, const motion::IO& io, const char* variant = "") {
    return motion::make_waypoint(motion_class, intent.box, X_WE, io, variant);
  };
  return {row(before, {motion::upright_tool(intent.tool_yaw), poses.X_WE_high.p}, {}),
          row(before, poses.X_WE_high, {}, "_level"), row(before, poses.X_WE_before, {}, "_side"),
          row(intent.again ? MotionClass::RePick : MotionClass::Pick, poses.X_WE_pick, {}),
          row(intent.again ? MotionClass::PostRePick : MotionClass::PostPick, poses.X_WE_lifted, kHold)};
}

std::vector<motion::Waypoint> set_down_rows(const SetDownIntent& intent) {
  const double height = -lowest_corner(intent.X_WP.R, intent.size);
  const double rest = intent.X_WP.p.z() - height;
  const auto tool = [&](double bottom) {
    Pose X_WP = intent.X_WP;
    X_WP.p.z() = bottom + height;
    return intent.tool_for(X_WP);
  };
  const Pose X_WE_high = tool(intent.travel_bottom), X_WE_down = tool(rest - intent.params.press);
  Pose X_WE_back = X_WE_down;
  X_WE_back.p.z() = X_WE_high.p.z() + intent.params.retreat;
  const auto row = [&](MotionClass motion_class, const Pose& X_WE, const motion::IO& io, const char* variant = "") {
    return motion::make_waypoint(motion_class, intent.box, X_WE, io, variant);
  };
  return {row(MotionClass::PreTwist, X_WE_high, kHold),
          row(MotionClass::PreTwist, tool(rest + intent.params.slow_height), kHold, "_low"),
          row(MotionClass::Twist, X_WE_down, kHold), row(MotionClass::Twist, X_WE_down, kRelease),
          row(MotionClass::PreTwist, X_WE_back, {}, "_back")};
}

}  // namespace snug::skills
