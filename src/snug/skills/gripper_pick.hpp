// GripperPick: where a gripper of several cups takes a box by its top face: which cups seal there, and how well.
#pragma once

#include <optional>
#include <vector>

#include "snug/model/gripper_params.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::skills {

/// A box that stands upright, seen from its top face.
struct TopFace {
  Pose X_WP;
  Vector3 size = Vector3::Zero();
  double mass = 0.0;
  Vector3 com_P = Vector3::Zero();
};

struct GripperPick {
  double tool_yaw = 0.0;               ///< rad, of motion::upright_tool: axes of E along the edges of the face
  Vector3 offset_P = Vector3::Zero();  ///< from the middle of the box to Ez, in the face; like PickIntent::cup_offset_P
  std::vector<std::size_t> cups;       ///< that seal: their sealing discs lie on the face
  /// Of the box at rest under them: how many times its weight the cup that is nearest to coming off would hold.
  double hold_factor = 0.0;
};

/// The cups of the gripper that seal there, and the hold factor of the weight shared as their elastic law says, with
/// the vacuum that the supply has when the others are open.
[[nodiscard]] GripperPick judge_gripper_pick(const model::GripperParams& gripper, double seal_margin,
                                             const TopFace& face, double tool_yaw, const Vector3& offset_P,
                                             double gravity);

/// Of all places over the centre of mass, or as near as the face allows with all cups, those with one of the cups over
/// it or the middle of those that then seal, and of the four yaws along the edges: the best hold factor, of equals the
/// yaw nearest to `tool_yaw`. None where no cup seals.
[[nodiscard]] std::optional<GripperPick> choose_gripper_pick(const model::GripperParams& gripper, double seal_margin,
                                                             const TopFace& face, double tool_yaw, double gravity);

}  // namespace snug::skills
